"""Stops at the ends of travel, and people who touch the joint."""
import numpy as np

from forms.base import Form, form


def stop(rng, c, shape):
    upper = rng.random() < 0.7
    depth = c.width_rad * rng.uniform(0.04, 0.2)
    top, bottom = max(t.q.max() for t in c.trials), min(t.q.min() for t in c.trials)

    def act(st):
        into = st.q - (top - depth) if upper else (bottom + depth) - st.q
        return (1 if upper else -1) * shape(np.maximum(0, into) / depth)

    return act


@form("end_stop", "quadratic")
def _(rng, c):
    return Form("load", stop(rng, c, lambda x: x**2), 10 * c.joint.gravity_nm)


@form("end_stop", "exponential")
def _(rng, c):
    steep = rng.uniform(1, 4)
    return Form("load", stop(rng, c, lambda x: np.expm1(steep * x) / np.expm1(steep)), 10 * c.joint.gravity_nm)


@form("end_stop", "damped")
def _(rng, c):
    """A rubber pad: stiffer going in than coming out."""
    inner, damping = stop(rng, c, lambda x: x**1.3), rng.uniform(0.1, 0.3)
    return Form("winch", lambda st: inner(st) * (1 + damping * np.sign(st.v) * np.sign(inner(st))), 5 * c.torque_span_nm)


def push(rng, kind, x):
    """A touch over x in 0..1."""
    if kind == "half_sine":
        return np.sin(np.pi * x) ** 1.2
    if kind == "trapezoid":
        return np.clip(np.minimum(x, 1 - x) / 0.15, 0, 1)
    return np.exp(-4 * x) * np.clip(x / 0.05, 0, 1)


def touches(rng, c, kind, shortest_s=0.4, longest_s=2.5):
    """A few touches in a few of the trials."""
    count = max(1, int(round(len(c.trials) * rng.uniform(0.15, 0.5))))
    plan = {}
    for i in rng.choice(len(c.trials), count, replace=False):
        trial = c.trials[i]
        long = trial.t_s[-1]
        plan[trial.name] = [
            (rng.uniform(0.15, 0.8) * long, rng.uniform(shortest_s, longest_s), rng.choice([-1, 1]) * rng.uniform(0.5, 1.0))
            for _ in range(rng.integers(1, 4))
        ]

    def act(st):
        out = np.zeros(len(st.q))
        for start, length, size in plan.get(st.trial.name, []):
            x = (st.trial.t_s - start) / length
            inside = (x > 0) & (x < 1)
            out[inside] += size * push(rng, kind, x[inside])
        return out

    return act


@form("contact", "half_sine")
def _(rng, c):
    return Form("winch", touches(rng, c, "half_sine"), 4 * c.torque_span_nm)


@form("contact", "trapezoid")
def _(rng, c):
    return Form("load", touches(rng, c, "trapezoid"), 15 * c.joint.gravity_nm)


@form("contact", "leant_on")
def _(rng, c):
    return Form("load", touches(rng, c, "trapezoid", 2.0, 5.0), 15 * c.joint.gravity_nm)


@form("contact", "struck")
def _(rng, c):
    return Form("load", touches(rng, c, "struck"), 15 * c.joint.gravity_nm)
