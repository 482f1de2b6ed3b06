#!/usr/bin/env python3
"""Cases from a motor on a dynamometer: a rotor mounted on its bare shaft, and a second motor coupled to it that damps instead of idling.

usage: scripts/real/dynamometer.py FOLDER_OF_DOWNLOAD OUTPUT      (TAUTLINE names the binary)

FOLDER_OF_DOWNLOAD is a clone of github.com/karthikurs/actuator-dynamometer (no licence found: nothing of it is bundled). The drive reports
angle and torque (q-axis current times the torque constant of its calibration); what was mounted and what the load did is in the files'
headers. The rotor: a random current, first with shaft hardware only, then with an RI50 rotor and its back. The damping load: both gears 1:1,
stairs of current while the second motor damps, against stairs of speed while it idles. Where the motors swap parts, only the
stretches in which the first one drives are taken, with up to 1.4 s of its coming to rest after them.
Angle and torque are referred to the output of an imaginary lossless reduction of 50:1, as no joint turns by 300 rad.
"""
import numpy as np

from common import Joint, arguments, cannot_be_told_from, case_with_residual, direction, identified, left_by, low, needed, rms

GEAR = 50.0
RATE_HZ, LOWPASS_HZ = 200.0, 8.0
STILL_RAD_S = 1.0 / GEAR
FIRST_S, LAST_S = 0.5, 0.2  # left out at the ends where a whole file is taken
COLUMNS = ("time [s]", "a1 position [rad]", "a1 torque [Nm]")
BARE, ROTOR, ROTOR_UNSEEN = "06_05_2021_14-11-02", "06_05_2021_14-28-13", "06_05_2021_14-29-55"
IDLING = {"27_04_2021_17-33-08": [(4, 40)], "27_04_2021_17-39-20": [(4, 40)], "27_04_2021_17-46-20": [(39.5, 56), (56, 72)]}  # s
DAMPED = "27_04_2021_16-28-22"
DAMPED_S, DAMPED_UNSEEN_S = [(0.5, 7.4), (13.0, 18.8), (26.0, 30.0), (38.0, 42.3)], [(50.5, 54.8), (61.0, 67.0)]
SOURCE = {"source": "github.com/karthikurs/actuator-dynamometer", "licence": "none found: read from a download", "device": "actuator dynamometer",
          "kind": "intervention"}


def read(data, name):
    """Time, angle and torque of the first motor as recorded."""
    lines = needed(data / f"futek_test_{name}.csv").read_text(errors="replace").splitlines()
    head = next(k for k, line in enumerate(lines) if line.startswith(COLUMNS[0]))  # comments come before it
    names = lines[head].split(",")
    at = [names.index(c) for c in COLUMNS]
    rows = [line.split(",") for line in lines[head + 1 :]]
    return np.array([[float(row[k]) for k in at] for row in rows]).T


def stretches(data, name, bounds_s=None):
    """Tables of the stretches of a recording, each from 0 s and its own first angle, at an even rate."""
    t, angle, torque = read(data, name)
    tables = []
    for begin_s, end_s in bounds_s or [(t[0] + FIRST_S, t[-1] - LAST_S)]:
        even = np.arange(begin_s, end_s, 1 / RATE_HZ)
        q = np.interp(even, t, angle)
        tables.append(np.column_stack([even - begin_s, (q - q[0]) / GEAR, np.interp(even, t, torque) * GEAR]))
    return tables


def recordings(name, tables):
    return [(f"{name}_{i}", f"{name}_{i}", table) for i, table in enumerate(tables)]


TERMS = ("inertia", "viscous", "coulomb", "sensor_bias")


