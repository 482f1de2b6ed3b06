#!/usr/bin/env python3
"""Cases from a UR10e: a payload of known mass, seen at three joints while all six move; friction withheld and a ripple put in, joint 1 alone.

usage: scripts/real/ur10e.py FOLDER_OF_DOWNLOAD OUTPUT      (TAUTLINE names the binary)

FOLDER_OF_DOWNLOAD is a clone of github.com/shamilmamedov/dynamic_calibration (no licence found: nothing of it is bundled). Torque is
motor current times the authors' drive gain (UR10E_parameters.txt). The arm is a chain of six links whose masses are found by least
squares on recordings without payload, drawn to the nominal ones, for each of the three joints by itself; it goes into the campaign as a
URDF, and tautline identifies the friction. Joint 1 turns about a vertical axis and once moves alone: no weight, one inertia.
"""
import copy
from typing import NamedTuple

import numpy as np

from common import Joint, arguments, cannot_be_told_from, case, case_with_residual, direction, identified, left_by, low, rms, with_torque
from ur10e_arm import ELBOW, LOWPASS_HZ, NAMES, RATE_HZ, SHOULDER, STILL_RAD_S, WRIST, fit, flange, logged, missed, physical, read, torque, urdf

UNLOADED = ["ur-20_01_31-unload", "ur-20_02_05-20sec_8harm", "ur-20_02_12-50sec_12harm", "ur-20_02_19_14harm50sec"]
HELD_OUT = ["ur-20_02_12-40sec_12harm", "ur-20_02_06-20sec_5harm"]  # without payload, too: nothing is fitted to them
LOADED_KG, LOADED, LOADED_UNSEEN = 2.805, "ur-20_02_19_14harm50secLoad", "ur-20_01_31-load"
SHOULDER_CASES = [("2.805", LOADED_KG, LOADED, LOADED_UNSEEN), ("2.6", 2.6, "ur-20_01_13-load_2600", None)]
PAN_GAIN_NM_A, PAN_POSITION_HZ = 10.0, 8.0
PAN_REFERENCE_S, PAN_SHOWN_S = (0, 20), (20, 42)  # parts of the recording; what follows is held out
PAN_MOVING_RAD_S = 0.1
RIPPLE_NM, PLACES, SECOND = 4.0, 12, 0.3  # amplitude, periods a turn, second harmonic's share
SOURCE = {"source": "github.com/shamilmamedov/dynamic_calibration (Mamedov, Mikhel, Front. Robot. AI 2020)", "licence": "none found: read from a download"}


def recordings(data, names, seen):
    """Time, the joint's angle, its torque, the other joints' angles."""
    records = [read(data / f"{n}.csv") for n in names]
    tables = [np.column_stack([r.t, r.q[:, seen.at], torque(r, seen), np.delete(r.q, seen.at, axis=1)]) for r in records]
    return [(f"run_{i}", f"run_{i}", t) for i, t in enumerate(tables, 1)]


def unloaded(data, seen):
    """The arm without payload: joint, model, parameters, and what they leave of their recordings, N m RMS."""
    records = [read(data / f"{n}.csv") for n in UNLOADED]
    parameters = physical(fit(records, seen), seen.at)
    joint = Joint(NAMES[seen.at], lowpass_hz=LOWPASS_HZ, urdf=urdf(parameters, seen.at), others=[n for k, n in enumerate(NAMES) if k != seen.at],
                  notes=f"UR10e {seen.label}; torque is motor current times the drive gain.")
    left_nm = rms(np.concatenate([missed(r, parameters, seen) for r in records]))
    return joint, identified(joint, recordings(data, UNLOADED, seen)), parameters, left_nm


def payload(seen, kg, left, figures):
    """The answer of a payload's case: `left` by regressions with a cause's name."""
    return SOURCE | {"device": f"UR10e, {seen.label}", "kind": "intervention", "done": f"payload of {kg} kg", "accepted": ["gravity", "inertia"],
                     "cannot_be_told_from": cannot_be_told_from(left, ["gravity"]), "why": "a mass at the flange of a chain of six links",
                     "figures": figures}


def rivals(record, extra, seen):
    """What a gain of all that is read and a spring leave of the gap, N m RMS."""
    read_nm = low(torque(record, seen), LOWPASS_HZ, RATE_HZ)
    spring = [record.q[:, seen.at], np.ones_like(read_nm)]
    return {"sensor_gain": left_by(extra, [read_nm]), "elastic_spring": left_by(extra, spring)}


