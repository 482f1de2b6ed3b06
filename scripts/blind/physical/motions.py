"""Motions of a position-controlled joint: what it is told to do, sampled, with exact speed and acceleration.

Every motion is computed on a fine clock and sampled down, so that a slow recording has no error of differentiation in it.
"""
import dataclasses

import numpy as np
from scipy.interpolate import PchipInterpolator

FINE_HZ = 1000.0  # the clock on which a motion is computed, at least
MOST_SAMPLES = 90_000  # of a campaign
STYLES = ("sweeps", "cosines", "multisine", "moves", "long", "splines", "steps", "chirp")


@dataclasses.dataclass
class Trial:
    name: str
    protocol: str
    trajectory: str
    repeat: int
    t_s: np.ndarray
    q: np.ndarray
    v: np.ndarray
    a: np.ndarray
    start_s: float = 0.0  # on the campaign's own clock
    speed_rad_s: float | None = None
    other: np.ndarray | None = None  # angle of a second joint, its speed


def smooth(x, seconds, rate_hz):
    """Convolution with a raised cosine: bounded acceleration and jerk."""
    n = max(3, int(seconds * rate_hz) | 1)
    window = np.hanning(n + 2)[1:-1]
    padded = np.pad(x, n // 2, mode="edge")
    return np.convolve(padded, window / window.sum(), mode="valid")


def sampled(q_fine, factor):
    """Angle, speed and acceleration at the recording's rate."""
    rate = FINE_HZ if factor is None else factor[1]
    v = np.gradient(q_fine) * rate
    a = np.gradient(v) * rate
    step = factor[0]
    return q_fine[::step], v[::step], a[::step]


class Range:
    """Where and how fast a joint moves."""

    def __init__(self, low, high, fastest):
        self.low, self.high, self.fastest = low, high, fastest
        self.middle, self.half = (low + high) / 2, (high - low) / 2


def clock(duration_s, rate_hz):
    """Fine time, (step, fine rate)."""
    step = max(1, int(np.ceil(FINE_HZ / rate_hz)))
    fine_hz = rate_hz * step
    return np.arange(0, duration_s, 1 / fine_hz), (step, fine_hz)


def triangle(span, speed, turns, rate_hz, rest_s=0.0):
    """Back and forth at constant speed, rounded ends, rests there if asked."""
    leg = 2 * span.half / speed
    blend = min(0.3, 0.2 * leg)
    fine, factor = clock(turns * (leg + rest_s) + 0.6, rate_hz)
    phase = fine - 0.3
    k = np.floor(phase / (leg + rest_s))
    moving = (phase >= 0) & (k < turns) & (phase - k * (leg + rest_s) < leg)
    v = np.where(moving, np.where(k % 2 == 0, speed, -speed), 0.0)
    return span.low + np.cumsum(smooth(v, blend, factor[1])) / factor[1], factor


def cosines(span, frequencies_hz, rate_hz, share=1.0):
    """Whole periods of cosines, one frequency after the other."""
    fine, factor = clock(sum(1 / f for f in frequencies_hz), rate_hz)
    q, start = np.full(len(fine), span.low), 0.0
    for f in frequencies_hz:
        inside = (fine >= start) & (fine < start + 1 / f)
        q[inside] = span.low + share * span.half * (1 - np.cos(2 * np.pi * f * (fine[inside] - start)))
        start += 1 / f
    return q, factor


def multisine(span, period_s, periods, harmonics, rng, rate_hz, top):
    """A periodic sum of sines that fills the range or reaches the top speed."""
    fine, factor = clock(period_s * periods, rate_hz)
    w = 2 * np.pi / period_s
    weight = rng.uniform(0.4, 1.0, len(harmonics)) / np.sqrt(harmonics)
    phase = rng.uniform(0, 2 * np.pi, len(harmonics))
    q = sum(a * np.sin(h * w * fine + p) for a, h, p in zip(weight, harmonics, phase))
    speed = np.max(np.abs(np.gradient(q))) * factor[1]
    q *= min(span.half / np.max(np.abs(q)), top / speed)
    return span.middle + q, factor


def moves(span, count, rng, rate_hz, rest_s=(0.2, 1.2)):
    """From place to place along minimum-jerk curves, resting between."""
    parts, place, step = [], rng.uniform(span.low, span.high), None
    _, factor = clock(1.0, rate_hz)
    for _ in range(count):
        goal = rng.uniform(span.low, span.high)
        seconds = max(0.4, 1.875 * abs(goal - place) / (span.fastest * rng.uniform(0.25, 1.0)))
        s = np.arange(0, seconds, 1 / factor[1]) / seconds
        parts.append(place + (goal - place) * (10 * s**3 - 15 * s**4 + 6 * s**5))
        parts.append(np.full(int(rng.uniform(*rest_s) * factor[1]), goal))
        place = goal
    return np.concatenate(parts), factor


def wander(span, duration_s, rng, rate_hz, slowest_s):
    """Smooth, never the same twice."""
    _, factor = clock(1.0, rate_hz)
    knots, places, at = [0.0], [span.middle], 0.0
    while at < duration_s + 1:
        goal = rng.uniform(span.low, span.high)
        at += max(slowest_s * rng.uniform(0.3, 1.0), 1.5 * abs(goal - places[-1]) / (span.fastest * rng.uniform(0.3, 1.0)))
        knots.append(at)
        places.append(goal)
    fine = np.arange(0, duration_s, 1 / factor[1])
    return smooth(PchipInterpolator(knots, places)(fine), min(0.25, slowest_s / 4), factor[1]), factor


def chirp(span, duration_s, low_hz, high_hz, rate_hz, top):
    """A sine that grows faster and, where it must, smaller."""
    fine, factor = clock(duration_s, rate_hz)
    f = low_hz * (high_hz / low_hz) ** (fine / duration_s)
    phase = 2 * np.pi * np.cumsum(f) / factor[1]
    size = np.minimum(span.half, top / (2 * np.pi * f))
    return span.middle + size * np.sin(phase), factor


def one(style, span, rng, rate_hz, seconds, k, count):
    """(name of the trajectory, protocol, speed, fine angle, factor) of motion k of a style."""
    top = span.fastest
    if style == "sweeps":
        speed = top * (0.05 if count > 1 else 0.3) ** (1 - k / max(1, count - 1))
        speed = max(speed, 4 * 2 * span.half / (seconds * 2.5))
        q, factor = triangle(span, speed, 4 if count > 3 else 6, rate_hz, rng.choice([0.0, 0.0, 0.3]))
        return f"s{k}", "uniform", speed, q, factor
    if style == "cosines":
        peak = span.half * 2 * np.pi
        f = np.sort(np.clip(top / peak * rng.uniform(0.1, 1.0, 3), 3 / seconds, None))
        return f"c{k}", "cosine", None, *cosines(span, f, rate_hz, rng.uniform(0.6, 1.0))
    if style == "multisine":
        period = rng.uniform(1.5, 6.0) if rng.random() < 0.5 else seconds
        harmonics = np.sort(rng.choice(np.arange(1, 8), rng.integers(2, 5), replace=False))
        return f"m{k}", "free", None, *multisine(span, period, max(1, round(seconds / period)), harmonics, rng, rate_hz, top)
    if style == "moves":
        return f"p{k}", "free", None, *moves(span, max(4, int(seconds / 2.0)), rng, rate_hz)
    if style == "steps":
        return f"q{k}", "free", None, *moves(span, max(6, int(seconds / 1.2)), rng, rate_hz, (0.02, 0.1))
    if style == "chirp":
        low = max(1.5 / seconds, 0.15 * top / (2 * np.pi * span.half))
        return f"h{k}", "free", None, *chirp(span, seconds, low, max(2 * low, top / (2 * np.pi * 0.35 * span.half)), rate_hz, top)
    return f"w{k}", "free", None, *wander(span, seconds, rng, rate_hz, rng.uniform(0.8, 3.0))


def record(span, rng):
    """The style of a campaign, its rate, its repeats, its trials."""
    style = str(rng.choice(STYLES, p=[0.2, 0.13, 0.17, 0.13, 0.1, 0.12, 0.07, 0.08]))
    rate = float(rng.choice([50, 100, 125, 200, 250, 500, 1000, 2000], p=[0.08, 0.17, 0.05, 0.2, 0.15, 0.15, 0.15, 0.05]))
    state = rng.bit_generator.state
    while True:  # a campaign that would be too long is recorded at half the rate
        rng.bit_generator.state = state
        found = record_at(style, rate, span, rng)
        if sum(len(t.t_s) for t in found[-1]) <= MOST_SAMPLES or rate < 60:
            return found
        rate = {125.0: 100.0}.get(rate, max(50.0, rate / 2))


def record_at(style, rate, span, rng):
    """Style, rate, repeats and the trials."""
    if style == "long":
        count, repeats, seconds = 1, 1, rng.uniform(60, 180)
    else:
        count = int(rng.integers(3, 9)) if style in ("sweeps", "cosines", "splines", "moves") else int(rng.integers(1, 5))
        repeats = int(rng.choice([1, 1, 2, 3, 4])) if style != "splines" else 1
        seconds = rng.uniform(8, 30)
        if count * repeats < 3:
            repeats = 1 if rng.random() < 0.3 else 4
    seconds = max(4.0, min(seconds, MOST_SAMPLES / rate / (count * repeats)))
    trials, at = [], 0.0
    for k in range(count):
        name, protocol, speed, q, factor = one(style, span, rng, rate, seconds, k, count)
        for r in range(repeats):
            again = q if r == 0 else varied(q, span, rng, factor[1])
            again = again[int(rng.integers(0, factor[0] + 1)):]
            angle, v, a = sampled(again, factor)
            trials.append(Trial(f"{name}_{r + 1}", protocol, name, r + 1, np.arange(len(angle)) / rate, angle, v, a, speed_rad_s=speed))
    for i in rng.permutation(len(trials)) if rng.random() < 0.3 else range(len(trials)):
        trials[i].start_s = at
        at += trials[i].t_s[-1] + rng.uniform(1, 30)
    return style, rate, repeats, trials


def varied(q, span, rng, fine_hz):
    """The same motion once more: a controller never follows twice alike."""
    slow = smooth(np.cumsum(rng.normal(size=len(q))), 1.0, fine_hz)
    slow -= np.linspace(slow[0], slow[-1], len(slow))
    size = 2e-3 * span.half * rng.random()
    return q + size * slow / max(1e-12, np.max(np.abs(slow)))
