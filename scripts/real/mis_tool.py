#!/usr/bin/env python3
"""Cases from the da Vinci tool drives of MRDLab/mis-tool-characterization: another tool, rolled shaft, effects withheld, faults injected.

usage: scripts/real/mis_tool.py FOLDER_OF_DOWNLOAD OUTPUT      (TAUTLINE names the binary)

FOLDER_OF_DOWNLOAD is a clone of github.com/MRDLab/mis-tool-characterization (data ODbL 1.0, contents DbCL 1.0). A motor turns one
spindle of a Maryland grasper by sines of +-30 deg; a second one resists at the jaw; both torques are measured. The model is
what `tautline identify` makes of other runs. Tool and spindle are those in the folders' names: the files' own headers, which the
upstream README calls unreliable, disagree for some.
"""
import copy
import json
import pathlib

import numpy as np
from scipy.signal import lsim

from common import Joint, arguments, cannot_be_told_from, case, case_with_residual, changed, identified, low, needed, predicted, rms, with_torque
from sliding import KEPT_HZ, LOWPASS_HZ, SIDES, THINNED, groups, left_on_sliding, named, slope_by_load, steady

COUNT_RAD, COUNT_NM = 2 * np.pi / 8192, 3.9811e-5  # upstream README
RATE_HZ = 1000
EVERY = int(RATE_HZ / KEPT_HZ)
SOURCE = {"source": "github.com/MRDLab/mis-tool-characterization (O'Neill, Stephens, Kowalewski, RA-L 2018)", "licence": "ODbL 1.0, contents DbCL 1.0"}
TRANSMISSION = 1.279  # spindle to jaw, as in data/davinci_l4
RADIUS_M = 0.01
LATE_S = 0.025
FILTER_DAMPING, FILTER_DELAY_S = 0.7, 0.030
DRIFT_NM, DRIFT_SHARE = 0.015, 0.6  # where the zero settles; its time constant by the recording's length
HARDER, AT_RAD_S = 0.3, 0.5  # what is added to friction, as a share of its level at this speed


def read(path):
    """Time, spindle angle, spindle torque, jaw torque; from the first crossing of mid-stroke after 0.75 s."""
    rows = []
    for line in needed(path).read_text().splitlines():
        fields = line.split(",")
        if not line.startswith("%") and len(fields) == 10:
            rows.append([float(fields[k]) for k in (1, 2, 5)])
    q, torque, jaw = (np.array(rows) * [COUNT_RAD, COUNT_NM, COUNT_NM]).T
    middle = (q.max() + q.min()) / 2
    start = 750 + int(np.argmax(np.diff(np.sign(q[750:] - middle)) != 0))
    keep = slice(start, None, EVERY)
    smooth = lambda x: low(x, 0.4 * KEPT_HZ, RATE_HZ)[keep]
    q = q[keep] - middle
    return np.column_stack([np.arange(len(q)) * EVERY / RATE_HZ, q, smooth(torque), smooth(jaw)])


def joint(name, transmission=TRANSMISSION):
    return Joint(name, winch_m=RADIUS_M * transmission, pulley_m=RADIUS_M, sign=-1, lowpass_hz=LOWPASS_HZ, loaded=True)


def runs(folder, names):
    return [(f"run_{n}", f"run_{n}", read(folder / f"{n}.TXT")) for n in names.split()]


def longer(data, out):
    """The runs of data/davinci_l4 with four further ones held out."""
    here = pathlib.Path(__file__).resolve().parents[2] / "data" / "davinci_l4"
    folder = data / "Tool_4_Maryland_L_4"
    model = json.loads((here / "base_model.json").read_text())
    case(out / "mis_tool_l4", joint("davinci_left_spindle"), model, runs(folder, "02 06 21 25 43 47"), runs(folder, "04 13 34 41"), SOURCE | {
        "device": "da Vinci tool 4, left spindle", "kind": "withheld", "done": "transition and friction by load withheld from the model",
        "accepted": ["reversal_transition", "presliding", "load_dependent_friction"], "why": "constant friction by direction, identified on steady sliding"})


def other_tool(data, out):
    """A model of tool 4, given recordings of tool 5."""
    four = runs(data / "Tool_4_Maryland_L_4", "02 06 21 25 43 47")
    five = runs(data / "Tool_5_Maryland_L_3", "02 06 21 25 43 47")
    unseen = runs(data / "Tool_5_Maryland_L_3", "04 13 34 41")
    j = joint("davinci_tool_4")
    figures = groups(four, five)
    case(out / "mis_tool_other_tool", j, identified(j, four, "--estimate-backlash"), five, unseen, SOURCE | {
        "device": "da Vinci tools 4 and 5, left spindles", "kind": "intervention", "done": "tool 4's model, tool 5's recordings",
        "accepted": named(figures), "figures": figures,
        "why": "two specimens of one mechanism differ in their friction; the sensor's zero was not removed"})