def regression(tables):
    """Acceleration, speed, direction and offset as columns by `TERMS`; low-passed torque; what least squares makes of them."""
    x, y = [], []
    for _, angle, torque in (table.T for table in tables):
        v = np.gradient(low(angle, LOWPASS_HZ, RATE_HZ)) * RATE_HZ
        x.append(np.column_stack([np.gradient(v) * RATE_HZ, v, direction(v, STILL_RAD_S), np.ones_like(v)]))
        y.append(low(torque, LOWPASS_HZ, RATE_HZ))
    x, y = np.vstack(x), np.concatenate(y)
    return x, y, np.linalg.lstsq(x, y, rcond=None)[0]


def left_by_terms(x, y, expected):
    """RMS in N m that each cause leaves of the gap, a gain of all that was expected among them."""
    gap = y - expected
    return {"inertia": left_by(gap, [x[:, 0]]), "viscous": left_by(gap, [x[:, 1]]), "coulomb": left_by(gap, [x[:, 2], x[:, 3]]),
            "sensor_gain": left_by(y, [expected])}


def rotor(data, out):
    """Inertia and drag of a rotor on the shaft. The regression says which terms changed by half as much as the most changed one."""
    reference, shown = stretches(data, BARE), stretches(data, ROTOR)
    before, (x, y, after) = regression(reference)[2], regression(shown)
    change_nm = {term: rms((after - before)[k] * x[:, k]) for k, term in enumerate(TERMS)}
    gap = y - x @ before
    left = left_by_terms(x, y, x @ before) | {"inertia+viscous": left_by(gap, [x[:, 0], x[:, 1]])}
    joint = Joint("actuator_1", inertia=float(before[0]), lowpass_hz=LOWPASS_HZ, notes="actuator 1 drives by current; torque is q-axis current times kt.")
    model = identified(joint, recordings("ref", reference))
    case_with_residual(out / "dyn_rotor", joint, model, recordings("run", shown), recordings("run", stretches(data, ROTOR_UNSEEN)), SOURCE | {
        "done": "rotor of an RI50 motor mounted on the shaft: model of the shaft alone",
        "accepted": sorted(n for n, nm in change_nm.items() if nm >= 0.5 * max(change_nm.values())),
        "cannot_be_told_from": cannot_be_told_from({n: left[n] for n in ("inertia+viscous", "coulomb", "sensor_gain")}, ["inertia+viscous"]),
        "why": "a rotor brings inertia and its drag; regression says which part of the torque changed",
        "figures": {"before": before.tolist(), "after": after.tolist(), "change_nm": change_nm, "gap_rms_nm": rms(gap), "left_by_regression_nm": left}})


def damping(data, out):
    """A load in proportion to speed. Both motors turn in all recordings; their inertia is that of the damped ones: stairs of speed hold few accelerations."""
    reference = [table for name, bounds_s in IDLING.items() for table in stretches(data, name, bounds_s)]
    shown, unseen = stretches(data, DAMPED, DAMPED_S), stretches(data, DAMPED, DAMPED_UNSEEN_S)
    before, (x, y, after) = regression(reference)[2], regression(shown)
    expected = x @ [after[0], *before[1:]]
    gap = y - expected
    left = left_by_terms(x, y, expected) | {"quadratic_viscous": left_by(gap, [x[:, 1] * np.abs(x[:, 1])])}
    joint = Joint("actuator_1", inertia=float(after[0]), lowpass_hz=LOWPASS_HZ, notes="actuator 1 drives; torque is q-axis current times kt.")
    model = identified(joint, recordings("ref", reference), "--combination", "sign")
    case_with_residual(out / "dyn_damping", joint, model, recordings("run", shown), recordings("run", unseen), SOURCE | {
        "done": "the second actuator damps (scale 1.0): model with it idle", "accepted": ["viscous"],
        "cannot_be_told_from": cannot_be_told_from(left, ["viscous"]), "why": "load mode: damping; torque of the load in proportion to speed",
        "figures": {"before": before.tolist(), "after": after.tolist(), "gap_rms_nm": rms(gap), "left_by_regression_nm": left}})


def main():
    download, out = arguments(__doc__)
    data = needed(download / "futek_data")
    rotor(data, out)
    damping(data, out)


if __name__ == "__main__":
    main()
