"""The effects of the library's list, each in forms of our own.

FORMS: effect id -> {variant: maker}. A maker draws its shape from `rng` and the case's `Setting` and returns a `Form`.
Linear forms give a shape of order 1 that is scaled by the strength (N m); the others take the strength themselves.
"""
import dataclasses
from collections.abc import Callable

import numpy as np
from scipy.signal import lfilter

from plant import share_by_sign, share_over_clearance

FORMS = {}


@dataclasses.dataclass
class Setting:
    """What a form may be drawn to fit: the joint, its campaign and the torques in it."""

    joint: object
    trials: list
    low_rad: float
    high_rad: float
    top_speed_rad_s: float
    length_s: float  # of the whole campaign on its clock, pauses included
    torque_low_nm: float
    torque_high_nm: float

    @property
    def torque_span_nm(self):
        return self.torque_high_nm - self.torque_low_nm

    @property
    def width_rad(self):
        return self.high_rad - self.low_rad

    @property
    def ratio(self):
        return self.joint.r1_m / self.joint.r2_m


@dataclasses.dataclass
class Form:
    hook: str
    act: Callable
    largest: float  # physical limit of the strength
    linear: bool = True
    sized: bool = True  # False: its size is drawn, the floor is chosen to fit the strength wanted
    warm: Callable = None  # of what depends on warmth: 1 cold, 0 warm; a thermometer may show it


def form(effect, variant):
    def keep(maker):
        FORMS.setdefault(effect, {})[variant] = maker
        return maker

    return keep


# ---- after a reversal


def from_curve(g):
    act = lambda st, s: share_over_clearance(st.joint.r2_m * st.q, st.joint.backlash_m, g)
    return Form("share", act, 1, False, False)


@form("reversal_transition", "smoothstep")
def _(rng, c):
    return from_curve(lambda u: u * u * (3 - 2 * u))


@form("reversal_transition", "power")
def _(rng, c):
    n = rng.choice([rng.uniform(0.3, 0.6), rng.uniform(1.6, 2.5)]) if c.joint.curve[0] == "linear" else rng.uniform(0.4, 1.5)
    return from_curve(lambda u: u**n)


@form("reversal_transition", "arctan")
def _(rng, c):
    p = rng.uniform(1.2, 3.5)
    return from_curve(lambda u: np.arctan(2 * p * u) / np.arctan(2 * p))


def bristle(x, rate_of):
    """K~ of an elastic element: z from -1 to 1, dz = dx rate(z sense), started slid."""
    senses = 2 * share_by_sign(x) - 1
    steps = np.abs(np.diff(x, prepend=x[0]))
    z, out = senses[0], np.empty(len(x))
    for i, (step, sense) in enumerate(zip(steps.tolist(), senses.tolist())):
        z += sense * step * rate_of(z * sense)
        z = min(1.0, max(-1.0, z))
        out[i] = z
    return (out + 1) / 2


@form("presliding", "dahl")
def _(rng, c):
    slip_rad = c.width_rad * np.exp(rng.uniform(np.log(0.003), np.log(0.03)))
    return Form("share", lambda st, s: bristle(st.q, lambda z: (1 - z) / slip_rad), 1, False, False)


@form("presliding", "dahl_exponent")
def _(rng, c):
    slip_rad, power = c.width_rad * np.exp(rng.uniform(np.log(0.004), np.log(0.03))), rng.uniform(1.4, 2.2)
    return Form("share", lambda st, s: bristle(st.q, lambda z: ((1 - z) / 2) ** power * 2 / slip_rad), 1, False, False)


@form("presliding", "lugre")
def _(rng, c):
    """Bristles that bend less far the faster they are swept."""
    slip_rad, speed = c.width_rad * np.exp(rng.uniform(np.log(0.004), np.log(0.03))), c.top_speed_rad_s * rng.uniform(0.2, 1.0)

    def act(st, s):
        local = np.cumsum(np.abs(np.diff(st.q, prepend=st.q[0])) * (1 + np.abs(st.v) / speed)) / slip_rad
        signed = np.cumsum(np.diff(local, prepend=0.0) * np.sign(np.diff(st.q, prepend=st.q[0])))
        return bristle(signed, lambda z: 1 - z)

    return Form("share", act, 1, False, False)


