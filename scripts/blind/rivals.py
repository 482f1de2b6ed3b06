"""How well other causes, in their textbook forms, could stand in for what a case has.

Used for the answers alone: which verdicts no one could tell apart, and whether a gap from outside the library truly is.
"""
import dataclasses

import numpy as np

from measure import Absorber, record_all, rms
from plant import curve_function, drive, share_over_clearance, strokes

STALE_GROUPS = {
    "gravity": ("dynamics.gravity_nm",), "coulomb": ("friction.up.a_j", "friction.down.a_j"), "viscous": ("friction.up.d", "friction.down.d"),
    "backlash_width": ("joint.backlash_m",), "load_coefficient": ("friction.up.mu_c", "friction.down.mu_c"),
    "stribeck_level": ("friction.up.b_c", "friction.down.b_c", "friction.up.b_j", "friction.down.b_j"), "inertia": ("dynamics.inertia_kg_m2",),
}
ROWS = 5000  # about as many rows as a rival is judged on
SIMPLER = {"sensor_bias": ("elastic_spring", "sensor_drift", "joint_coupling")}  # these hold a constant in them: no rivals of it


class Bench:
    """The gap of one case, what the base may absorb of it, and the states to make columns from."""

    def __init__(self, joint, ruler, names, columns, low, high, target):
        self.joint, self.ruler, self.names = joint, ruler, names
        self.stride = slice(None, None, max(1, len(target) // ROWS))
        self.columns, self.target = columns[self.stride], target[self.stride]
        self.base_alone = Absorber(self.columns, low, high)
        self.states = [drive(joint, t)[1] for t in ruler.trials]
        self.base = record_all(joint, ruler.trials)
        self.thin = self.joined(self.states)

    def joined(self, states):
        """One state of all trials, at the rows that count alone."""
        def rows(of):
            return np.concatenate([of(st)[self.ruler.kept[st.trial.name]] for st in states])[self.stride]

        first = states[0]
        fields = {f: rows(lambda st: getattr(st, f)) for f in ("q", "v", "a", "share", "load", "friction", "y")}
        return dataclasses.replace(first, **fields)

    def column(self, shape):
        """A low-passed column from a shape of the state."""
        return self.ruler.cut([shape(st) for st in self.states])[self.stride]

    def changed(self, forms):
        """The column of what some forms do to the torque."""
        return self.ruler.cut([y - b for y, b in zip(record_all(self.joint, self.ruler.trials, forms), self.base)])[self.stride]

    def left(self, free, target=None):
        return self.base_alone.beside(free).left(self.target if target is None else target)

    def best_of(self, candidates):
        """Of lists of shapes, the low-passed columns of the one that fits best beside the base, looked for without the low-pass."""
        q = self.base_alone.q
        beside = lambda x: x - q @ (q.T @ x)
        target = beside(self.target)

        def missed(shapes):
            raw = beside(np.column_stack([s(self.thin) for s in shapes]))
            return rms(target - raw @ np.linalg.lstsq(raw, target, rcond=None)[0])

        return [self.column(s) for s in min(candidates, key=missed)]


def free_columns(bench):
    """Cause -> lists of columns that may take any size, each list one form of it."""
    states = bench.states
    low, high = min(st.q.min() for st in states), max(st.q.max() for st in states)
    top = max(np.abs(st.v).max() for st in states)
    length_s = bench.ruler.trials[-1].elapsed_s[-1]
    counts = np.exp(np.linspace(np.log(1.5), np.log(16), 60)) * 2 * np.pi / (high - low)
    wave = lambda n, by: [lambda st, k=k, f=f: by(st) * f(k * n * st.q) for k in (1, 2) for f in (np.sin, np.cos)]
    one = lambda st: np.ones(len(st.q))
    speeds = top * np.array([0.03, 0.08, 0.2, 0.4])
    forms = {
        "stribeck": [
            [bench.column(lambda st: way(st) * np.exp(-np.abs(st.v / v) ** n)) for way in (lambda st: st.share, lambda st: st.share - 1)]
            for v in speeds for n in (1, 2)
        ],
        "load_dependent_friction": [[bench.column(lambda st: st.sense * np.abs(st.load))]],
        "friction_ripple": [bench.best_of([wave(n, lambda st: st.sense) for n in counts])],
        "torque_ripple": [bench.best_of([wave(n, one) for n in counts])],
        "quadratic_viscous": [[bench.column(lambda st: st.v * np.abs(st.v))]],
        "sensor_bias": [[bench.column(one)]],
        "sensor_gain": [[bench.column(lambda st: st.y)]],
        "sensor_drift": [
            [bench.column(lambda st, k=k: (st.trial.elapsed_s / length_s) ** k) for k in range(1, 4)],
            [bench.column(lambda st, k=k: st.trial.t_s**k) for k in (1, 2)],
        ],
        "gravity_phase": [[bench.column(lambda st: np.cos(st.q))]],
        "elastic_spring": [[bench.column(one), bench.column(lambda st: st.q)]],
        "inertia": [[bench.column(lambda st: st.a)]],
        "time_delay": [
            [bench.column(lambda st: np.interp(st.trial.t_s - d, st.trial.t_s, st.y) - st.y)] for d in (-0.1, -0.05, -0.01, 0.01, 0.05, 0.1)
        ],
        "cable_elasticity": [[bench.column(lambda st: np.cos(st.q) * st.load)], [bench.column(lambda st: np.cos(st.q) * st.y)]],
        "warm_up": [[bench.column(lambda st: st.friction * np.exp(-st.trial.elapsed_s / t))] for t in length_s * np.array([0.1, 0.25, 0.6])],
        "end_stop": [
            bench.best_of([[lambda st, e=e, k=k: np.maximum(0, sign * (st.q - e)) ** k] for e in low + (high - low) * stops for k in (1, 2)])
            for sign, stops in ((1, np.linspace(0.6, 0.97, 12)), (-1, np.linspace(0.03, 0.4, 12)))
        ],
    }
    if states[0].trial.other is not None:
        moving = ("q", "v", "sign", "a", "tilt")
        of = {
            "q": lambda st: st.trial.other[0], "v": lambda st: st.trial.other[1], "sign": lambda st: np.sign(st.trial.other[1]),
            "a": lambda st: st.trial.other[2], "tilt": lambda st: np.sin(st.q + st.trial.other[0]),
        }
        forms["joint_coupling"] = [[bench.column(of[m])] for m in moving] + [[bench.column(one), bench.column(of["q"])]]
    for group, members in STALE_GROUPS.items():
        here = [i for i, n in enumerate(bench.names) if n in members]
        if here:
            forms[group] = [[bench.columns[:, i] for i in here]]
    return forms


def fixed_columns(bench):
    """Cause -> columns that act as a whole or not at all: other ways through a reversal."""
    joint = bench.joint
    clearance = joint.backlash_m
    curve = lambda g, x: [("share", lambda st, s: share_over_clearance(joint.r2_m * st.q, x, g), 1.0)]
    arctan = lambda p: curve_function(("arctan", p))
    transitions = [curve(g, clearance * k) for k in (0.6, 1.0, 1.7) for g in (arctan(0.3), arctan(2.0), lambda u: u**2)]
    widest = max(st.q.max() for st in bench.states) - min(st.q.min() for st in bench.states)
    slips = [curve_of_bristle(widest * s) for s in (0.003, 0.006, 0.012, 0.025)]
    return {"reversal_transition": [bench.changed(f) for f in transitions], "presliding": [bench.changed(f) for f in slips]}


def curve_of_bristle(slip_rad):
    """A Dahl element by strokes: it approaches its end exponentially from where the reversal found it."""

    def act(st, s):
        out = np.empty(len(st.q))
        starts, senses = strokes(st.joint.r2_m * st.q)
        level = (senses[0] + 1) / 2
        for i, (start, sense) in enumerate(zip(starts, senses)):
            stop = starts[i + 1] if i + 1 < len(starts) else len(st.q) - 1
            end = (sense + 1) / 2
            out[start : stop + 1] = end + (level - end) * np.exp(-np.abs(st.q[start : stop + 1] - st.q[start]) / slip_rad)
            level = out[stop]
        return out

    return [("share", act, 1.0)]


def what_each_leaves(bench):
    """Cause -> RMS, N m, of the gap that it leaves at its best."""
    leaves = {name: min(bench.left(columns) for columns in lists) for name, lists in free_columns(bench).items()}
    for name, columns in fixed_columns(bench).items():
        leaves[name] = min(bench.left([], bench.target - c) for c in columns)
    return leaves