def roll(data, out):
    """A model of the shaft as it is, given recordings with the shaft rolled by a quarter of a turn; by the folders' notes."""
    straight, rolled = data / "Tool_4_Maryland_L_Roll_3", data / "Tool_4_Maryland_L_Roll_1"
    reference, shown = runs(straight, "000 002 101 103 200 202 301 303"), runs(rolled, "000 002 103 201 203 301")
    j = joint("davinci_tool_4")
    figures = groups(reference, shown)
    case_with_residual(out / "mis_tool_roll_-90", j, identified(j, reference, "--estimate-backlash"), shown, runs(rolled, "001 102 300 303"), SOURCE | {
        "device": "da Vinci tool 4, left spindle", "kind": "intervention", "done": "shaft rolled by -90 deg: model of roll 0",
        "accepted": named(figures), "figures": figures,
        "why": "the roll twists the cables in the shaft: regression on steady sliding says which part of the torque changed"})


TRANSITION = {"kind": "withheld", "done": "transition after reversals withheld from the model", "accepted": ["reversal_transition", "presliding"],
              "why": "cables pass from one branch to the other over some travel, not in a jump"}


JUMPS = [  # case, folder, joint, device; runs of the reference, shown, held out
    ("mis_tool_transition", "Tool_5_Maryland_L_3", "davinci_tool_5", "da Vinci tool 5, left spindle", "01 15 29 33 47", "02 06 21 25 43", "04 13 34 41"),
    ("mis_tool_right_transition", "Tool_4_Maryland_R_5", "davinci_tool_4_right", "da Vinci tool 4, right spindle", "00 12 21 33 42", "02 10 23 31 43",
     "03 11 22 40")]


def withheld(data, out):
    """The transition after reversals withheld: a jump between two levels, identified otherwise in full."""
    for name, folder, of, device, reference, shown, unseen in JUMPS:
        recorded, j = data / folder, joint(of)
        model = identified(j, runs(recorded, reference), "--combination", "sign")
        case_with_residual(out / name, j, model, runs(recorded, shown), runs(recorded, unseen), SOURCE | TRANSITION | {"device": device})


def load_withheld(data, out):
    """Friction by load withheld, the transition kept: torque follows the load with one and the same slope both ways."""
    folder = data / "Tool_5_Maryland_L_2"
    reference, shown = runs(folder, "00 12 21 33 42 03"), runs(folder, "02 10 23 31 43")
    slopes = {sign: slope_by_load(reference, sign) for sign in SIDES}
    j = joint("davinci_tool_5", transmission=float(abs(slopes[1] + slopes[-1]) / 2))
    full = identified(j, reference, "--estimate-backlash")
    model = without_load(j, full, reference)
    left = left_on_sliding(j, model, shown)
    rivals = {cause: nm for cause, nm in left.items() if cause != "none"}
    case_with_residual(out / "mis_tool_5_load", j, model, shown, runs(folder, "01 13 22 40"), SOURCE | {
        "device": "da Vinci tool 5, left spindle (second mounting)", "kind": "withheld",
        "done": "friction by load withheld: mu_c = 0, the level refitted on steady sliding; transition kept",
        "accepted": ["load_dependent_friction", "load_coefficient"], "cannot_be_told_from": cannot_be_told_from(rivals, ["load_dependent_friction"]),
        "why": "slopes of spindle torque by jaw torque differ by direction",
        "figures": {"slope_up": slopes[1], "slope_down": slopes[-1], "mu_identified": [full["friction"][side]["mu_c"] for side in SIDES.values()],
                    "left_by_regression_nm": left}})


def without_load(j, full, reference):
    """The model without friction by load, its constant level refitted; the intervals of what was set by hand go."""
    model = copy.deepcopy(full)
    for side in SIDES.values():
        model["friction"][side]["mu_c"] = 0.0
    for _ in range(3):  # the level also moves the transition, so once is not enough
        columns = predicted(j, model, reference)
        for sign, side in SIDES.items():
            residuals = [columns[name]["residual_nm"][steady(table)[1][sign]][::THINNED] for name, _, table in reference]
            model["friction"][side]["a_j"] += float(np.nanmean(np.concatenate(residuals))) / j.winch_m
    model["confidence"] = {k: v for k, v in model.get("confidence", {}).items() if not k.endswith(("mu_c", "a_j"))}
    return model


def late(table):
    return with_torque(table, np.interp(table[:, 0] - LATE_S, table[:, 0], table[:, 2]))


def touched(table):
    t = table[:, 0]
    return with_torque(table, table[:, 2] + sum(0.05 * np.exp(-0.5 * ((t - s * t[-1]) / 0.12) ** 2) for s in (0.23, 0.61)))


