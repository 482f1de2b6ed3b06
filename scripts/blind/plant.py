"""A cable-driven joint in motion: the paper's formula as base, and whatever else a case puts on top of it.

Quantities are in SI units: q rad, v rad/s, a rad/s^2, torques N m at the winch unless `load` (at the joint).
"""
import dataclasses

import numpy as np

STILL_M = 1e-9  # a smaller step of the cable in one sample is no motion: it is rounding
DIRECTIONS = ("up", "down")
HOOKS = ("motion", "share", "load", "friction", "strain", "winch", "sensor")
FRICTION = ("mu_c", "a_j", "b_c", "c_c", "b_j", "c_j", "d")


@dataclasses.dataclass
class Joint:
    """What a model.json holds; `curve` is (kind, p): sign, linear or arctan."""

    r1_m: float
    r2_m: float
    backlash_m: float
    gravity_nm: float
    inertia_kg_m2: float
    friction: dict  # direction -> {name: value}
    curve: tuple

    def values(self):
        """Every parameter under its dotted name."""
        named = {f"friction.{d}.{n}": self.friction[d][n] for d in DIRECTIONS for n in FRICTION}
        named["dynamics.gravity_nm"] = self.gravity_nm
        named["dynamics.inertia_kg_m2"] = self.inertia_kg_m2
        if self.curve[0] != "sign":
            named["joint.backlash_m"] = self.backlash_m
        if self.curve[0] == "arctan":
            named["combination.p"] = self.curve[1]
        return named

    def altered(self, changes):
        """A copy with some dotted parameters at other values."""
        new = dataclasses.replace(self, friction={d: dict(self.friction[d]) for d in DIRECTIONS})
        for name, value in changes.items():
            group, key = name.split(".", 1)
            if group == "friction":
                direction, key = key.split(".")
                new.friction[direction][key] = value
            elif group == "combination":
                new.curve = (new.curve[0], value)
            else:
                setattr(new, key, value)
        return new


@dataclasses.dataclass
class Trial:
    """One recording's true motion. `elapsed_s` counts from the campaign's start, `t_s` from the trial's."""

    name: str
    protocol: str
    trajectory: str
    repeat: int
    speed_rad_s: float
    t_s: np.ndarray
    elapsed_s: np.ndarray
    q: np.ndarray
    v: np.ndarray
    a: np.ndarray
    other: tuple = None  # q, v, a of another joint

    @property
    def rate_hz(self):
        return (len(self.t_s) - 1) / (self.t_s[-1] - self.t_s[0])


def strokes(x):
    """Start indices of the runs of one direction, and the direction of each; rest belongs to the run before it."""
    step = np.diff(x)
    sense = np.where(np.abs(step) < STILL_M, 0.0, np.sign(step))
    moving = np.flatnonzero(sense)
    if len(moving) == 0:
        return np.array([0]), np.array([1.0])
    turns = moving[1:][np.diff(sense[moving]) != 0]
    starts = np.concatenate(([0], turns))
    return starts, sense[np.concatenate(([moving[0]], turns))]


def curve_function(curve):
    """g(u) of the paper's combinations, g(0) = 0, g(1) = 1."""
    kind, p = curve
    if kind == "arctan":
        return lambda u: np.arctan(2 * p * u) / np.arctan(2 * p)
    return lambda u: u


def share_over_clearance(x, clearance_m, g):
    """K~ over a run of cable positions: after each reversal, from where it stands along g to the other end."""
    share = np.empty(len(x))
    starts, senses = strokes(x)
    k, level = senses[0], (senses[0] + 1) / 2
    for i, (start, sense) in enumerate(zip(starts, senses)):
        stop = starts[i + 1] if i + 1 < len(starts) else len(x) - 1
        run = np.clip(k + 2 * (x[start : stop + 1] - x[start]) / clearance_m, -1, 1)
        left, end = sense - k, (sense + 1) / 2
        u = (run - k) / left if abs(left) > 1e-12 else np.ones_like(run)
        share[start : stop + 1] = level + g(np.clip(u, 0, 1)) * (end - level)
        k, level = run[-1], share[stop]
    return share


def share_by_sign(x):
    """K~ that jumps with the direction."""
    share = np.empty(len(x))
    starts, senses = strokes(x)
    for i, (start, sense) in enumerate(zip(starts, senses)):
        share[start : starts[i + 1] if i + 1 < len(starts) else len(x)] = (sense + 1) / 2
    return share


def share(joint, q):
    """K~ of the joint's own combination."""
    x = joint.r2_m * q
    if joint.curve[0] == "sign":
        return share_by_sign(x)
    return share_over_clearance(x, joint.backlash_m, curve_function(joint.curve))


def branch(joint, direction, v):
    """Friction of one branch (the load term aside) at the winch, N m, at speed |v|."""
    p, speed = joint.friction[direction], np.abs(v)
    sense = 1.0 if direction == "up" else -1.0
    cable = p["b_c"] * np.exp(-abs(p["c_c"]) * joint.r2_m * speed)
    return joint.r1_m * (p["a_j"] + cable + p["b_j"] * np.exp(-abs(p["c_j"]) * speed) + sense * p["d"] * speed)


@dataclasses.dataclass
class State:
    """What a form may look at: the trial, the motion that the joint makes, and the torques so far."""

    trial: Trial
    joint: Joint
    q: np.ndarray
    v: np.ndarray
    a: np.ndarray
    share: np.ndarray = None
    load: np.ndarray = None
    friction: np.ndarray = None
    y: np.ndarray = None

    @property
    def sense(self):
        """Direction of friction, -1 to 1, passing as K~ does."""
        return 2 * self.share - 1


def drive(joint, trial, forms=(), noise=None):
    """The recorded winch torque of a trial, N m, and the state that it came from.

    A form is (hook, function, strength); the hooks, in the order in which they act: `HOOKS`.
    """
    at = {hook: [(f, s) for h, f, s in forms if h == hook] for hook in HOOKS}
    st = State(trial, joint, trial.q, trial.v, trial.a)
    for f, s in at["motion"]:
        st.q, st.v, st.a = f(st, s)
    st.share = share(joint, st.q)
    for f, s in at["share"]:
        st.share = f(st, s)
    st.load = joint.gravity_nm * np.sin(st.q) + joint.inertia_kg_m2 * st.a
    for f, s in at["load"]:
        st.load = st.load + s * f(st)
    up, down = branch(joint, "up", st.v), branch(joint, "down", st.v)
    st.friction = down + st.share * (up - down)
    for f, s in at["friction"]:
        st.friction = st.friction * (1 + s * f(st))
    mu_up, mu_down = joint.friction["up"]["mu_c"], joint.friction["down"]["mu_c"]
    st.y = (joint.r1_m / joint.r2_m * st.load + st.friction) / (1 - mu_down - st.share * (mu_up - mu_down))
    for f, s in at["strain"]:
        st.y = f(st, s)
    y = st.y + sum(s * f(st) for f, s in at["winch"]) + (0 if noise is None else noise)
    for f, s in at["sensor"]:
        y = f(y, st, s)
    return y, st