def by_one_column(column, gap):
    return float(column @ gap / (column @ column))


def at_shoulder(data, out):
    """The payload as a mass in the flange's origin. With its own centre it leaves less than a gain does: 4.2 against 4.5 N m, 4.7 against 5.8."""
    joint, model, parameters, unloaded_left_nm = unloaded(data, SHOULDER)
    for name, kg, shown, unseen in SHOULDER_CASES:
        record = read(data / f"{shown}.csv")
        extra = missed(record, parameters, SHOULDER)
        mass = flange(record, SHOULDER.at)[:, 0]
        left = {"gravity": left_by(extra, [mass])} | rivals(record, extra, SHOULDER)
        held_out = recordings(data, [unseen], SHOULDER) if unseen else []
        case(out / f"ur10e_payload_{name}", joint, model, recordings(data, [shown], SHOULDER), held_out, payload(SHOULDER, kg, left, {
            "mass_kg": kg, "mass_by_regression_kg": by_one_column(mass, extra), "gap_rms_nm": rms(extra), "left_by_regression_nm": left,
            "left_without_payload_nm": unloaded_left_nm}))


def near_flange(data, out, seen):
    """The same payload seen at a joint nearer to it: mass and first moments, as at the wrist the centre is most of the torque."""
    joint, model, parameters, unloaded_left_nm = unloaded(data, seen)
    record = read(data / f"{LOADED}.csv")
    extra, mass = missed(record, parameters, seen), flange(record, seen.at)
    centred = low(mass, LOWPASS_HZ, RATE_HZ)
    found = np.linalg.lstsq(centred, extra, rcond=None)[0]
    v = record.v[:, seen.at]
    left = {"gravity": left_by(extra, list(centred.T))} | rivals(record, extra, seen)
    left |= {"viscous": left_by(extra, [v]), "coulomb": left_by(extra, [direction(v, STILL_RAD_S), np.ones_like(v)])}
    shown, unseen = recordings(data, [LOADED], seen), recordings(data, [LOADED_UNSEEN], seen)
    case_with_residual(out / f"ur10e_{seen.label}_{LOADED_KG}", joint, model, shown, unseen, payload(seen, LOADED_KG, left, {
        "mass_kg": LOADED_KG, "mass_by_regression_kg": float(found[0]), "moment_by_regression_kg_m": found[1:].tolist(),
        "mass_at_flange_by_regression_kg": by_one_column(mass[:, 0], extra), "left_mass_at_flange_nm": left_by(extra, [mass[:, 0]]),
        "gap_rms_nm": rms(extra), "torque_rms_nm": rms(low(torque(record, seen), LOWPASS_HZ, RATE_HZ)), "left_by_regression_nm": left,
        "left_without_payload_nm": unloaded_left_nm,
        "left_other_unloaded_nm": {n: rms(missed(read(data / f"{n}.csv"), parameters, seen)) for n in HELD_OUT}}))


class Pan(NamedTuple):
    """Joint 1 alone: recording, low-passed torque and columns by `PAN_COLUMNS`, what least squares makes of them."""

    table: np.ndarray
    v: np.ndarray
    low_torque: np.ndarray
    columns: np.ndarray
    parameters: np.ndarray


PAN_COLUMNS = ("inertia", "viscous", "coulomb", "offset", "sin", "cos")


def pan(download):
    t, q, _, current = logged(download / "dataset_ur10e" / "jointwise_motion" / "ur-20_01_22-joint_1.csv")
    q, torque_nm = q[:, 0], PAN_GAIN_NM_A * current[:, 0]
    smooth = low(q, PAN_POSITION_HZ, RATE_HZ)
    v = np.gradient(smooth) * RATE_HZ
    a = np.gradient(v) * RATE_HZ
    x = low(np.column_stack([a, v, direction(v, STILL_RAD_S), np.ones_like(v), np.sin(smooth), np.cos(smooth)]), LOWPASS_HZ, RATE_HZ)
    y = low(torque_nm, LOWPASS_HZ, RATE_HZ)
    return Pan(np.column_stack([t, q, torque_nm]), v, y, x, np.linalg.lstsq(x, y, rcond=None)[0])


def pan_joint(alone, notes):
    return Joint("shoulder_pan", inertia=float(alone.parameters[0]), lowpass_hz=LOWPASS_HZ, notes=notes)


