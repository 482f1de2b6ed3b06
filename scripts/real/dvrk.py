#!/usr/bin/env python3
"""Cases from a da Vinci research kit arm (cable-driven) that carries added masses: torque at its yaw and pitch joints.

usage: scripts/real/dvrk.py FOLDER_OF_DOWNLOAD OUTPUT      (TAUTLINE names the binary)

FOLDER_OF_DOWNLOAD is a clone of github.com/WPI-AIM/dvrk_dynamics_identification (no licence found: nothing of it is bundled). One and
the same optimised trajectory was followed without and with masses of 105 and 205 g, mounted in two ways (also at
half amplitude: not used, as a load found on one trajectory does not hold on another).
200 samples a second (the ratio of speed to difference of position). What the first three joints ask of one another
is found by least squares on the recording without mass, as functions of yaw, pitch and insertion; it goes into the
campaign as `load_torque`, less the term sin(q), which is `gravity_nm`; tautline identifies the friction.
"""
import numpy as np

from common import Joint, arguments, cannot_be_told_from, case, direction, explained, identified, low, needed

RATE_HZ, LOWPASS_HZ = 200.0, 4.0
STILL_RAD_S = 0.03
RIDGE = 1e-5
JOINTS = {"yaw": 0, "pitch": 1}
SHOWN = 2 / 3  # of the recording; the rest is held out
CASES = [("yaw", 205, "parallel"), ("yaw", 205, "insertion"), ("pitch", 205, "insertion"), ("pitch", 105, "insertion")]
SOURCE = {"source": "github.com/WPI-AIM/dvrk_dynamics_identification (Wang, Gondokaryono, Munawar, Fischer, RA-L 2019)", "licence": "none found: read from a download"}


def read(path):
    """Angles, speeds, accelerations and torques of yaw, pitch, insertion."""
    rows = np.genfromtxt(needed(path), delimiter=",")
    q, v = low(rows[:, 0:3], 2.5 * LOWPASS_HZ, RATE_HZ), low(rows[:, 7:10], 2.5 * LOWPASS_HZ, RATE_HZ)
    return q, v, np.gradient(v, axis=0) * RATE_HZ, rows[:, 14:17], rows[:, 0:3]


def columns(record, j):
    """What a joint is asked for, then direction, speed, offset: weights and springs by angles, inertias by insertion, couplings."""
    q, v, a, _, _ = record
    s, c, d, one = np.sin(q), np.cos(q), q[:, 2], np.ones(len(q))
    asked = [s[:, j], c[:, j], s[:, j] * d, c[:, j] * d, s[:, 0] * c[:, 1], s[:, 0] * c[:, 1] * d, c[:, 0] * s[:, 1], c[:, 0] * s[:, 1] * d, s[:, 0] * s[:, 1], q[:, 1 - j],
             a[:, j], a[:, j] * d, a[:, j] * d * d, a[:, j] * c[:, 1] ** 2, a[:, 1 - j], a[:, 2], v[:, 0] * v[:, 1] * s[:, 1] * c[:, 1],
             v[:, 0] ** 2 * s[:, 1] * c[:, 1], v[:, j] * v[:, 2], v[:, j] * v[:, 2] * d]
    return np.column_stack([*asked, direction(v[:, j], STILL_RAD_S), v[:, j], one])


def fit(record, j):
    x, y = low(columns(record, j), LOWPASS_HZ, RATE_HZ), low(record[3][:, j], LOWPASS_HZ, RATE_HZ)
    scale = np.sqrt(np.mean(x**2, axis=0)) + 1e-9
    unit = x / scale
    return np.linalg.solve(unit.T @ unit + RIDGE * len(y) * np.eye(unit.shape[1]), unit.T @ y) / scale


def table(record, j, parameters, gravity):
    asked = columns(record, j)[:, :-3] @ parameters[:-3]
    q = record[4][:, j]
    return np.column_stack([np.arange(len(q)) / RATE_HZ, q, record[3][:, j], asked - gravity * np.sin(record[0][:, j])])


def main():
    download, out = arguments(__doc__)
    data = download / "data" / "psm_simplified" / "measured_trajectory"
    bare = read(data / "one_no_weight_results.csv")
    models = {}
    for name, j in JOINTS.items():
        parameters = fit(bare, j)
        asked = columns(bare, j)[:, :-3] @ parameters[:-3]
        s = np.sin(bare[0][:, j])
        centred = s - s.mean()
        gravity = float(centred @ asked / (centred @ centred))
        joint = Joint(f"psm_{name}", gravity_nm=gravity, lowpass_hz=LOWPASS_HZ, loaded=True, notes="dVRK patient-side manipulator; torque as the controller reports it.")
        models[name] = joint, parameters, gravity, identified(joint, [("bare", "bare", table(bare, j, parameters, gravity))])
    for name, grams, mount in CASES:
        j, (joint, parameters, gravity, model) = JOINTS[name], models[name]
        full = read(data / f"one_results_1.0_scale_{grams}_grams_{mount}.csv")
        extra = low(full[3][:, j] - columns(full, j) @ parameters, LOWPASS_HZ, RATE_HZ)
        left = explained(extra, full[0][:, j], low(full[3][:, j], LOWPASS_HZ, RATE_HZ))
        right = ["gravity", "gravity_phase"]
        rows = table(full, j, parameters, gravity)
        cut = int(SHOWN * len(rows))
        case(out / f"dvrk_{name}_{grams}g_{mount}", joint, model, [("shown", "shown", rows[:cut])],
             [("unseen", "unseen", rows[cut:] - [rows[cut, 0], 0, 0, 0])], SOURCE | {
                 "device": "dVRK patient-side manipulator", "kind": "intervention", "done": f"{grams} g mounted {mount}, seen at the {name} joint",
                 "accepted": right, "cannot_be_told_from": cannot_be_told_from(left, right),
                 "why": "an added mass: torque by the joint's angle, and by the insertion (a remainder)",
                 "figures": {"mass_g": grams, "gravity_nm": gravity, "gap_rms_nm": float(np.sqrt(np.mean(extra**2))), "left_by_regression_nm": left}})


if __name__ == "__main__":
    main()
