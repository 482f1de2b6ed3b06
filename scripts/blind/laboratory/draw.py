"""Draws from a random generator, and numbers as a data sheet would print them."""
import numpy as np


class Unfit(Exception):
    """A draw that is no fair question, or a cause that these data could not show."""


def uniform(rng, low, high):
    return float(rng.uniform(low, high))


def log_uniform(rng, low, high):
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def pick(rng, *names):
    return str(rng.choice(names))


def digits(x, count=6):
    """Rounded to so many significant digits."""
    return float(f"%.{count}g" % x)
