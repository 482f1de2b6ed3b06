"""Things that no effect of the library names."""
import numpy as np
from scipy.ndimage import gaussian_filter1d
from scipy.signal import lfilter

from draw import Unfit, pick, uniform
from effect import Effect, smooth
from plant import branches

TURN = 6.2832  # rad


def added(scales, variant, z):
    """An effect that adds a torque to the reading, an amount of one being an RMS of one."""
    z = z / (np.std(z) + 1e-12)
    reading = lambda y, amount: y + amount * z
    return Effect(variant, start=1.2 * scales.floor, most=0.6 * scales.top, reading=reading)


def by_trial(world, f):
    return np.concatenate([f(s) for s in world.slices])


def hum_beat(rng, scales):
    """The mains and a neighbour close to it, aliased below the low-pass."""
    world = scales.world
    f1 = uniform(rng, 0.25, 0.75) * scales.lowpass_hz
    f2 = f1 * (1 + uniform(rng, 0.01, 0.06))

    def hum(s):
        t = world.t[s]
        return np.sin(TURN * f1 * t + uniform(rng, 0, 6.28)) + 0.8 * np.sin(TURN * f2 * t + uniform(rng, 0, 6.28))

    return added(scales, f"aliased hum of {f1:.2f} Hz that beats with {f2:.2f} Hz", by_trial(world, hum))


def position_damping(rng, scales):
    """Damping by place."""
    k = TURN / scales.span * uniform(rng, 0.5, 1.3)
    z = scales.world.v * np.sin(k * scales.world.q + uniform(rng, 0, 6.28))
    return added(scales, "damping by place, of either sign about its mean", z)


def random_torque(rng, scales):
    """A torque that wanders anew in each trial."""
    world = scales.world
    tau = uniform(rng, 0.15, 1.0)
    samples = tau * world.rate_hz

    def wander(s):
        return gaussian_filter1d(rng.standard_normal(s.stop - s.start), samples * 0.5) * np.sqrt(samples)

    return added(scales, f"random torque, new in each trial, correlated over {tau:.2f} s", by_trial(world, wander))


def zero_steps(rng, scales):
    """Slips of the cable, after which the zero creeps back."""
    world = scales.world
    z = np.zeros(world.size)
    count = int(min(max(6, scales.seconds / uniform(rng, 6, 20)), 60))
    for k in np.sort(rng.integers(0, world.size, count)):
        z[k:] += rng.choice([-1, 1]) * uniform(rng, 0.5, 1.5)
    window = int(uniform(rng, 15, 40) * world.rate_hz)
    z = z - gaussian_filter1d(z, window, mode="nearest")
    return added(scales, f"{count} slips of the cable: steps of the zero that creep back", z)


def second_resonance(rng, scales):
    """A lightly damped mode, rung by accelerations and by friction at turns."""
    world, base = scales.world, scales.base
    f0 = uniform(rng, 0.2, 0.65) * scales.lowpass_hz
    damping = uniform(rng, 0.015, 0.06)
    up, down = branches(base, np.abs(world.v))
    drive = world.share(base) * (up - down) + (world.a / (scales.a_top + 1e-12)) * scales.friction
    w, dt = TURN * f0, 1 / world.rate_hz
    decay = np.exp(-damping * w * dt)
    cosine = np.cos(w * np.sqrt(1 - damping**2) * dt)
    ring = lambda s: lfilter([1.0], [1, -2 * decay * cosine, decay * decay], np.gradient(drive[s]))
    return added(scales, f"second mode of {f0:.2f} Hz, rung by accelerations and turns", by_trial(world, ring))


def long_memory(rng, scales):
    """A spring that relaxes, over one time or over a wide range of times."""
    world = scales.world
    z = np.zeros(world.size)
    x = (world.q - np.mean(world.q)) / scales.span
    variant = pick(rng, "relaxing spring", "fractional")
    times = [uniform(rng, 2, 6)] if variant == "relaxing spring" else [0.5, 2, 8, 25]
    for tau in times:
        keep = np.exp(-1 / world.rate_hz / tau)
        for s in world.slices:
            z[s] += x[s] - lfilter([1 - keep], [1, -keep], x[s], zi=[keep * x[s][0]])[0]
    return added(scales, f"viscoelastic memory, {variant}, over {[round(t, 1) for t in times]} s", z)


def speed_times_position(rng, scales):
    """A torque by speed and place, whichever the direction."""
    middle = scales.low + scales.span * uniform(rng, 0.35, 0.65)
    z = np.abs(scales.world.v) * (scales.world.q - middle)
    return added(scales, "torque by |speed| times position", z)


def sensor_dead_zone(rng, scales):
    """A sensor that shows nothing of small torques."""
    y0, top = scales.y, scales.top
    if np.mean(np.abs(y0) < 0.2 * top) < 0.15 or y0.max() * y0.min() > 0:
        raise Unfit("no crossing of zero")
    reading = lambda y, amount: np.where(np.abs(y) < amount * top, 0, y)
    told = "sensor that reads zero within a band about zero"
    return Effect(told, start=0.1, most=0.4, least=0.005, reading=reading, last=True)


def peak_memory(rng, scales):
    """A gauge that remembers the largest strain for a while."""
    world = scales.world
    forgets = uniform(rng, 4, 20)
    step = max(int(0.05 * world.rate_hz), 1)
    decay = np.exp(-step / world.rate_hz / forgets)

    def remembered(s):
        strain = np.abs(scales.y[s]) ** 3
        held, most = [], 0.0
        for x in strain[::step]:
            most = max(x, most * decay)
            held.append(most)
        return np.interp(np.arange(len(strain)), np.arange(len(held)) * step, held)

    z = by_trial(world, remembered)
    z = z - np.mean(z)
    if rng.random() < 0.3:
        z = z * np.sign(scales.y + 1e-12)
    return added(scales, f"offset by the largest torque so far, forgotten over {forgets:.0f} s", z)


