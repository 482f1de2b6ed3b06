#!/usr/bin/env python3
"""What the base model of data/davinci_l4 leaves, by SciPy, for tests/evaluate.rs: both sides low-passed, in N m.

usage: scripts/reference/davinci.py      (needs numpy and scipy; run from the top of the project)

The position is taken between the encoder's jumps, as smooth as its readings allow. Friction jumps where the sign of the speed changes, if the
joint then comes back by half a step of the encoder. The first half second is left out, where the low-pass has not settled.
"""
import json
import pathlib

import numpy as np
from scipy.signal import butter, sosfiltfilt

RATE_HZ, LOWPASS_HZ, MOTION_HZ, SETTLED = 1000.0, 20.0, 80.0, 500


def between_jumps(read):
    """Position half way between two counts where the encoder jumps by one, the readings where it jumps by more, straight lines between; where it
    jumps back, the parabola through four jumps, and the reading itself where that would have reached the next count."""
    change = np.diff(read)
    step = np.min(np.abs(change[change != 0]))
    single = np.flatnonzero((change != 0) & (np.abs(change) < 1.5 * step))
    several = np.flatnonzero(np.abs(change) >= 1.5 * step)
    at = np.concatenate([single + 0.5, several, several + 1.0])
    known = np.concatenate([(read[single] + read[single + 1]) / 2, read[several], read[several + 1]])
    at, order = np.unique(at, return_index=True)
    known = known[order]
    between = np.interp(np.arange(len(read)), at, known)
    for k in np.flatnonzero(np.diff(known) == 0):
        rows = np.arange(int(np.ceil(at[k])), int(np.ceil(at[k + 1])))
        if not 0 < k < len(at) - 2:
            between[rows] = read[rows]
            continue
        heights = known[k] - known[[k - 1, k + 2]]
        if heights[0] * heights[1] <= 0 or np.any(np.abs(np.abs(heights) / step - 1) > 0.2):
            continue
        inner, outer = at[k + 1] - at[k], at[k + 2] - at[k - 1]
        share, u = inner**2 / (outer**2 - inner**2), (rows - at[k]) / inner
        between[rows] = between[rows] + heights[0] * share * 4 * u * (1 - u) if share < 1 else read[rows]
    return between


def smoothed(read, between, step):
    """The position `between` the jumps after the narrowest low-pass at which at most 1 in 100 readings would be more than 0.6 steps off, and that
    moves at most 2 in 1000 by as much."""
    passed = lambda halvings: sosfiltfilt(butter(4, MOTION_HZ / 2 ** (halvings / 2), fs=RATE_HZ, output="sos"), between)
    apart = lambda a, b: np.mean(np.abs(a - b) > 0.6 * step)
    smooth = widest = passed(0)
    for halvings in range(1, 17):
        narrower = passed(halvings)
        if apart(read, narrower) > 0.01 or apart(widest, narrower) > 0.002:
            break
        smooth = narrower
    return smooth


def upwards(between, velocity, step):
    """Whether the joint moves up at each sample."""
    first = np.flatnonzero(np.abs(between - between[0]) > step / 2)[0]
    up, extreme, moving = bool(between[first] > between[0]), between[0], np.empty(len(between), bool)
    for i, x in enumerate(between):
        back = (extreme - x) * (1 if up else -1)
        if back > step / 2:
            up, extreme, start = not up, x, i
            while start > 0 and moving[start - 1] != up and (velocity[start - 1] > 0) == up:
                start -= 1
            moving[start:i] = up
        elif back < 0:
            extreme = x
        moving[i] = up
    return moving


data = pathlib.Path("data/davinci_l4")
model = json.loads((data / "base_model.json").read_text())
joint, up, down = model["joint"], model["friction"]["up"], model["friction"]["down"]
lowpass, motion = (butter(4, cutoff, fs=RATE_HZ, output="sos") for cutoff in (LOWPASS_HZ, MOTION_HZ))
total, samples = 0.0, 0
for log in sorted(data.glob("run_*.csv")):
    _, position, torque, load = np.loadtxt(log, delimiter=",", skiprows=1).T
    change = np.abs(np.diff(position))
    step = np.min(change[change > 0])
    step = np.mean(change[(change > 0) & (change < 1.2 * step)])
    between = between_jumps(position)
    velocity = np.gradient(smoothed(position, between, step), 1 / RATE_HZ)
    friction_up, friction_down = (joint["winch_radius_m"] * (of["a_j"] + of["d"] * s * np.abs(velocity)) for of, s in ((up, 1), (down, -1)))
    rigid = joint["winch_radius_m"] / joint["pulley_radius_m"] * sosfiltfilt(motion, load)
    predicted = rigid + np.where(upwards(between, velocity, step), friction_up, friction_down)
    residual = (sosfiltfilt(lowpass, -torque) - sosfiltfilt(lowpass, predicted))[SETTLED:]
    total, samples = total + np.sum(residual**2), samples + len(residual)
    print(f"{log.name}: {np.sqrt(np.mean(residual**2)):.4e} N m")
print(f"all: {np.sqrt(total / samples):.4e} N m")
