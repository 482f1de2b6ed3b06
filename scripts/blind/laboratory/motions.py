"""What a joint may be told to do, and how a controller follows."""
import numpy as np
from scipy.ndimage import gaussian_filter1d

from draw import log_uniform, uniform

REFERENCE_HZ = 250.0


def softened(q, seconds):
    return gaussian_filter1d(q, REFERENCE_HZ * seconds, mode="nearest")


def triangle(low, high, speed, cycles, rest_s):
    """Back and forth at constant speed, with rests before and after."""
    leg = (high - low) / speed
    t = np.arange(int((2 * leg * cycles + 2 * rest_s) * REFERENCE_HZ)) / REFERENCE_HZ - rest_s
    phase = np.mod(np.clip(t, 0, 2 * leg * cycles) / leg, 2.0)
    return low + (high - low) * np.where(phase <= 1, phase, 2 - phase)


def trapezoidal_move(start, goal, fastest, acceleration, rate_hz=REFERENCE_HZ):
    """From start to goal with bounded speed and acceleration."""
    distance = abs(goal - start)
    if distance < 1e-9:
        return np.full(2, start)
    ramp = min(fastest / acceleration, np.sqrt(distance / acceleration))
    top = ramp * acceleration
    cruise = max(distance / top - ramp, 0)
    total = 2 * ramp + cruise
    t = np.arange(max(int(total * rate_hz), 3)) / rate_hz
    rising = 0.5 * acceleration * t**2
    cruising = 0.5 * acceleration * ramp**2 + top * (t - ramp)
    falling = distance - 0.5 * acceleration * (total - t) ** 2
    travel = np.where(t < ramp, rising, np.where(t < ramp + cruise, cruising, falling))
    return start + np.sign(goal - start) * np.clip(travel, 0, distance)


def minimum_jerk_move(start, goal, samples):
    s = np.linspace(0, 1, samples)
    return start + (goal - start) * (10 * s**3 - 15 * s**4 + 6 * s**5)


def moves(rng, low, high, seconds, typical, longest_rest_s, shape, rate_hz=REFERENCE_HZ):
    """From place to place, resting between; shape: minjerk or trap."""
    place = uniform(rng, low, high)
    parts = [np.full(int(uniform(rng, 0.1, 1) * rate_hz), place)]
    count = len(parts[0])
    while count < seconds * rate_hz:
        goal = uniform(rng, low, high)
        if abs(goal - place) < 0.15 * (high - low):
            continue
        speed = typical * log_uniform(rng, 0.4, 2.0)
        if shape == "minjerk":
            move = minimum_jerk_move(place, goal, max(int(1.9 * abs(goal - place) / speed * rate_hz), 8))
        else:
            move = trapezoidal_move(place, goal, speed, speed / uniform(rng, 0.1, 0.5), rate_hz)
        rest = np.full(int(uniform(rng, 0.05, longest_rest_s) * rate_hz), goal)
        parts += [move, rest]
        count += len(move) + len(rest)
        place = goal
    return np.concatenate(parts)[: int(seconds * rate_hz)]


def sines(low, high, seconds, frequencies_hz, sizes, phases, rate_hz=REFERENCE_HZ):
    """A sum of sines that fills the range."""
    t = np.arange(int(seconds * rate_hz)) / rate_hz
    q = sum(a * np.sin(2 * np.pi * f * t + p) for f, a, p in zip(frequencies_hz, sizes, phases))
    q = q / max(np.max(np.abs(q)), 1e-9)
    return (low + high) / 2 + (high - low) / 2 * q


def followed(rng, q, rate_hz, span, level, most=0.15):
    """A reference as a controller follows it: early or late, with a ripple by place; rests stay rests."""
    t = np.arange(len(q)) / rate_hz
    noise = rng.standard_normal(len(q) // max(int(rate_hz / 20), 1) + 4)
    noise = gaussian_filter1d(noise, 20 * uniform(rng, 0.15, 0.8))
    noise = noise / (np.std(noise) + 1e-9)
    late = np.interp(t, np.arange(len(noise)) / 20, noise)
    steepest = np.max(np.abs(np.gradient(late))) * rate_hz
    size = min(level * 0.01, most / max(steepest, 1e-9))
    q = np.interp(np.clip(t + size * late, 0, t[-1]), t, q)
    k = 2 * np.pi * uniform(rng, 3, 15) / span
    ripple = level * uniform(rng, 0, min(0.08, most * 0.8)) / k
    q = q + ripple * np.sin(k * q + uniform(rng, 0, 6.28))
    return gaussian_filter1d(q, max(rate_hz * uniform(rng, 0.006, 0.02), 0.6), mode="nearest")
