"""What the sensor and the recorder make of the torque."""
import numpy as np
from scipy.signal import lfilter

from forms.base import Form, form


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
