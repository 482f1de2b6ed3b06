"""An effect: where it acts, and the law that it follows at a given amount."""
import dataclasses
from typing import Callable

import numpy as np


@dataclasses.dataclass
class Effect:
    id: str
    variant: str
    place: str  # joint, friction, angle, share, reading, base
    act: Callable
    linear: bool = True  # torque proportional to the amount
    most: float = np.inf  # the largest amount that is still physical
    notes: dict = dataclasses.field(default_factory=dict)
    needs: tuple = ()  # "clock": a campaign clock that runs on; "other": a second joint


def log_uniform(rng, low, high):
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def by_segment(world, step):
    """Runs `step(q, direction, state) -> (values, state)` over each stretch of one direction, anew in each trial."""
    out = np.empty(len(world.q))
    for s in world.slices:
        d = world.direction[s]
        cuts = [0, *(np.flatnonzero(np.diff(d)) + 1), len(d)]
        state = None
        for i, j in zip(cuts[:-1], cuts[1:]):
            here = slice(s.start + i, s.start + j)
            origin = world.q[max(s.start, s.start + i - 1)]
            out[here], state = step(world.q[here] - origin, d[i], state)
    return out


def loop(world, rate, z0=0.0):
    """Integrates dz/ds = rate(z, s's direction) along the path, sample by sample, anew in each trial."""
    out = np.empty(len(world.q))
    for s in world.slices:
        z, previous = z0, world.q[s.start]
        path = world.q[s].tolist()
        filled = []
        for q in path:
            z = rate(z, q - previous)
            previous = q
            filled.append(z)
        out[s] = filled
    return out
