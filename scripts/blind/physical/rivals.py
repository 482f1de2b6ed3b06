"""What could be mistaken for what: what a textbook form of every cause leaves of a gap, the base moving within its confidence."""
import numpy as np
from scipy.optimize import lsq_linear

from joints import STALE
from plant import branch, curve, load, passed_over, torque

GROUPS = {
    "gravity": ("gravity_nm",), "coulomb": ("a_j",), "viscous": (".d",), "backlash_width": ("backlash_m",), "load_coefficient": ("mu_c",),
    "stribeck_level": ("b_j",), "inertia": ("inertia_kg_m2",),
}


TRANSITIONS = (
    ("reversal_transition", curve("linear")), ("reversal_transition", curve("arctan", 2.0)),
    ("presliding", lambda u: np.expm1(-3 * u) / np.expm1(-3)),
)


class Absorber:
    """Least squares of a gap on the base's columns, each within its bounds, and on further ones without."""

    def __init__(self, columns, bounds, gap):
        self.j, self.bounds, self.gap = columns, bounds, gap
        self.jj, self.jg, self.gg = columns.T @ columns, columns.T @ gap, float(gap @ gap)

    def left(self, extra=None, free=()):
        """RMS of what remains."""
        p = len(self.bounds)
        k = 0 if extra is None else extra.shape[1]
        gram, right = np.zeros((p + k, p + k)), np.zeros(p + k)
        gram[:p, :p], right[:p] = self.jj, self.jg
        if k:
            gram[:p, p:] = self.j.T @ extra
            gram[p:, :p] = gram[:p, p:].T
            gram[p:, p:], right[p:] = extra.T @ extra, extra.T @ self.gap
        scale = np.sqrt(np.maximum(np.diag(gram), 1e-300))
        unit = gram / np.outer(scale, scale) + 1e-10 * np.eye(p + k)
        factor = np.linalg.cholesky(unit)
        target = np.linalg.solve(factor, right / scale)
        top = np.concatenate([np.where(np.isin(np.arange(p), list(free)), np.inf, self.bounds), np.full(k, np.inf)]) * scale
        top = np.maximum(top, 1e-12)
        x = lsq_linear(factor.T, target, (-top, top), method="bvls" if p + k < 40 else "trf").x
        explained = 2 * x @ (right / scale) - x @ unit @ x
        return float(np.sqrt(max(0.0, self.gg - explained) / len(self.gap)))


def bank(world, base, clocked):
    """(id, columns) of every textbook form, thinned and low-passed."""
    q, v, d = world.q, world.v, world.direction
    slide = base.kind == "prismatic"
    ratio = 1.0 if slide else base.r1_m / base.r2_m
    y = torque(world, base)
    pull = ratio * load(base, q, world.a)
    up, down = branch(base, "up", v), branch(base, "down", v)
    low, high, span = q.min(), q.max(), np.ptp(q)
    of = lambda *columns: np.column_stack([world.judged(c) for c in columns])
    one = np.ones_like(q)
    yield "sensor_bias", of(one)
    yield "sensor_gain", of(y)
    t = world.t / max(tr.t_s[-1] for tr in world.trials)
    yield "sensor_drift", of(one, t, t * t)
    if clocked:
        e = world.elapsed / world.elapsed.max()
        yield "sensor_drift", of(one, *[np.cos(k * np.pi * e) for k in range(1, 8)])
        friction = down + (1 + d) / 2 * (up - down)
        for tau in (0.1, 0.25, 0.6):
            yield "warm_up", of(friction * np.exp(-e / tau))
    yield "time_delay", of(world.by_trial(lambda s: np.gradient(y[s])))
    if not slide:
        yield "gravity_phase", of(np.cos(q))
        yield "cable_elasticity", of(base.gravity_nm * np.cos(q) * pull)
        yield "cable_elasticity", of(base.gravity_nm * np.cos(q) * y)
        yield "load_dependent_friction", of(d * np.abs(pull))
        yield "load_dependent_friction", of(d * np.abs(y))
    yield "elastic_spring", of(one, q)
    yield "inertia", of(world.a)
    yield "quadratic_viscous", of(v * np.abs(v))
    for share in (0.03, 0.08, 0.15, 0.25):
        for side in (1, -1):
            sunk = np.maximum(0, side * q - (max(side * low, side * high) - share * span))
            yield "end_stop", of(sunk)
            yield "end_stop", of(sunk**2)
    top = np.quantile(np.abs(v), 0.95)
    for slow in (0.015, 0.03, 0.06, 0.12, 0.25, 0.45):
        for power in (1, 2):
            bump = np.exp(-((np.abs(v) / (slow * top)) ** power))
            yield "stribeck", of(bump * (d > 0), bump * (d < 0))
    for waves in np.arange(1.25, 9.6, 0.125):
        x = 2 * np.pi * waves * q / span
        yield "torque_ripple", of(np.sin(x), np.cos(x))
        yield "friction_ripple", of(d * np.sin(x), d * np.cos(x))
    reach = y.max() - y.min()
    for cut in (0.01, 0.02, 0.04, 0.07, 0.1, 0.15, 0.2, 0.3, 0.4):
        top, bottom = np.minimum(0, y.max() - cut * reach - y), np.maximum(0, y.min() + cut * reach - y)
        yield "saturation", of(top)
        yield "saturation", of(bottom)
        yield "saturation", of(top, bottom)
    if base.curve[0] == "sign":
        for reach in (0.0005, 0.001, 0.0025, 0.005, 0.01, 0.02, 0.04, 0.08, 0.15, 0.3):
            for kind, shape in TRANSITIONS:
                share = world.by_trial(lambda s: passed_over(q[s], d[s], reach * span * (2 if kind == "presliding" else 1), shape))
                yield kind, of((share - (1 + d) / 2) * (up - down))
    if world.other is not None:
        angle, speed = world.other.T
        for c in (angle, speed, np.sin(angle), np.sign(speed)):
            yield "joint_coupling", of(one, c)


def leaves(world, base, names, columns, bounds, gap, clocked):
    """What every cause leaves of the gap at its best: id to RMS."""
    absorber = Absorber(columns, bounds, gap)
    best = {}
    for name, extra in bank(world, base, clocked):
        best[name] = min(best.get(name, np.inf), absorber.left(extra))
    for group in STALE:
        free = [i for i, n in enumerate(names) if any(n.endswith(key) for key in GROUPS[group])]
        if free:
            best[group] = min(best.get(group, np.inf), absorber.left(None, free))
    return best
