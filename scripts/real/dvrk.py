#!/usr/bin/env python3
"""Cases from a da Vinci research kit arm (cable-driven): added masses seen at its yaw and pitch joints, drag and clipping put into the bare arm's.

usage: scripts/real/dvrk.py FOLDER_OF_DOWNLOAD OUTPUT      (TAUTLINE names the binary)

FOLDER_OF_DOWNLOAD is a clone of github.com/WPI-AIM/dvrk_dynamics_identification (no licence found: nothing of it is bundled). One and
the same optimised trajectory was followed without and with masses of 105 and 205 g, mounted in two ways, and once more over the same
strokes at half speed (the files named 0.5_scale), with masses only. What the first three joints ask of one another is found by
least squares on a reference recording, as functions of yaw, pitch and insertion; it goes into the campaign as `load_torque`, less
the term sin(q), which is `gravity_nm`; tautline identifies the friction. Such a load does not hold at another speed, so the reference of the
half-speed cases is the arm with 105 g at half speed. Faults are put into the bare arm's recording of another session.
200 samples a second, at half speed 100 (the ratio of speed to difference of position).
"""
from typing import NamedTuple

import numpy as np

from common import (Joint, arguments, cannot_be_told_from, case, case_with_residual, direction, explained, identified, low, needed, rms,
                    with_torque)

RATE_HZ, LOWPASS_HZ = 200.0, 4.0
HALF_SPEED_RATE_HZ = 100.0
STILL_RAD_S = 0.03
RIDGE = 1e-5
JOINTS = {"yaw": 0, "pitch": 1}
SHOWN = 2 / 3  # of the recording; the rest is held out
CASES = [("yaw", 205, "parallel"), ("yaw", 205, "insertion"), ("pitch", 205, "insertion"), ("pitch", 105, "insertion")]
RIGHT = ["gravity", "gravity_phase"]
DRAG_NM_S_RAD = 0.15
CLIPPED = 0.12  # share of the samples beyond each end of the reading
ARM = "dVRK patient-side manipulator"
SOURCE = {"source": "github.com/WPI-AIM/dvrk_dynamics_identification (Wang, Gondokaryono, Munawar, Fischer, RA-L 2019)",
          "licence": "none found: read from a download", "device": ARM}


class Record(NamedTuple):
    """Yaw, pitch and insertion over time: low-passed angles (rad, m) and speeds, accelerations, torques and angles as read."""

    q: np.ndarray
    v: np.ndarray
    a: np.ndarray
    torque: np.ndarray
    angle: np.ndarray
    rate_hz: float


def read(path, rate_hz=RATE_HZ):
    rows = np.genfromtxt(needed(path), delimiter=",")
    q, v = low(rows[:, 0:3], 2.5 * LOWPASS_HZ, rate_hz), low(rows[:, 7:10], 2.5 * LOWPASS_HZ, rate_hz)
    return Record(q, v, np.gradient(v, axis=0) * rate_hz, rows[:, 14:17], rows[:, 0:3], rate_hz)


def columns(record, j):
    """What a joint is asked for, then direction, speed, offset: weights and springs by angles, inertias by insertion, couplings."""
    q, v, a = record.q, record.v, record.a
    s, c, d, one = np.sin(q), np.cos(q), q[:, 2], np.ones(len(q))
    asked = [s[:, j], c[:, j], s[:, j] * d, c[:, j] * d, s[:, 0] * c[:, 1], s[:, 0] * c[:, 1] * d, c[:, 0] * s[:, 1], c[:, 0] * s[:, 1] * d,
             s[:, 0] * s[:, 1], q[:, 1 - j],
             a[:, j], a[:, j] * d, a[:, j] * d * d, a[:, j] * c[:, 1] ** 2, a[:, 1 - j], a[:, 2], v[:, 0] * v[:, 1] * s[:, 1] * c[:, 1],
             v[:, 0] ** 2 * s[:, 1] * c[:, 1], v[:, j] * v[:, 2], v[:, j] * v[:, 2] * d]
    return np.column_stack([*asked, direction(v[:, j], STILL_RAD_S), v[:, j], one])


def fit(record, j):
    x, y = low(columns(record, j), LOWPASS_HZ, record.rate_hz), low(record.torque[:, j], LOWPASS_HZ, record.rate_hz)
    scale = np.sqrt(np.mean(x**2, axis=0)) + 1e-9
    unit = x / scale
    return np.linalg.solve(unit.T @ unit + RIDGE * len(y) * np.eye(unit.shape[1]), unit.T @ y) / scale


class Reference(NamedTuple):
    """A joint as a reference recording has it: campaign, what it is asked for, the part of that which is sin(q), identified model."""

    joint: Joint
    parameters: np.ndarray
    gravity_nm: float
    model: dict


def reference(record, name, notes):
    j = JOINTS[name]
    parameters = fit(record, j)
    s = np.sin(record.q[:, j])
    centred = s - s.mean()
    gravity_nm = float(centred @ asked(record, j, parameters) / (centred @ centred))
    joint = Joint(f"psm_{name}", gravity_nm=gravity_nm, lowpass_hz=LOWPASS_HZ, loaded=True, notes=notes)
    model = identified(joint, [("bare", "bare", table(record, j, parameters, gravity_nm))])
    return Reference(joint, parameters, gravity_nm, model)


