"""A cable-driven joint as a machine: what its winch feels, and where something may be wrong with it.

The base is the formula that the project states as its model: the load, raised or lowered by the friction of the cable over its
pulleys, plus friction of each direction, which passes over when the cable's clearance is taken up. Effects act at four places:
on the load, on the friction at the winch, on the angle that the load sees, and on the readings.
"""
import copy
import dataclasses

import numpy as np
from scipy.signal import butter, sosfiltfilt

DIRECTIONS = ("up", "down")


@dataclasses.dataclass
class Base:
    kind: str
    r1_m: float
    r2_m: float
    backlash_m: float
    gravity_nm: float
    inertia_kg_m2: float
    up: dict  # mu, a, b, c, d: in N, N, s/rad, N s/rad
    down: dict
    curve: tuple  # ("sign",), ("linear",), ("arctan", p), ("power", n)

    def values(self):
        """Dotted names as in a model file, to the values."""
        named = {"dynamics.gravity_nm": self.gravity_nm, "dynamics.inertia_kg_m2": self.inertia_kg_m2}
        for direction in DIRECTIONS:
            branch = getattr(self, direction)
            keys = {"mu": "mu_c", "a": "a_j", "b": "b_j", "c": "c_j", "d": "d"}
            named |= {f"friction.{direction}.{keys[k]}": v for k, v in branch.items()}
        if self.curve[0] != "sign":
            named["joint.backlash_m"] = self.backlash_m
        if self.curve[0] in ("arctan", "power"):
            named[f"combination.{'p' if self.curve[0] == 'arctan' else 'n'}"] = self.curve[1]
        return named

    def changed(self, changes):
        """A copy with other values."""
        other = copy.deepcopy(self)
        for name, value in changes.items():
            group, key = name.split(".")[0], name.split(".")[-1]
            if group == "friction":
                getattr(other, name.split(".")[1])[{"mu_c": "mu", "a_j": "a", "b_j": "b", "c_j": "c", "d": "d"}[key]] = value
            elif group == "combination":
                other.curve = (other.curve[0], value)
            else:
                setattr(other, key, value)
        return other


@dataclasses.dataclass
class World:
    """All trials of a campaign end to end, with their edges."""

    trials: list
    rate_hz: float
    lowpass_hz: float
    order: int

    def __post_init__(self):
        join = lambda name: np.concatenate([getattr(t, name) for t in self.trials])
        self.t, self.q, self.v, self.a = join("t_s"), join("q"), join("v"), join("a")
        self.elapsed = np.concatenate([t.t_s + t.start_s for t in self.trials])
        edges = np.cumsum([0] + [len(t.t_s) for t in self.trials])
        self.slices = [slice(i, j) for i, j in zip(edges[:-1], edges[1:])]
        self.number = np.concatenate([np.full(len(t.t_s), k) for k, t in enumerate(self.trials)])
        self.other = np.concatenate([t.other for t in self.trials]) if self.trials[0].other is not None else None
        self.direction = np.concatenate([directions(self.v[s]) for s in self.slices])
        self.sos = butter(self.order, self.lowpass_hz, fs=self.rate_hz, output="sos") if 2 * self.lowpass_hz < 0.95 * self.rate_hz else None
        self.step = max(1, int(self.rate_hz / (8 * self.lowpass_hz)))
        self.kept = np.zeros(len(self.t), bool)
        for s in self.slices:
            rows = np.arange(s.start, s.stop)
            settled = s.start + settled_at(self.q[s], self.direction[s])
            self.kept[rows[(rows >= settled) & ((rows - s.start) % self.step == 0)]] = True

    def low(self, x):
        """Low-passed by trial, zero phase."""
        if self.sos is None:
            return np.asarray(x, float)
        return np.concatenate([sosfiltfilt(self.sos, x[s], padtype="odd") for s in self.slices])

    def judged(self, x):
        """Low-passed, thinned, without the start of each trial."""
        return self.low(x)[self.kept]

    def as_read(self, step):
        """The same motions as a coarse encoder shows them: speed, acceleration and direction from rounded, smoothed angles."""
        cutoff = min(0.4 * self.rate_hz, 5 * self.lowpass_hz)
        sos = butter(2, cutoff, fs=self.rate_hz, output="sos")
        trials = []
        for t in self.trials:
            q = sosfiltfilt(sos, np.round(t.q / step) * step)
            v = np.gradient(q) * self.rate_hz
            trials.append(dataclasses.replace(t, q=q, v=v, a=np.gradient(v) * self.rate_hz))
        read = copy.copy(self)
        read.q, read.v, read.a = (np.concatenate([getattr(t, n) for t in trials]) for n in ("q", "v", "a"))
        read.direction = np.concatenate([held(t.q, 1.5 * step) for t in trials])
        return read

    def by_trial(self, f):
        return np.concatenate([f(s) for s in self.slices])