@form("presliding", "iwan")
def _(rng, c):
    """Five elastic elements in parallel, each slipping at its own displacement."""
    slips = c.width_rad * np.exp(rng.uniform(np.log(0.002), np.log(0.04), 5))
    weights = rng.dirichlet(np.full(5, 2.0))

    def act(st, s):
        return sum(w * share_over_clearance(st.q, 2 * d, lambda u: u) for w, d in zip(weights, slips))

    return Form("share", act, 1, False, False)


# ---- friction


@form("stribeck", "gaussian")
def _(rng, c):
    v_s = c.top_speed_rad_s * np.exp(rng.uniform(np.log(0.04), np.log(0.3)))
    return Form("winch", lambda st: st.sense * np.exp(-((st.v / v_s) ** 2)), c.torque_span_nm)


@form("stribeck", "rational")
def _(rng, c):
    v_s, n = c.top_speed_rad_s * np.exp(rng.uniform(np.log(0.04), np.log(0.25))), rng.uniform(1, 2)
    return Form("winch", lambda st: st.sense / (1 + np.abs(st.v / v_s) ** n), c.torque_span_nm)


@form("stribeck", "two_sided")
def _(rng, c):
    v_s, n = c.top_speed_rad_s * np.exp(rng.uniform(np.log(0.04), np.log(0.25), 2)), rng.uniform(0.6, 2.0)
    other = rng.uniform(0.4, 1.0)

    def act(st):
        up, down = np.exp(-np.abs(st.v / v_s[0]) ** n), -other * np.exp(-np.abs(st.v / v_s[1]) ** n)
        return down + st.share * (up - down)

    return Form("winch", act, c.torque_span_nm)


@form("load_dependent_friction", "saturating")
def _(rng, c):
    knee = c.joint.gravity_nm * rng.uniform(0.5, 1.5)
    return Form("winch", lambda st: st.sense * np.abs(st.load) / (knee + np.abs(st.load)), c.torque_span_nm)


@form("load_dependent_friction", "capstan")
def _(rng, c):
    angle = rng.uniform(0.5, 2.0)
    top = c.joint.gravity_nm
    return Form("winch", lambda st: st.sense * np.expm1(angle * np.abs(st.load) / top), c.torque_span_nm)


@form("load_dependent_friction", "tension")
def _(rng, c):
    pretension = c.torque_span_nm * rng.uniform(0.02, 0.2)
    return Form("winch", lambda st: st.sense * np.hypot(st.y, pretension), c.torque_span_nm)


def harmonics(rng, count):
    """A periodic function of position with overtones."""
    phase, size = rng.uniform(0, 2 * np.pi, 3), np.array([1, rng.uniform(0, 0.4), rng.uniform(0, 0.25)])
    return lambda x: sum(s * np.sin(k * count * x + p) for k, s, p in zip((1, 2, 3), size, phase))


def sawtooth(rng, count):
    phase, rise = rng.uniform(0, 1), rng.uniform(0.6, 0.9)

    def act(x):
        turn = (count * x / (2 * np.pi) + phase) % 1
        return np.where(turn < rise, 2 * turn / rise - 1, 1 - 2 * (turn - rise) / (1 - rise))

    return act


def waves_in_range(rng, c):
    """Periods per turn, such that the range shows 2.5 to 14 of them, and the low-pass lets them through at most speeds."""
    return int(np.ceil(2 * np.pi / c.width_rad * np.exp(rng.uniform(np.log(2.5), np.log(14)))))


@form("friction_ripple", "harmonics")
def _(rng, c):
    wave = harmonics(rng, waves_in_range(rng, c))
    return Form("winch", lambda st: st.sense * wave(st.q), c.torque_span_nm)


@form("friction_ripple", "sawtooth")
def _(rng, c):
    wave = sawtooth(rng, waves_in_range(rng, c))
    return Form("winch", lambda st: st.sense * wave(st.q), c.torque_span_nm)