def injected(data, out):
    """A fault of the sensor put into recordings that the model predicts well: truth that is certain."""
    folder = data / "Tool_5_Maryland_L_3"
    shown, unseen = runs(folder, "02 06 21 25 43"), runs(folder, "04 13 34 41")
    j = joint("davinci_tool_5")
    model = identified(j, runs(folder, "01 15 29 33 47"), "--estimate-backlash")
    range_nm = np.quantile(np.concatenate([table[:, 2] for _, _, table in shown]), 0.85)
    cut = lambda table: with_torque(table, np.minimum(table[:, 2], range_nm))
    louder = lambda table: with_torque(table, 1.3 * table[:, 2])
    for name, change, causes, told in (
        ("delay", late, ["time_delay"], "torque read 25 ms late"), ("gain", louder, ["sensor_gain", "load_coefficient"], "torque read 1.3 times too large"),
        ("clip", cut, ["saturation"], "torque clipped at one end"), ("pushes", touched, ["contact"], "two pushes of 50 mN m in each recording")):
        case(out / f"mis_tool_injected_{name}", j, model, changed(shown, change), changed(unseen, change), SOURCE | {
            "device": "da Vinci tool 5, left spindle", "kind": "injected", "done": told, "accepted": causes,
            "figures": {"delay_s": LATE_S} if name == "delay" else {}})


def filtered(table):
    """Torque through a low-pass of second order with unit gain, whose delay at low frequency is `FILTER_DELAY_S`."""
    t, y = table[:, 0], table[:, 2]
    w = 2 * FILTER_DAMPING / FILTER_DELAY_S
    _, out, _ = lsim(([w * w], [1, 2 * FILTER_DAMPING * w, w * w]), y - y[0], t)
    return with_torque(table, out + y[0])


def injected_lag(data, out):
    """A filter before the reading: no pure delay."""
    folder = data / "Tool_4_Maryland_L_4"
    reference, shown, unseen = runs(folder, "01 15 29 33 47"), runs(folder, "03 12 24 36 45"), runs(folder, "05 18 27 42")
    j = joint("davinci_tool_4")
    model, lagging = identified(j, reference, "--estimate-backlash"), changed(shown, filtered)
    case_with_residual(out / "mis_tool_4_injected_lag", j, model, lagging, changed(unseen, filtered), SOURCE | {
        "device": "da Vinci tool 4, left spindle", "kind": "injected", "done": "torque through a filter of second order (damping 0.7), 30 ms late",
        "accepted": ["time_delay"], "cannot_be_told_from": [], "why": "a sensor's anti-alias filter",
        "figures": {"delay_s": FILTER_DELAY_S, "changed_rms_nm": torque_change(shown, lagging)}}, before=shown)


def torque_change(before, after):
    return rms(np.concatenate([b[:, 2] - a[:, 2] for (_, _, a), (_, _, b) in zip(before, after)]))


def warm(table):
    t = table[:, 0]
    return with_torque(table, table[:, 2] + DRIFT_NM * (1 - np.exp(-t / (DRIFT_SHARE * t[-1]))))


def tightened(j, model, recordings):
    """Recordings with more Coulomb friction moving up, by the difference of two predictions: it follows the model's transition."""
    up = model["friction"]["up"]
    level = up["a_j"] + up["b_c"] * np.exp(-up["c_c"] * j.pulley_m * AT_RAD_S) + up["b_j"] * np.exp(-up["c_j"] * AT_RAD_S) + up["d"] * AT_RAD_S
    harder = copy.deepcopy(model)
    harder["friction"]["up"]["a_j"] += HARDER * float(level)
    a, b = predicted(j, model, recordings), predicted(j, harder, recordings)
    added = lambda name: j.sign * np.nan_to_num(b[name]["predicted_nm"] - a[name]["predicted_nm"])
    return [(name, trajectory, with_torque(table, table[:, 2] + added(name))) for name, trajectory, table in recordings]


def injected_drift_and_friction(data, out):
    """A zero that drifts, and friction of one direction; the models of the runs without either are one and the same."""
    folder = data / "Tool_5_Maryland_L_3"
    shown, unseen = runs(folder, "03 11 22 37 45"), runs(folder, "05 18 30 41")
    j = joint("davinci_tool_5")
    model = identified(j, runs(folder, "00 16 25 34 48"), "--estimate-backlash")
    case_with_residual(out / "mis_tool_5_injected_drift", j, model, changed(shown, warm), changed(unseen, warm), SOURCE | {
        "device": "da Vinci tool 5, left spindle", "kind": "injected", "accepted": ["sensor_drift"], "cannot_be_told_from": [],
        "done": "offset drifts in each recording by 15 (1 - exp(-t/T)) mN m, T = 0.6 of its length", "why": "a sensor's zero that settles with temperature",
        "figures": {"drift_end_nm": DRIFT_NM * (1 - np.exp(-1 / DRIFT_SHARE))}}, before=shown)
    rubbing = tightened(j, model, shown)
    case_with_residual(out / "mis_tool_5_injected_friction", j, model, rubbing, tightened(j, model, unseen), SOURCE | {
        "device": "da Vinci tool 5, left spindle", "kind": "injected", "accepted": ["coulomb"], "cannot_be_told_from": [],
        "done": "Coulomb friction 30 % higher in the up direction, through the model's formula with its transition", "why": "a cable of one side tightened",
        "figures": {"added_rms_nm": torque_change(shown, rubbing), "up_before": model["friction"]["up"]}}, before=shown)


def main():
    download, out = arguments(__doc__)
    data = needed(download / "data")
    for cases in (withheld, injected, longer, other_tool, load_withheld, roll, injected_lag, injected_drift_and_friction):
        cases(data, out)


if __name__ == "__main__":
    main()