def samples(bounds_s):
    return slice(*(int(s * RATE_HZ) for s in bounds_s))


def pan_parts(table):
    """Reference, shown and held-out part, each a list of one recording that begins at 0 s."""
    for bounds_s in (PAN_REFERENCE_S, PAN_SHOWN_S, (PAN_SHOWN_S[1], table[-1, 0])):
        part = table[samples(bounds_s)]
        yield [("part_0", "part_0", np.column_stack([part[:, 0] - part[0, 0], part[:, 1:]]))]


def without_speed(alone, full):
    """The model with one constant level a direction, the mean of what the reference part asks for beside its inertia; no intervals."""
    model = copy.deepcopy(full)
    model.pop("confidence", None)
    part = samples(PAN_REFERENCE_S)
    v, friction = alone.v[part], (alone.low_torque - alone.parameters[0] * alone.columns[:, 0])[part]
    for sign, side in ((1, "up"), (-1, "down")):
        moving = (np.abs(v) > PAN_MOVING_RAD_S) & (np.sign(v) == sign)
        model["friction"][side] |= {"mu_c": 0.0, "b_c": 0.0, "b_j": 0.0, "d": 0.0, "a_j": float(friction[moving].mean())}
    return model


def left_beside_levels(alone):
    """RMS in N m that each cause leaves of the shown part beside inertia and a constant level a direction."""
    part = samples(PAN_SHOWN_S)
    a, v, way = alone.columns[part, :3].T
    gap = (alone.low_torque - alone.columns @ (alone.parameters * [1, 0, 0, 0, 0, 0]))[part]
    forms = {"viscous": [v], "quadratic_viscous": [v * np.abs(v)], "stribeck": [way * np.exp(-np.abs(v) / PAN_MOVING_RAD_S)],
             "coulomb": [], "inertia": [a], "presliding": [way]}
    return {cause: left_by(gap, [(way > 0) * 1.0, (way < 0) * 1.0, *form]) for cause, form in forms.items()}


def pan_viscous(alone, out):
    joint = pan_joint(alone, "UR10e joint 1 alone, vertical axis; torque is current times the authors' drive gain 10.0.")
    reference, shown, unseen = pan_parts(alone.table)
    full, left = identified(joint, reference), left_beside_levels(alone)
    case_with_residual(out / "ur10e_pan_viscous", joint, without_speed(alone, full), shown, unseen, SOURCE | {
        "device": "UR10e, shoulder pan alone", "kind": "withheld", "done": "friction that grows with speed withheld: one constant level each direction",
        "accepted": ["viscous"], "cannot_be_told_from": cannot_be_told_from(left, ["viscous"]),
        "why": "the authors' own identification has 21.3 N m s/rad and 12.5 N m at this joint",
        "figures": {"by_regression": dict(zip(PAN_COLUMNS, alone.parameters.tolist())), "left_nm": rms(alone.low_torque - alone.columns @ alone.parameters),
                    "left_by_regression_nm": left, "identified_d": [full["friction"][side]["d"] for side in ("up", "down")]}})


def pan_ripple(alone, out):
    joint = pan_joint(alone, "UR10e joint 1 alone.")
    t, q, torque_nm = alone.table.T
    ripple = RIPPLE_NM * (np.sin(PLACES * q + 0.7) + SECOND * np.sin(2 * PLACES * q - 0.4))
    reference, before, _ = pan_parts(alone.table)
    _, shown, unseen = pan_parts(with_torque(alone.table, torque_nm + ripple))
    case_with_residual(out / "ur10e_pan_injected_ripple", joint, identified(joint, reference), shown, unseen, SOURCE | {
        "device": "UR10e, shoulder pan alone", "kind": "injected", "done": "torque ripple, 12 a turn with its second harmonic (30 %), 4 N m",
        "accepted": ["torque_ripple"], "cannot_be_told_from": [], "why": "torque by the measured position added, whatever the direction",
        "figures": {"added_rms_nm": rms(ripple), "places": PLACES}}, before=before)


def main():
    download, out = arguments(__doc__)
    data = download / "dataset_ur10e" / "identification_data"
    at_shoulder(data, out)
    near_flange(data, out, ELBOW)
    near_flange(data, out, WRIST)
    alone = pan(download)
    pan_viscous(alone, out)
    pan_ripple(alone, out)


if __name__ == "__main__":
    main()