def directions(v):
    """Sign of the motion, held through rests; before the first motion that of the first."""
    still = 1e-6 * np.max(np.abs(v))
    sign = np.where(np.abs(v) > still, np.sign(v), 0.0)
    index = np.maximum.accumulate(np.where(sign != 0, np.arange(len(v)), 0))
    held = sign[index]
    first = np.flatnonzero(sign)
    return np.where(held == 0, sign[first[0]] if len(first) else 1.0, held)


def held(q, step):
    """Direction by hysteresis: a turn counts from its extreme on, once the angle has come back from it by `step`."""
    out, extreme, at, sign = np.empty(len(q)), q[0], 0, 0.0
    for i, x in enumerate(q.tolist()):
        if sign == 0.0:
            if abs(x - q[0]) > step:
                sign = 1.0 if x > q[0] else -1.0
                out[:i] = sign
                extreme, at = x, i
        elif (x - extreme) * sign >= 0:
            extreme, at = x, i
        elif (extreme - x) * sign > step:
            sign = -sign
            out[at + 1 : i] = sign
            extreme, at = x, i
        out[i] = sign
    return np.where(out == 0, 1.0, out)


def settled_at(q, direction):
    """The sample at which the first sustained motion has gone on for 5 % of the range: what came before is not known."""
    turned = np.flatnonzero(np.abs(q - q[0]) > 0.05 * np.ptp(q))
    return int(turned[0]) if len(turned) else 0


def passed_over(x, direction, width, shape):
    """Share of the upward branch, 0 to 1: a curve from where a turn found it to the end that the motion goes to."""
    out = np.empty(len(x))
    turns = np.flatnonzero(np.diff(direction)) + 1
    k, share = direction[0], (1 + direction[0]) / 2
    for i, j in zip([0, *turns], [*turns, len(x)]):
        s, origin = direction[i], x[max(0, i - 1)]
        end = (1 + s) / 2
        place = np.clip(k + 2 * (x[i:j] - origin) / width, -1, 1)
        u = np.ones(j - i) if abs(s - k) < 1e-9 else np.clip((place - k) / (s - k), 0, 1)
        u = np.maximum.accumulate(u)
        out[i:j] = share + shape(u) * (end - share)
        k, share = k + (s - k) * u[-1], out[j - 1]
    return out


def curve(kind, value=None):
    """Progress of the change-over as a function of the travel, both 0 to 1."""
    if kind == "arctan":
        return lambda u: np.arctan(2 * value * u) / np.arctan(2 * value)
    if kind == "power":
        return lambda u: np.maximum(u, 0) ** value
    return lambda u: u


@dataclasses.dataclass
class Parts:
    """What makes up the torque, for effects to act on."""

    world: World
    base: Base
    ratio: float  # winch torque per joint torque
    joint: np.ndarray  # load at the joint, N m
    share: np.ndarray  # of the upward branch
    friction: np.ndarray  # of the present branch at the winch


def branch(base, direction, v):
    p, s = getattr(base, direction), 1.0 if direction == "up" else -1.0
    return base.r1_m * (p["a"] + p["b"] * np.exp(-abs(p["c"]) * np.abs(v)) + s * p["d"] * np.abs(v))


def load(base, q, a):
    gravity = base.gravity_nm * np.sin(q) if base.kind == "revolute" else base.gravity_nm
    return gravity + base.inertia_kg_m2 * a


def torque(world, base, effects=()):
    """The winch's torque with the effects in it, each (effect, amount)."""
    at = lambda place: [(e, x) for e, x in effects if e.place == place]
    for effect, amount in at("base"):
        base = effect.act(base, amount)
    q = world.q
    ratio = base.r1_m / base.r2_m if base.kind == "revolute" else 1.0
    share = None
    for effect, amount in at("share"):
        share = effect.act(world, base, amount)
    if share is None and base.curve[0] == "sign":
        share = (1 + world.direction) / 2
    elif share is None:
        x = world.q * (base.r2_m if base.kind == "revolute" else 1.0)
        shape = curve(*base.curve)
        share = world.by_trial(lambda s: passed_over(x[s], world.direction[s], base.backlash_m, shape))
    up, down = branch(base, "up", world.v), branch(base, "down", world.v)
    friction = down + share * (up - down)
    parts = Parts(world, base, ratio, load(base, q, world.a), share, friction)
    shift = sum((effect.act(parts, amount) for effect, amount in at("angle")), 0.0)
    if np.ndim(shift):
        parts.joint = load(base, q + shift, world.a)
    parts.joint = parts.joint + sum((effect.act(parts, amount) for effect, amount in at("joint")), 0.0)
    friction = friction + sum((effect.act(parts, amount) for effect, amount in at("friction")), 0.0)
    mu = base.down["mu"] + share * (base.up["mu"] - base.down["mu"])
    y = (ratio * parts.joint + friction) / (1 - mu)
    for effect, amount in at("reading"):
        y = effect.act(parts, y, amount)
    return y