def asked(record, j, parameters):
    return columns(record, j)[:, :-3] @ parameters[:-3]


def table(record, j, parameters, gravity_nm):
    load = asked(record, j, parameters) - gravity_nm * np.sin(record.q[:, j])
    return np.column_stack([np.arange(len(record.q)) / record.rate_hz, record.angle[:, j], record.torque[:, j], load])


def parts(rows):
    """The part that is shown and the part held out, each a list of one recording."""
    cut = int(SHOWN * len(rows))
    return [("shown", "shown", rows[:cut])], [("unseen", "unseen", rows[cut:] - [rows[cut, 0], 0, 0, 0])]


def carrying(mass_g, record, name, known, done, why):
    """What makes a case of an added mass; figures: what the reference leaves of the recording, and what plain regressions leave of that."""
    j = JOINTS[name]
    torque = low(record.torque[:, j], LOWPASS_HZ, record.rate_hz)
    extra = low(record.torque[:, j] - columns(record, j) @ known.parameters, LOWPASS_HZ, record.rate_hz)
    left = explained(extra, record.q[:, j], torque)
    return known.joint, known.model, *parts(table(record, j, known.parameters, known.gravity_nm)), SOURCE | {
        "kind": "intervention", "done": done, "accepted": RIGHT, "cannot_be_told_from": cannot_be_told_from(left, RIGHT), "why": why,
        "figures": {"mass_g": mass_g, "gravity_nm": known.gravity_nm, "gap_rms_nm": rms(extra), "left_by_regression_nm": left}}


def added(data, bare, out):
    """Masses on the arm, whose model is of the bare arm."""
    models = {name: reference(bare, name, f"{ARM}; torque as the controller reports it.") for name in JOINTS}
    for name, grams, mount in CASES:
        record = read(data / f"one_results_1.0_scale_{grams}_grams_{mount}.csv")
        case(out / f"dvrk_{name}_{grams}g_{mount}", *carrying(
            grams, record, name, models[name], f"{grams} g mounted {mount}, seen at the {name} joint",
            "an added mass: torque by the joint's angle, and by the insertion (a remainder)"))


def exchanged(data, out):
    """A mass exchanged for a heavier one, both at half speed."""
    light, heavy = (read(data / f"one_results_0.5_scale_{grams}_grams_insertion.csv", HALF_SPEED_RATE_HZ) for grams in (105, 205))
    for name in JOINTS:
        case_with_residual(out / f"dvrk_half_{name}_100g", *carrying(
            100, heavy, name, reference(light, name, f"{ARM} with 105 g; half speed."),
            f"105 g exchanged for 205 g (insertion), half speed, seen at the {name} joint", "an added mass of 100 g"))


def session(bare, other, name):
    """The bare arm's model by one session, and its recording of another."""
    known = reference(bare, name, f"{ARM}.")
    return known, table(other, JOINTS[name], known.parameters, known.gravity_nm)


def drag(bare, other, out):
    known, rows = session(bare, other, "yaw")
    more = DRAG_NM_S_RAD * other.v[:, JOINTS["yaw"]]
    case_with_residual(out / "dvrk_injected_drag", known.joint, known.model, *parts(with_torque(rows, rows[:, 2] + more)), SOURCE | {
        "kind": "injected", "done": f"drag of {DRAG_NM_S_RAD} N m s/rad from the encoder's speed, yaw", "accepted": ["viscous"], "cannot_be_told_from": [],
        "why": "torque added by the measured speed to another session's recording of the bare arm",
        "figures": {"added_rms_nm": rms(more), "drag_nm_s_rad": DRAG_NM_S_RAD}}, before=parts(rows)[0])


def clip(bare, other, out):
    known, rows = session(bare, other, "pitch")
    low_nm, high_nm = np.quantile(rows[:, 2], [CLIPPED, 1 - CLIPPED])
    clipped = np.clip(rows[:, 2], low_nm, high_nm)
    case_with_residual(out / "dvrk_injected_clip", known.joint, known.model, *parts(with_torque(rows, clipped)), SOURCE | {
        "kind": "injected", "done": "torque clipped at both ends (12 % of the samples each), pitch", "accepted": ["saturation"], "cannot_be_told_from": [],
        "why": "limits of the reading", "figures": {"low_nm": low_nm, "high_nm": high_nm, "changed_rms_nm": rms(clipped - rows[:, 2])}},
        before=parts(rows)[0])


def main():
    download, out = arguments(__doc__)
    data = download / "data" / "psm_simplified" / "measured_trajectory"
    bare = read(data / "one_no_weight_results.csv")
    added(data, bare, out)
    exchanged(data, out)
    other = read(download / "data" / "psm" / "measured_trajectory" / "one_results.csv")
    drag(bare, other, out)
    clip(bare, other, out)


if __name__ == "__main__":
    main()
