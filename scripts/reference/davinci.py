#!/usr/bin/env python3
"""What the base model of data/davinci_l4 leaves, by SciPy, for tests/evaluate.rs: both sides low-passed, in N m.

usage: scripts/reference/davinci.py      (needs numpy and scipy; run from the top of the project)

Friction jumps with the sign of the speed. At rest (up to 9 % of a run) the sign is rounding's: printed are what is left with friction
on the branch that it was on, half way between the branches, and on the branch of the rounding. The first half second is left out,
where the low-pass has not settled.
"""
import json
import pathlib

import numpy as np
from scipy.signal import butter, sosfiltfilt

RATE_HZ, LOWPASS_HZ, MOTION_HZ, AT_REST_RAD_S, SETTLED = 1000.0, 20.0, 80.0, 1e-9, 500
data = pathlib.Path("data/davinci_l4")
model = json.loads((data / "base_model.json").read_text())
joint, up, down = model["joint"], model["friction"]["up"], model["friction"]["down"]
lowpass, motion = (butter(4, cutoff, fs=RATE_HZ, output="sos") for cutoff in (LOWPASS_HZ, MOTION_HZ))
left = {}
for log in sorted(data.glob("run_*.csv")):
    _, position, torque, load = np.loadtxt(log, delimiter=",", skiprows=1).T
    velocity = np.gradient(sosfiltfilt(motion, position), 1 / RATE_HZ)
    moves = np.abs(velocity) >= AT_REST_RAD_S
    last = np.maximum.accumulate(np.where(moves, np.arange(len(moves)), 0))
    sign = (velocity > 0).astype(float)
    friction_up, friction_down = (joint["winch_radius_m"] * (of["a_j"] + of["d"] * s * np.abs(velocity)) for of, s in ((up, 1), (down, -1)))
    rigid = joint["winch_radius_m"] / joint["pulley_radius_m"] * sosfiltfilt(motion, load)
    for name, k in {"stays": sign[last], "half way": np.where(moves, sign, 0.5), "rounding's": (velocity >= 0).astype(float)}.items():
        predicted = rigid + friction_down + k * (friction_up - friction_down)
        residual = (sosfiltfilt(lowpass, -torque) - sosfiltfilt(lowpass, predicted))[SETTLED:]
        left.setdefault(name, []).append((np.sum(residual**2), len(residual)))
for name, parts in left.items():
    total, count = np.sum(parts, axis=0)
    print(f"at rest {name}: {np.sqrt(total / count):.4e} N m")
