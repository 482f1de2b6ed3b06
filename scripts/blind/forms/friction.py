"""Friction: Stribeck, load, ripple (and torque ripple, its likeness), drag beyond linear, warming up."""
import numpy as np

from forms.base import Form, form


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
