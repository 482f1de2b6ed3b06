#!/usr/bin/env python3
"""What the base model of data/davinci_l4 leaves, by SciPy, for tests/evaluate.rs: both sides low-passed, in N m.

usage: scripts/reference/davinci.py      (needs numpy and scipy; run from the top of the project)

Friction jumps where the joint turns. The reading stands still there, for up to a tenth of a second: printed is what is left if the joint
turned as the reading came to rest, half way, as the reading jumped back, and where a joint that sets out with one acceleration from the
middle of a step did, by its first two jumps (half a step and a step and a half away, at times as 1 to sqrt(3)). The first half second is left out,
where the low-pass has not settled.
"""
import json
import pathlib

import numpy as np
from scipy.signal import butter, sosfiltfilt

RATE_HZ, LOWPASS_HZ, MOTION_HZ, SETTLED = 1000.0, 20.0, 80.0, 500
# From the start of the motion to the first jump, in times between the first two.
SETS_OUT = 1 / (np.sqrt(3) - 1)
data = pathlib.Path("data/davinci_l4")
model = json.loads((data / "base_model.json").read_text())
joint, up, down = model["joint"], model["friction"]["up"], model["friction"]["down"]
lowpass, motion = (butter(4, cutoff, fs=RATE_HZ, output="sos") for cutoff in (LOWPASS_HZ, MOTION_HZ))


def turns(position):
    """First and last sample at each extreme reading, and where the joint goes then; a step and a half back is a turn."""
    back = 1.5 * np.min(np.abs(np.diff(position))[np.diff(position) != 0])
    found, far, first, last, sign = [], position[0], 0, 0, 0.0
    for at, reading in enumerate(position):
        onward = (reading - far) * sign
        if onward > 0 or (sign == 0 and reading != far):
            sign, far, first, last = sign or np.sign(reading - far), reading, at, at
        elif reading == far:
            last = at
        elif -onward > back:
            sign = -sign
            found.append((first, last, sign))
            far, first, last = reading, at, at
    return found


def sets_out(position, first, last):
    jumps = np.flatnonzero(np.diff(position[last:]) != 0)[:2]
    return max(first, last - SETS_OUT * (jumps[1] - jumps[0]))


PLACES = {
    "as the reading came to rest": lambda position, first, last: first,
    "half way": lambda position, first, last: (first + last) / 2,
    "as the reading jumped back": lambda position, first, last: last,
    "with one acceleration": sets_out,
}
left = {}
for log in sorted(data.glob("run_*.csv")):
    _, position, torque, load = np.loadtxt(log, delimiter=",", skiprows=1).T
    velocity = np.gradient(sosfiltfilt(motion, position), 1 / RATE_HZ)
    friction_up, friction_down = (joint["winch_radius_m"] * (of["a_j"] + of["d"] * s * np.abs(velocity)) for of, s in ((up, 1), (down, -1)))
    rigid = joint["winch_radius_m"] / joint["pulley_radius_m"] * sosfiltfilt(motion, load)
    found = turns(position)
    for name, place in PLACES.items():
        up_there = np.full(len(position), float(found[0][2] < 0))
        for first, last, sign in found:
            up_there[round(place(position, first, last)) + 1 :] = float(sign > 0)
        predicted = rigid + friction_down + up_there * (friction_up - friction_down)
        residual = (sosfiltfilt(lowpass, -torque) - sosfiltfilt(lowpass, predicted))[SETTLED:]
        left.setdefault(name, []).append((np.sum(residual**2), len(residual)))
for name, parts in left.items():
    total, count = np.sum(parts, axis=0)
    print(f"turned {name}: {np.sqrt(total / count):.4e} N m")