@form("friction_ripple", "share_of_friction")
def _(rng, c):
    count, phase = waves_in_range(rng, c), rng.uniform(0, 2 * np.pi)
    return Form("friction", lambda st: np.sin(count * st.q + phase), 0.9)


@form("torque_ripple", "harmonics")
def _(rng, c):
    wave = harmonics(rng, waves_in_range(rng, c))
    return Form("winch", lambda st: wave(st.q), c.torque_span_nm)


@form("torque_ripple", "sawtooth")
def _(rng, c):
    wave = sawtooth(rng, waves_in_range(rng, c))
    return Form("winch", lambda st: wave(st.q), c.torque_span_nm)


@form("torque_ripple", "eccentric_pulley")
def _(rng, c):
    """The pull of the load through a pulley that is not round, once or more in its own turns."""
    count, phase = waves_in_range(rng, c), rng.uniform(0, 2 * np.pi)

    def act(st):
        return (st.load + 0.6 * c.joint.gravity_nm) * np.sin(count * st.q + phase) / c.joint.gravity_nm

    return Form("winch", act, c.torque_span_nm)


@form("quadratic_viscous", "power")
def _(rng, c):
    n = rng.uniform(1.8, 2.2)
    return Form("winch", lambda st: np.sign(st.v) * np.abs(st.v / c.top_speed_rad_s) ** n, 2 * c.torque_span_nm)


@form("quadratic_viscous", "one_sided_more")
def _(rng, c):
    n, less = rng.uniform(1.8, 2.2), rng.uniform(0.5, 0.9)

    def act(st):
        return np.where(st.v > 0, 1, -less) * np.abs(st.v / c.top_speed_rad_s) ** n

    return Form("winch", act, 2 * c.torque_span_nm)


def cold(rng, length_s):
    """1 at the start of the campaign, falling over minutes: exponential, or hyperbolic with a long tail."""
    settle_s = length_s * rng.uniform(0.1, 0.45)
    if rng.random() < 0.5:
        return lambda st: np.exp(-st.trial.elapsed_s / settle_s)
    return lambda st: 1 / (1 + st.trial.elapsed_s / settle_s)


@form("warm_up", "whole_friction")
def _(rng, c):
    warm = cold(rng, c.length_s)
    return Form("friction", warm, 2.0, warm=warm)


@form("warm_up", "coulomb_part")
def _(rng, c):
    warm = cold(rng, c.length_s)
    return Form("winch", lambda st: st.sense * warm(st), c.torque_span_nm, warm=warm)


@form("warm_up", "grease")
def _(rng, c):
    """Coulomb and, more so, viscous friction."""
    warm, part = cold(rng, c.length_s), rng.uniform(0.3, 0.7)

    def act(st):
        return warm(st) * ((1 - part) * st.sense + part * st.v / (0.5 * c.top_speed_rad_s))

    return Form("winch", act, c.torque_span_nm, warm=warm)


# ---- the load's side


@form("gravity_phase", "at_joint")
def _(rng, c):
    return Form("load", lambda st: np.cos(st.q), 0.6 * c.joint.gravity_nm)


@form("gravity_phase", "negative")
def _(rng, c):
    return Form("load", lambda st: -np.cos(st.q), 0.6 * c.joint.gravity_nm)


@form("gravity_phase", "turned")
def _(rng, c):
    """The centre of mass turned off the assumed line: the amplitude stays."""
    sign = rng.choice([-1, 1])

    def act(st, angle_rad):
        mu = [st.joint.friction[d]["mu_c"] for d in ("down", "up")]
        change = c.joint.gravity_nm * (np.sin(st.q + sign * angle_rad) - np.sin(st.q))
        return st.y + c.ratio * change / (1 - mu[0] - st.share * (mu[1] - mu[0]))

    return Form("strain", act, 0.5, False)


@form("elastic_spring", "stiffening")
def _(rng, c):
    rest, more = rng.uniform(c.low_rad, c.high_rad), rng.uniform(0.0, 0.4)

    def act(st):
        x = (st.q - rest) / c.width_rad
        return x * (1 + more * x * x)

    return Form("load", act, 4 * c.joint.gravity_nm)


