"""What the torque sensor, its amplifier and its clock may do: physics of strain gauges, electronics and transport."""
import numpy as np
from scipy.signal import sosfilt, tf2sos

from effect import Effect, log_uniform


LONGEST_S = 0.08  # of a delay


def sensor_bias(world, base, rng, size):
    """A zero that was set under load."""
    sign = rng.choice([-1.0, 1.0])
    return Effect("sensor_bias", "offset", "reading", lambda parts, y, amount: y + sign * amount * size)


def sensor_gain(world, base, rng, size):
    """The bridge's supply or a wrong calibration; a gauge that is slightly softer under much load."""
    variant = str(rng.choice(["scale", "scale_bent"]))
    sign = rng.choice([-1.0, 1.0])

    def act(parts, y, amount):
        top = np.quantile(np.abs(y), 0.98)
        bent = 0.12 * np.abs(y) / top if variant == "scale_bent" else 0.0
        return y * (1 + sign * amount * (1 - bent))

    return Effect("sensor_gain", variant, "reading", act, most=0.6)


def sensor_drift(world, base, rng, size):
    """A zero that walks: at random, as the gauges warm in two stages, with the air's temperature, by creep in each trial."""
    several = len(world.trials) > 1
    variants = ["random_walk", "two_stage_warming", "room_temperature"] + (["creep_in_trial"] if several else [])
    variant = str(rng.choice(variants))
    clock, total = world.elapsed, world.elapsed.max()
    sign = rng.choice([-1.0, 1.0])
    if variant == "random_walk":
        grid = np.linspace(0, total, 600)
        walk = np.cumsum(rng.normal(size=600))
        drift = np.interp(clock, grid, np.convolve(np.pad(walk, 20, mode="edge"), np.hanning(41) / np.hanning(41).sum(), mode="valid"))
    elif variant == "two_stage_warming":
        tau = total * rng.uniform(0.05, 0.4)
        drift = 0.5 * (1 - np.exp(-clock / tau)) + 0.5 * (1 - np.exp(-clock / (4 * tau)))
    elif variant == "room_temperature":
        drift = np.sin(2 * np.pi * clock / (total * rng.uniform(0.8, 2.5)) + rng.uniform(0, 2 * np.pi))
    else:
        drift = np.log1p(world.t / (0.1 * max(t.t_s[-1] for t in world.trials)))
    drift = sign * (drift - drift.mean()) / max(1e-12, np.std(drift))
    needs = () if variant == "creep_in_trial" else ("clock",)
    return Effect("sensor_drift", variant, "reading", lambda parts, y, amount: y + amount * size * drift, needs=needs)


def time_delay(world, base, rng, size):
    """The amplifier's own filter of second order, transport over a bus, or the angle's: later or earlier."""
    variant = str(rng.choice(["second_order_lag", "transport", "angle_late"]))
    seconds = log_uniform(rng, 0.3, 2.5) / world.rate_hz if rng.random() < 0.3 else log_uniform(rng, 0.002, 0.06)
    damping = rng.uniform(0.6, 1.0)

    def act(parts, y, amount):
        d = seconds * amount
        if variant == "second_order_lag":  # group delay 2 zeta / w at low frequency
            w = min(2 * damping / d, 0.45 * 2 * np.pi * world.rate_hz)
            return world.by_trial(lambda s: filtered(y[s], w, damping, world.rate_hz, 2 * damping / w - d))
        if variant == "angle_late":
            d = -d
        return world.by_trial(lambda s: np.interp(world.t[s] - d, world.t[s], y[s]))

    return Effect("time_delay", variant, "reading", act, linear=False, most=max(1.0, LONGEST_S / seconds), notes={"seconds_at_one": seconds})


def filtered(y, w, damping, rate_hz, ahead_s):
    """Second-order lag (bilinear), begun in balance; what the clock cannot follow is shifted."""
    k = 2 * rate_hz
    b = np.full(3, w * w) * [1, 2, 1]
    a = np.array([k * k + 2 * damping * w * k + w * w, 2 * w * w - 2 * k * k, k * k - 2 * damping * w * k + w * w])
    sos = tf2sos(b / a[0], a / a[0])
    out = sosfilt(sos, y - y[0]) + y[0]
    t = np.arange(len(y)) / rate_hz
    return np.interp(t + ahead_s, t, out) if ahead_s < 0 else out


def saturation(world, base, rng, size):
    """The amplifier meets its rail: sharply, or bending over before it; at one end or both."""
    variant = str(rng.choice(["rail_one_end", "rail_both", "bends_over"]))
    upper = rng.random() < 0.5

    def act(parts, y, amount):
        low, high = np.quantile(y, [0.005, 0.995])
        reach = high - low
        top = high - 0.25 * amount * reach if variant == "rail_both" or upper else np.inf
        bottom = low + 0.25 * amount * reach if variant == "rail_both" or not upper else -np.inf
        if variant != "bends_over":
            return np.clip(y, bottom, top)
        knee = 0.02 * reach
        y = y - knee * np.logaddexp(0, np.clip((y - top) / knee, -500, 500)) if np.isfinite(top) else y
        return y + knee * np.logaddexp(0, np.clip((bottom - y) / knee, -500, 500)) if np.isfinite(bottom) else y

    return Effect("saturation", variant, "reading", act, linear=False, most=1.8)


READINGS = {f.__name__: f for f in (sensor_bias, sensor_gain, sensor_drift, time_delay, saturation)}
