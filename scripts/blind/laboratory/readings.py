"""What the drum, the torque sensor, its amplifier and its clock may do to the reading."""
import numpy as np
from scipy.ndimage import gaussian_filter1d
from scipy.signal import bessel, butter, sosfilt, sosfilt_zi

from draw import Unfit, pick, uniform
from effect import Effect, wave


def torque_ripple(rng, scales):
    """A torque by place, or a drum off centre, which shows more under load."""
    forms = ["sine", "harmonics", "drum_once", "growing", "two_tones", "sawtooth", "eccentric_radius"]
    variant, k, function = wave(rng, scales, forms)
    q, top = scales.world.q, scales.top
    under_load = variant == "eccentric_radius"
    if under_load and np.max(np.abs(scales.ratio * scales.load / scales.carried)) < 4 * scales.floor:
        raise Unfit("no load to modulate")

    def reading(y, amount):
        if under_load:
            return y + amount * function(q) * (0.3 * top + 0.7 * np.abs(scales.y)) / top
        return y + amount * function(q)

    told = f"{variant}, {k * scales.span / 6.2832:.2f} periods"
    return Effect(told, start=1.5 * scales.floor, most=0.4 * scales.reach, reading=reading)


def sensor_bias(rng, scales):
    """A zero that is off, or set a little differently before each trial."""
    sign = rng.choice([-1, 1])
    variant = pick(rng, "constant", "tare_varies")
    zeros = np.ones(scales.trials)
    if variant == "tare_varies":
        zeros = 1 + 0.05 * rng.standard_normal(scales.trials)
    offset = sign * zeros[scales.world.trial]
    reading = lambda y, amount: y + amount * offset
    return Effect(variant, start=1.2 * scales.floor, most=0.8 * scales.top, reading=reading)


def sensor_gain(rng, scales):
    """A scale that is off: straight, bending under load, other on either side."""
    sign = rng.choice([-1, 1])
    variant = pick(rng, "gain", "gain_curved", "sides_differ")
    other_side = uniform(rng, 0.7, 1.0)

    def reading(y, amount):
        if variant == "gain":
            return y * (1 + sign * amount)
        if variant == "gain_curved":
            return y * (1 + sign * amount * (1 - 0.25 * np.abs(y) / scales.top))
        return y * (1 + sign * amount * np.where(y > 0, 1, other_side))

    return Effect(variant, start=0.05, most=0.45, least=1e-3, reading=reading, last=True)


def sensor_drift(rng, scales):
    """A zero that walks through the campaign."""
    if scales.wall_seconds < 45:
        raise Unfit("short")
    world = scales.world
    wall = world.wall / world.wall[-1]
    variants = ["random_walk", "thermal_exp", "linear", "two_exp"]
    if scales.trials >= 4:
        variants.append("trial_steps")
    if world.temperature is not None and np.ptp(world.temperature) > 2:
        variants.append("temperature")
    variant = pick(rng, *variants)
    sign = rng.choice([-1, 1])
    if variant == "random_walk":
        walk = gaussian_filter1d(np.cumsum(rng.standard_normal(60)), 3)
        z = np.interp(wall, np.linspace(0, 1, 60), walk)
    elif variant == "thermal_exp":
        z = 1 - np.exp(-wall / uniform(rng, 0.15, 0.6))
    elif variant == "two_exp":
        z = 1 - 0.6 * np.exp(-wall / uniform(rng, 0.05, 0.15)) - 0.4 * np.exp(-wall / uniform(rng, 0.3, 0.8))
    elif variant == "linear":
        z = wall + 0.15 * wall**2
    elif variant == "temperature":
        z = world.temperature - world.temperature[0]
    else:
        z = np.cumsum(rng.standard_normal(scales.trials))[world.trial]
    z = z - (z[0] if rng.random() < 0.5 else np.mean(z))
    z = sign * z / (np.std(z) + 1e-12)
    reading = lambda y, amount: y + amount * z
    return Effect(variant, start=1.2 * scales.floor, most=0.5 * scales.top, reading=reading)


def time_delay(rng, scales):
    """Torque later or earlier than the angle: transport, or a filter in the amplifier."""
    world = scales.world
    rate_hz = world.rate_hz
    variant = pick(rng, "pure", "pure", "early", "filter1", "butter2", "bessel2")

    def late(y, tau):
        t = np.arange(len(y)) / rate_hz
        if variant == "pure":
            return np.interp(t - tau, t, y)
        if variant == "early":
            return np.interp(t + tau, t, y)
        order = 1 if variant == "filter1" else 2
        corner = (np.sqrt(2) if variant == "butter2" else 1.0) / (2 * np.pi * tau)
        if corner > 0.45 * rate_hz:
            return np.interp(t - tau, t, y)
        design = {"norm": "delay"} if variant == "bessel2" else {}
        make = bessel if variant == "bessel2" else butter
        sos = make(order, corner / (rate_hz / 2), output="sos", **design)
        return sosfilt(sos, y, zi=sosfilt_zi(sos) * y[0])[0]

    def reading(y, amount):
        return np.concatenate([late(y[s], amount) for s in world.slices])

    return Effect(variant, start=0.02, most=0.15, least=1e-3, reading=reading, last=True)


def saturation(rng, scales):
    """An amplifier at its rails: hard or soft, at both ends, at one, at two that differ."""
    variant = pick(rng, "hard", "hard", "soft_tanh", "soft_power", "one_side", "rails_differ")
    y0 = scales.y
    top = max(abs(np.quantile(y0, 0.001)), abs(np.quantile(y0, 0.999)))
    side = 1 if np.max(y0) > -np.min(y0) else -1
    exponent = uniform(rng, 5, 12)
    nearer = uniform(rng, 0.75, 1)

    def reading(y, amount):
        rail = top * (1 - amount)
        if variant == "hard":
            return np.clip(y, -rail, rail)
        if variant == "rails_differ":
            return np.clip(y, -rail * (nearer if side < 0 else 1), rail * (nearer if side > 0 else 1))
        if variant == "one_side":
            return np.minimum(y, rail) if side > 0 else np.maximum(y, -rail)
        if variant == "soft_tanh":
            knee = 0.85 * rail
            size = np.abs(y)
            bent = knee + (rail - knee) * np.tanh((size - knee) / (rail - knee))
            return np.sign(y) * np.where(size > knee, bent, size)
        return y / (1 + (np.abs(y) / rail) ** exponent) ** (1 / exponent)

    return Effect(variant, start=0.15, most=0.6, least=0.01, reading=reading, last=True, clips=True)