@form("elastic_spring", "at_winch")
def _(rng, c):
    rest = rng.uniform(c.low_rad - 0.3 * c.width_rad, c.high_rad + 0.3 * c.width_rad)
    return Form("winch", lambda st: (st.q - rest) / c.width_rad, c.torque_span_nm)


@form("inertia", "at_joint")
def _(rng, c):
    top = max(np.abs(t.a).max() for t in c.trials)
    return Form("load", lambda st: st.a / top, 10 * c.joint.gravity_nm)


@form("inertia", "turning_pulley")
def _(rng, c):
    top, uneven, phase = max(np.abs(t.a).max() for t in c.trials), rng.uniform(0, 0.15), rng.uniform(0, 6)
    act = lambda st: st.a / top * (1 + uneven * np.sin(st.q + phase))
    return Form("winch", act, 10 * c.torque_span_nm)


@form("joint_coupling", "position")
def _(rng, c):
    phase = rng.uniform(0, 2 * np.pi)
    return Form("winch", lambda st: np.sin(st.trial.other[0] + phase), c.torque_span_nm)


@form("joint_coupling", "gravity")
def _(rng, c):
    """The base tilts with the other joint, and gravity's angle with it."""
    ratio = rng.choice([-1, 1]) * rng.uniform(0.5, 1.0)
    act = lambda st: np.sin(st.q + ratio * st.trial.other[0]) - np.sin(st.q)
    return Form("load", act, 2 * c.joint.gravity_nm)


@form("joint_coupling", "friction")
def _(rng, c):
    soft = 0.1 * max(np.abs(t.other[1]).max() for t in c.trials)
    return Form("winch", lambda st: np.tanh(st.trial.other[1] / soft), c.torque_span_nm)


@form("joint_coupling", "viscous")
def _(rng, c):
    """Cables that rub where they pass the other joint."""
    top = max(np.abs(t.other[1]).max() for t in c.trials)
    return Form("winch", lambda st: st.trial.other[1] / top, c.torque_span_nm)


@form("joint_coupling", "inertial")
def _(rng, c):
    top = max(np.abs(t.other[2]).max() for t in c.trials)
    return Form("load", lambda st: np.cos(st.q) * st.trial.other[2] / top, 5 * c.joint.gravity_nm)


@form("joint_coupling", "spring")
def _(rng, c):
    mean = np.mean([t.other[0].mean() for t in c.trials])
    return Form("winch", lambda st: st.trial.other[0] - mean * 0.8, c.torque_span_nm)


# ---- the cable


def moved(st, stretch):
    """The joint behind its measured angle by `stretch`."""
    q = st.q - stretch
    rate = st.trial.rate_hz
    v = np.gradient(q) * rate
    return q, v, np.gradient(v) * rate


@form("cable_elasticity", "hardening_by_load")
def _(rng, c):
    harder = rng.uniform(0.0, 0.5)
    top = c.joint.gravity_nm

    def act(st, s):
        load = c.joint.gravity_nm * np.sin(st.q) / top
        return moved(st, s * load / (1 + harder * np.abs(load)))

    return Form("motion", act, 0.25, False)


@form("cable_elasticity", "slack_taken_up")
def _(rng, c):
    """Stiff only once the strands lie together: the stretch grows as a root of the load."""
    power = rng.uniform(0.6, 0.9)

    def act(st, s):
        load = np.sin(st.q)
        return moved(st, s * load / np.maximum(np.abs(load), 0.02) ** (1 - power))

    return Form("motion", act, 0.25, False)


@form("cable_elasticity", "by_tension")
def _(rng, c):
    """The stretch follows the whole tension, friction included; friction follows the winch."""
    softer = rng.uniform(0.0, 0.5)

    def act(st, s):
        y = st.y
        for _ in range(3):
            relative = y / c.torque_span_nm
            stretch = s * relative / (1 + softer * np.abs(relative))
            y = st.y + c.ratio * c.joint.gravity_nm * (np.sin(st.q - stretch) - np.sin(st.q)) / (1 - c.joint.friction["up"]["mu_c"])
        return y

    return Form("strain", act, 0.3, False)