def breathing_gain(rng, scales):
    """A scale that comes and goes."""
    world = scales.world
    period = uniform(rng, 3, 14)
    breath = lambda s: np.sin(TURN * world.t[s] / period + uniform(rng, 0, 6.28)) * scales.y[s]
    return added(scales, f"gain of the sensor that breathes with {period:.1f} s", by_trial(world, breath))


def dwell_breakaway(rng, scales):
    """Sticking that grows with rest and goes after a little travel."""
    world = scales.world
    if not scales.rests:
        raise Unfit("no rests")
    z, count = np.zeros(world.size), 0
    reach = uniform(rng, 0.03, 0.1) * scales.span
    for trial in world.slices:
        moving = (np.abs(world.v[trial]) > 1e-3 * scales.fastest).astype(int)
        starts = np.flatnonzero(np.diff(moving) == 1)
        stops = np.flatnonzero(np.diff(moving) == -1)
        for first in starts:
            earlier, later = stops[stops < first], stops[stops > first]
            rested = (first - (earlier[-1] if len(earlier) else 0)) / world.rate_hz
            if rested < 0.15:
                continue
            end = later[0] if len(later) else trial.stop - trial.start - 1
            x = world.q[trial][first:end]
            peak = np.sign(x[-1] - x[0]) * np.log1p(rested / 0.2) ** 1.5
            z[trial.start + first : trial.start + end] += peak * np.exp(-np.abs(x - x[0]) / reach)
            count += 1
    if count < 4:
        raise Unfit("few departures")
    return added(scales, "breakaway peak that grows with the rest before it", smooth(world, z, 0.01))


def chatter(rng, scales):
    """Stick-slip at low speed, its phase wandering."""
    world = scales.world
    below = np.quantile(scales.speeds, uniform(rng, 0.25, 0.5))
    f0 = uniform(rng, 0.25, 0.7) * scales.lowpass_hz
    window = 0.3 * world.rate_hz
    wander = 0.25 * gaussian_filter1d(rng.standard_normal(world.size), window) * np.sqrt(window)
    phase = np.cumsum(f0 * (1 + wander)) / world.rate_hz
    speed = np.abs(world.v)
    fades = 1 + (speed / below) ** 4
    z = (2 * np.mod(phase, 1) - 1) / fades * (speed > 1e-3 * scales.fastest) * np.sign(world.v)
    return added(scales, f"stick-slip chatter near {f0:.1f} Hz at low speed", smooth(world, z, 0.01))


def sensor_hysteresis(rng, scales):
    """A gauge that holds back when its load turns."""
    world = scales.world
    width = uniform(rng, 0.15, 0.5) * scales.top
    step = max(int(0.01 * world.rate_hz), 1)

    def lost(s):
        held, rest = scales.y[s][0], []
        for x in scales.y[s][::step]:
            held = min(max(held, x - width), x + width)
            rest.append(x - held)
        return np.interp(np.arange(s.stop - s.start), np.arange(len(rest)) * step, rest)

    z = by_trial(world, lost)
    return added(scales, "load cell with hysteresis in its own load", z - np.mean(z))


def after_reversal_creep(rng, scales):
    """What each turn leaves for a time, whatever the travel."""
    world = scales.world
    tau = uniform(rng, 0.5, 2.5)
    share = smooth(world, world.share(scales.base), 0.02)
    keep = np.exp(-1 / world.rate_hz / tau)
    creep = lambda s: lfilter([1.0], [1, -keep], np.abs(np.gradient(share[s]) * 2))
    z = by_trial(world, creep)
    return added(scales, f"torque of one sign after each turn, gone after {tau:.1f} s", z - np.mean(z))


def rectified_acceleration(rng, scales):
    """A torque of one sign by acceleration."""
    z = np.abs(smooth(scales.world, scales.world.a, 0.02))
    return added(scales, "torque by |acceleration|", z - z.mean())


def swaying_base(rng, scales):
    """A base that tilts to and fro under the joint."""
    world = scales.world
    period = uniform(rng, 2.5, 9)
    if scales.base.gravity_nm == 0:
        raise Unfit("no gravity")

    def sway(s):
        t = world.t[s]
        tilt = np.sin(TURN * t / period + uniform(rng, 0, 6.28))
        return np.cos(world.q[s]) * tilt * (1 + 0.3 * np.sin(TURN * t / period / 3.3))

    return added(scales, f"base that sways every {period:.1f} s", by_trial(world, sway))


def speed_noise(rng, scales):
    """A rumble within the low-pass, louder with speed."""
    world = scales.world
    f0 = uniform(rng, 0.3, 0.6) * scales.lowpass_hz
    rumble = gaussian_filter1d(rng.standard_normal(world.size), world.rate_hz / (TURN * f0)) * np.sqrt(world.rate_hz)
    return added(scales, "rumble as loud as the speed", rumble * np.abs(world.v))


OUTSIDE = {f.__name__: f for f in (
    hum_beat, position_damping, random_torque, zero_steps, second_resonance, long_memory, speed_times_position,
    sensor_dead_zone, peak_memory, breathing_gain, dwell_breakaway, chatter, sensor_hysteresis, after_reversal_creep,
    rectified_acceleration, swaying_base, speed_noise)}
