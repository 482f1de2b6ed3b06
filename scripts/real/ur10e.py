#!/usr/bin/env python3
"""Cases from a UR10e with a payload of known mass: the shoulder's torque from its motor current, all six joints moving.

usage: scripts/real/ur10e.py FOLDER_OF_DOWNLOAD OUTPUT      (TAUTLINE names the binary)

FOLDER_OF_DOWNLOAD is a clone of github.com/shamilmamedov/dynamic_calibration (no licence found: nothing of it is bundled). Torque is
current times the authors' drive gain (UR10E_parameters.txt). The arm is a chain of six links whose parameters are found by
least squares on recordings without payload; their torque at the shoulder, less the term that follows the shoulder's own
angle as sin(q), goes into the campaign as `load_torque`, that term is `gravity_nm`, and tautline identifies the friction.
"""
import numpy as np

from chain import regressor
from common import Joint, arguments, cannot_be_told_from, case, direction, explained, identified, low, needed

HALF = np.pi / 2
JOINTS = [((0, 0, 0.181), (0, 0, 0), (0, 0, 1)), ((0, 0.176, 0), (0, HALF, 0), (0, 1, 0)), ((0, -0.137, 0.613), (0, 0, 0), (0, 1, 0)),
          ((0, 0, 0.571), (0, HALF, 0), (0, 1, 0)), ((0, 0.135, 0), (0, 0, 0), (0, 0, 1)), ((0, 0, 0.12), (0, 0, 0), (0, 1, 0))]  # the download's URDF
SHOULDER = 1
GAIN_NM_A = 10.6956  # drive gain of joint 2, the authors'
RATE_HZ, LOWPASS_HZ = 100.0, 4.0
STILL_RAD_S = 0.02
RIDGE = 1e-4
UNLOADED = ["ur-20_01_31-unload", "ur-20_02_05-20sec_8harm", "ur-20_02_12-50sec_12harm", "ur-20_02_19_14harm50sec"]
CASES = [("2.805", 2.805, "ur-20_02_19_14harm50secLoad", "ur-20_01_31-load"), ("2.6", 2.6, "ur-20_01_13-load_2600", None)]
SOURCE = {"source": "github.com/shamilmamedov/dynamic_calibration (Mamedov, Mikhel, Front. Robot. AI 2020)", "licence": "none found: read from a download"}


def read(path):
    """Time, angles, speeds, accelerations of six joints, current of the shoulder, at an even rate, low-passed."""
    rows = np.genfromtxt(needed(path), delimiter=",")
    t = rows[:, 0] - rows[0, 0]
    keep = np.concatenate([[True], np.diff(t) > 1e-4])
    even = np.arange(0, t[-1], 1 / RATE_HZ)
    resampled = np.column_stack([np.interp(even, t[keep], rows[keep, k]) for k in [*range(1, 7), *range(7, 13), 13 + SHOULDER]])
    q, v = low(resampled[:, :6], 2.5 * LOWPASS_HZ, RATE_HZ), low(resampled[:, 6:12], 2.5 * LOWPASS_HZ, RATE_HZ)
    return even, q, v, np.gradient(v, axis=0) * RATE_HZ, GAIN_NM_A * resampled[:, 12]


def columns(record):
    t, q, v, a, y = record
    speed = v[:, SHOULDER]
    friction = np.column_stack([direction(speed, STILL_RAD_S), speed, np.ones_like(t), a[:, SHOULDER]])
    return np.column_stack([regressor(JOINTS, q, v, a, SHOULDER), friction])


def fit(records):
    """Parameters of the links and the friction, by ridge regression on low-passed columns."""
    x = np.vstack([low(columns(r), LOWPASS_HZ, RATE_HZ) for r in records])
    y = np.concatenate([low(r[4], LOWPASS_HZ, RATE_HZ) for r in records])
    scale = np.sqrt(np.mean(x**2, axis=0)) + 1e-9
    unit = x / scale
    return np.linalg.solve(unit.T @ unit + RIDGE * len(y) * np.eye(unit.shape[1]), unit.T @ y) / scale


def table(record, parameters, gravity_nm):
    """Time, angle from upright, torque, load."""
    t, q, v, a, y = record
    x = columns(record)
    rigid = x[:, :-4] @ parameters[:-4] + x[:, -1] * parameters[-1]
    upright = q[:, SHOULDER] + HALF
    return np.column_stack([t, upright, y, rigid - gravity_nm * np.sin(upright)])


def main():
    download, out = arguments(__doc__)
    data = download / "dataset_ur10e" / "identification_data"
    unloaded = [read(data / f"{n}.csv") for n in UNLOADED]
    parameters = fit(unloaded)
    rigid = np.concatenate([columns(r)[:, :-4] @ parameters[:-4] for r in unloaded])
    upright = np.concatenate([r[1][:, SHOULDER] + HALF for r in unloaded])
    gravity = float(np.sin(upright) @ rigid / (np.sin(upright) @ np.sin(upright)))
    joint = Joint("ur10e_shoulder", gravity_nm=gravity, lowpass_hz=LOWPASS_HZ, loaded=True, notes="UR10e shoulder lift; torque is motor current times the drive gain.")
    recordings = lambda records: [(f"run_{i}", f"run_{i}", table(r, parameters, gravity)) for i, r in enumerate(records, 1)]
    model = identified(joint, recordings(unloaded))
    for name, kg, shown, unseen in CASES:
        record = read(data / f"{shown}.csv")
        t, q, v, a, y = record
        extra = low(y - columns(record) @ parameters, LOWPASS_HZ, RATE_HZ)
        lever = lambda r: regressor(JOINTS, r[1], np.zeros_like(r[2]), np.zeros_like(r[3]), SHOULDER)[:, -10]
        own = np.sin(q[:, SHOULDER] + HALF)
        change = float(own @ extra / (own @ own))
        at_wrist = lever(record)
        kilograms = float(at_wrist @ extra / (at_wrist @ at_wrist))
        left = explained(extra, q[:, SHOULDER] + HALF, low(y, LOWPASS_HZ, RATE_HZ))
        right = ["gravity", "gravity_phase"]
        case(out / f"ur10e_payload_{name}", joint, model, recordings([record]), recordings([read(data / f"{unseen}.csv")]) if unseen else [], SOURCE | {
            "device": "UR10e, shoulder lift", "kind": "intervention", "done": f"payload of {kg} kg", "accepted": right, "cannot_be_told_from": cannot_be_told_from(left, right),
            "why": "a mass at the wrist: torque by the shoulder's angle, and by those of the joints beyond it (a remainder)",
            "figures": {"mass_kg": kg, "mass_by_regression_kg": kilograms, "gravity_change_by_regression_nm": change,
                        "gravity_nm": gravity, "gap_rms_nm": float(np.std(extra)), "left_by_regression_nm": left}})


if __name__ == "__main__":
    main()