# ---- ends and touches


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
            (rng.uniform(0.15, 0.8) * long, rng.uniform(shortest_s, longest_s), rng.choice([-1, 1]) * rng.uniform(0.5, 1.0)) for _ in range(rng.integers(1, 4))
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


# ---- the measurement


@form("sensor_bias", "constant")
def _(rng, c):
    sign = rng.choice([-1, 1])
    return Form("winch", lambda st: np.full(len(st.q), float(sign)), 0.5 * c.torque_span_nm)


@form("sensor_gain", "factor")
def _(rng, c):
    sign = rng.choice([-1, 1])
    return Form("sensor", lambda y, st, s: y * (1 + sign * s), 0.5, False)


@form("sensor_drift", "slow_sine")
def _(rng, c):
    turns, phase = rng.uniform(0.4, 1.2), rng.uniform(0, 2 * np.pi)
    act = lambda st: np.sin(2 * np.pi * turns * st.trial.elapsed_s / c.length_s + phase)
    return Form("winch", act, c.torque_span_nm)


@form("sensor_drift", "quadratic")
def _(rng, c):
    bend = rng.uniform(-0.6, 0.6)
    act = lambda st: (1 - bend) * st.trial.elapsed_s / c.length_s + bend * (st.trial.elapsed_s / c.length_s) ** 2
    return Form("winch", act, c.torque_span_nm)


@form("sensor_drift", "settling")
def _(rng, c):
    settle_s = c.length_s * rng.uniform(0.2, 0.6)
    return Form("winch", lambda st: np.exp(-st.trial.elapsed_s / settle_s), c.torque_span_nm)


@form("sensor_drift", "each_trial")
def _(rng, c):
    """The amplifier is switched on with each trial."""
    settle_s = max(t.t_s[-1] for t in c.trials) * rng.uniform(0.3, 1.0)
    return Form("winch", lambda st: -np.expm1(-st.trial.t_s / settle_s), c.torque_span_nm)


def shifted(y, st, delay_s):
    """y as it was `delay_s` ago."""
    return np.interp(st.trial.t_s - delay_s, st.trial.t_s, y)


@form("sensor_drift", "by_order")
def _(rng, c):
    """From trial to trial, on clocks that all start at 0."""
    settle_s = c.length_s * rng.uniform(0.3, 2.0)
    return Form("winch", lambda st: -np.expm1(-st.trial.elapsed_s / settle_s), c.torque_span_nm)


@form("time_delay", "late")
def _(rng, c):
    return Form("sensor", shifted, 0.15, False)


@form("time_delay", "early")
def _(rng, c):
    return Form("sensor", lambda y, st, s: shifted(y, st, -s), 0.15, False)


@form("time_delay", "first_order_lag")
def _(rng, c):
    def act(y, st, s):
        keep = np.exp(-1 / (st.trial.rate_hz * s))
        return lfilter([1 - keep], [1, -keep], y, zi=[keep * y[0]])[0]

    return Form("sensor", act, 0.15, False)


def level(c, s, end):
    """Where the sensor stops reading: the share `s` of the span away from the reach of the torque."""
    return c.torque_high_nm - s * c.torque_span_nm if end == "high" else c.torque_low_nm + s * c.torque_span_nm


@form("saturation", "both_ends")
def _(rng, c):
    return Form("sensor", lambda y, st, s: np.clip(y, level(c, s, "low"), level(c, s, "high")), 0.15, False)


@form("saturation", "one_end")
def _(rng, c):
    if rng.random() < 0.6:
        return Form("sensor", lambda y, st, s: np.minimum(y, level(c, s, "high")), 0.25, False)
    return Form("sensor", lambda y, st, s: np.maximum(y, level(c, s, "low")), 0.25, False)


@form("saturation", "slightly_soft")
def _(rng, c):
    """Flat but for a slope of one or two hundredths."""
    slope = rng.uniform(0.005, 0.02)

    def act(y, st, s):
        over = np.maximum(0, y - level(c, s, "high"))
        return y - (1 - slope) * over

    return Form("sensor", act, 0.25, False)
