"""Motions: sweeps, cascades of cosines, sums of sines, moves with dwells; each repeat follows its command with small errors of its own.

A maker returns its command as a function of time and its length in seconds. Every command begins and ends at rest.
"""
import numpy as np
from scipy.interpolate import CubicSpline

from plant import Trial

KNOTS_HZ = 100.0  # commands are smooth over 0.1 s or more: a spline with this many knots holds them
MARGIN_S = 2.0
CREEP = 0.05  # of the top speed: slower than this at an end of the log is cut off where rest is not wanted


def command_of(rng, length_s, position):
    """A function of time from positions on the knots, its corners rounded by a Hann window of 0.15 to 0.45 s."""
    times = np.arange(-MARGIN_S, length_s + MARGIN_S, 1 / KNOTS_HZ)
    width = int(rng.uniform(0.15, 0.45) * KNOTS_HZ) | 1
    window = np.hanning(width + 2)[1:-1]
    padded = np.pad(position(times), width // 2, mode="edge")
    return CubicSpline(times, np.convolve(padded, window / window.sum(), mode="valid")), length_s


def polygon(rng, corners_t, corners_q):
    return command_of(rng, corners_t[-1] + 0.4, lambda t: np.interp(t, corners_t, corners_q))


def sweep(rng, duration_s, low, high, speed):
    """Back and forth at one speed, a whole number of legs, from either end."""
    leg_s = (high - low) / speed
    legs = max(2, int(duration_s / leg_s))
    ends = [low, high] if rng.random() < 0.7 else [high, low]
    rest_s = rng.uniform(0.4, 0.8)
    return polygon(rng, [rest_s + i * leg_s for i in range(legs + 1)], [ends[i % 2] for i in range(legs + 1)])


def moves(rng, duration_s, low, high, speed, dwell_s):
    """From place to place at about one speed, resting in between for `dwell_s` (least, most); no rest when it is (0, 0)."""
    t, q = [0.5], [rng.uniform(low, high)]
    while t[-1] < duration_s:
        target = rng.uniform(low, high)
        if abs(target - q[-1]) < 0.25 * (high - low):
            target = low if q[-1] > (low + high) / 2 else high
        t.append(t[-1] + abs(target - q[-1]) / (speed * rng.uniform(0.6, 1.0)))
        q.append(target)
        if dwell_s[1] > 0:
            t.append(t[-1] + rng.uniform(*dwell_s))
            q.append(target)
    return polygon(rng, t, q)


def multi_sine(rng, duration_s, low, high, top_hz):
    """Two to five sines up to `top_hz`, scaled to the range, growing from rest and dying away within a second or two."""
    count = rng.integers(2, 6)
    hz = np.exp(rng.uniform(np.log(max(1.2 / duration_s, 0.02)), np.log(top_hz), count))
    hz[0] = top_hz * rng.uniform(0.7, 1.0)
    size = rng.uniform(0.4, 1.0, count) * np.minimum(1.0, (0.3 * top_hz / hz) ** 0.7)
    phase = rng.uniform(0, 2 * np.pi, count)
    fade_s = rng.uniform(1.0, 2.0)

    def raw(t):
        edge = np.clip(np.minimum(t - 0.3, duration_s - 0.3 - t) / fade_s, 0, 1)
        fade = edge**3 * (10 - 15 * edge + 6 * edge**2)
        return fade * sum(s * np.sin(2 * np.pi * f * t + p) for s, f, p in zip(size, hz, phase))

    seen = raw(np.arange(0, duration_s, 0.01))
    scale = (high - low) / (seen.max() - seen.min())
    return command_of(rng, duration_s, lambda t: low + scale * (raw(t) - seen.min()))


def cascade(rng, duration_s, low, high, top_hz):
    """Whole periods of cosines, one after the other, ever faster."""
    periods = [duration_s / 2]
    while periods[-1] > 2 / top_hz:
        periods.append(periods[-1] * rng.choice([0.5, 0.5, 0.35]))
    edges = 0.5 + np.concatenate(([0], np.cumsum(periods)))
    first, last = (low, high) if rng.random() < 0.7 else (high, low)

    def position(t):
        inside = np.clip(t, edges[0], edges[-1] - 1e-9)
        i = np.searchsorted(edges, inside, side="right") - 1
        phase = (inside - edges[i]) / np.array(periods)[i]
        return first + (last - first) * (1 - np.cos(2 * np.pi * phase)) / 2

    return command_of(rng, edges[-1] + 0.4, position)


def warp(rng, times_s, wobble):
    """Time as the servo keeps it: it runs ahead and behind a little, so that the motion is never quite the command."""
    shifted = times_s.copy()
    for _ in range(4):
        hz = np.exp(rng.uniform(np.log(0.05), np.log(0.7)))
        phase = rng.uniform(0, 2 * np.pi)
        shifted += wobble * rng.uniform(0.2, 1.0) / 3 / (2 * np.pi * hz) * (np.sin(2 * np.pi * hz * times_s + phase) - np.sin(phase))
    return shifted


def derivatives(q, rate_hz):
    v = np.gradient(q) * rate_hz
    return q, v, np.gradient(v) * rate_hz


def record(rng, command, length_s, rate_hz, start_s, names, wobble, misplaced_rad, still, other_command=None):
    """One repeat of a command as a Trial; without `still` the log begins and ends in motion."""
    t = np.arange(int(length_s * rate_hz)) / rate_hz
    q, v, a = derivatives(command(np.clip(warp(rng, t, wobble), -MARGIN_S, length_s + 0.9 * MARGIN_S)) + rng.normal(0, misplaced_rad), rate_hz)
    other = None
    if other_command is not None:
        other = derivatives(other_command(warp(rng, t, wobble)), rate_hz)
    kept = slice(None)
    if not still:
        moving = np.flatnonzero(np.abs(v) > CREEP * np.abs(v).max())
        kept = slice(moving[0], moving[-1] + 1)
    t = t[kept] - t[kept][0]
    return Trial(*names, t, t + start_s, q[kept], v[kept], a[kept], None if other is None else tuple(x[kept] for x in other))
