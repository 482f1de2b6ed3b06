#!/usr/bin/env python3
"""Cases from the da Vinci tool drives of MRDLab/mis-tool-characterization: another tool, transition withheld, faults injected.

usage: scripts/real/mis_tool.py FOLDER_OF_DOWNLOAD OUTPUT      (TAUTLINE names the binary)

FOLDER_OF_DOWNLOAD is a clone of github.com/MRDLab/mis-tool-characterization (data ODbL 1.0, contents DbCL 1.0). A motor turns the left
spindle of a Maryland grasper by sines of +-30 deg; a second one resists at the jaw; both torques are measured. The model is
what `tautline identify` makes of other runs.
"""
import json
import pathlib

import numpy as np

from common import Joint, arguments, case, identified, low, needed

COUNT_RAD, COUNT_NM = 2 * np.pi / 8192, 3.9811e-5  # upstream README
RATE_HZ, EVERY = 1000, 2
LOWPASS_HZ = 20.0
SOURCE = {"source": "github.com/MRDLab/mis-tool-characterization (O'Neill, Stephens, Kowalewski, RA-L 2018)", "licence": "ODbL 1.0, contents DbCL 1.0"}
TRANSMISSION = 1.279  # spindle to jaw, as in data/davinci_l4


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
    smooth = lambda x: low(x, 0.4 * RATE_HZ / EVERY, RATE_HZ)[keep]
    q = q[keep] - middle
    return np.column_stack([np.arange(len(q)) * EVERY / RATE_HZ, q, smooth(torque), smooth(jaw)])


def joint(name, notes=""):
    return Joint(name, winch_m=0.01 * TRANSMISSION, pulley_m=0.01, sign=-1, lowpass_hz=LOWPASS_HZ, loaded=True, notes=notes)


def runs(folder, names):
    return [(f"run_{n}", f"run_{n}", read(folder / f"{n}.TXT")) for n in names]


def groups(reference, changed):
    """How much of the change of spindle torque is gain of the jaw's torque, offset by direction (Coulomb), speed; N m RMS, and factors.

    A regression by direction on steady sliding (0.35 rad past a turn) on both sets of recordings: no model of tautline in it.
    """
    def fit(recordings):
        found = {}
        for sign in (1, -1):
            rows = []
            for _, _, table in recordings:
                t, q, y, jaw = table.T
                v = np.gradient(low(q, LOWPASS_HZ, RATE_HZ / EVERY)) * RATE_HZ / EVERY
                moving = (np.sign(v) == sign) & (np.abs(v) > 0.3 * np.abs(v).max()) & (sign * q > -0.52 + 0.35)
                rows.append(np.column_stack([low(jaw, 5, RATE_HZ / EVERY), np.ones(len(t)), np.abs(v), low(y, 5, RATE_HZ / EVERY)])[moving][::20])
            rows = np.vstack(rows)
            found[sign] = np.linalg.lstsq(rows[:, :3], rows[:, 3], rcond=None)[0], rows[:, 0].mean(), rows[:, 2].mean()
        return found

    a, b = fit(reference), fit(changed)
    gain = [(b[s][0][0] - a[s][0][0]) * b[s][1] for s in (1, -1)]
    level = [b[s][0][1] - a[s][0][1] for s in (1, -1)]
    speed = [(b[s][0][2] - a[s][0][2]) * b[s][2] for s in (1, -1)]
    half = lambda f: (f[1][0][1] - f[-1][0][1]) / 2
    rms = lambda x: float(np.sqrt(np.mean(np.square(x))))
    shift, opening = np.mean(level), (level[0] - level[1]) / 2
    parts = {"load_gain_nm": rms(gain), "shift_nm": abs(float(shift)), "opening_nm": abs(float(opening)), "viscous_nm": rms(speed)}
    return parts | {"half_loop_before_nm": abs(half(a)), "half_loop_after_nm": abs(half(b))}


NAMES = {"load_gain_nm": ["load_coefficient", "load_dependent_friction", "sensor_gain"],
         "shift_nm": ["coulomb", "sensor_bias"], "opening_nm": ["coulomb"],
         "viscous_nm": ["viscous", "quadratic_viscous"]}


def named(figures):
    """The causes whose part of the change is at least half of the largest part."""
    parts = {k: figures[k] for k in NAMES}
    return sorted({n for k, v in parts.items() if v >= 0.5 * max(parts.values()) for n in NAMES[k]})


def longer(download, out):
    """The runs of data/davinci_l4 with four further ones held out."""
    here = pathlib.Path(__file__).resolve().parents[2] / "data" / "davinci_l4"
    folder = download / "data" / "Tool_4_Maryland_L_4"
    j = joint("davinci_left_spindle")
    case(out / "mis_tool_l4", j, json.loads((here / "base_model.json").read_text()), runs(folder, ["02", "06", "21", "25", "43", "47"]), runs(folder, ["04", "13", "34", "41"]), SOURCE | {
        "device": "da Vinci tool 4, left spindle", "kind": "withheld", "done": "transition and friction by load withheld from the model",
        "accepted": ["reversal_transition", "presliding", "load_dependent_friction"], "why": "constant friction by direction, identified on steady sliding"})


def other_tool(download, out):
    """A model of tool 4, given recordings of tool 5."""
    data = download / "data"
    four = runs(data / "Tool_4_Maryland_L_4", ["02", "06", "21", "25", "43", "47"])
    five = runs(data / "Tool_5_Maryland_L_3", ["02", "06", "21", "25", "43", "47"])
    unseen = runs(data / "Tool_5_Maryland_L_3", ["04", "13", "34", "41"])
    j = joint("davinci_tool_4")
    figures = groups(four, five)
    case(out / "mis_tool_other_tool", j, identified(j, four, "--estimate-backlash"), five, unseen, SOURCE | {
        "device": "da Vinci tools 4 and 5, left spindles", "kind": "intervention", "done": "tool 4's model, tool 5's recordings",
        "accepted": named(figures), "figures": figures,
        "why": "two specimens of one mechanism differ in their friction; the sensor's zero was not removed"})


def withheld(download, out):
    """The transition after reversals withheld: a jump between two levels, identified otherwise in full."""
    folder = download / "data" / "Tool_5_Maryland_L_3"
    reference, shown = runs(folder, ["01", "15", "29", "33", "47"]), runs(folder, ["02", "06", "21", "25", "43"])
    j = joint("davinci_tool_5")
    case(out / "mis_tool_transition", j, identified(j, reference, "--combination", "sign"), shown, runs(folder, ["04", "13", "34", "41"]), SOURCE | {
        "device": "da Vinci tool 5, left spindle", "kind": "withheld", "done": "transition after reversals withheld from the model",
        "accepted": ["reversal_transition", "presliding"], "why": "cables pass from one branch to the other over some travel, not in a jump"})


def injected(download, out):
    """A fault of the sensor put into recordings that the model predicts well: truth that is certain."""
    folder = download / "data" / "Tool_5_Maryland_L_3"
    reference, shown, unseen = (runs(folder, names) for names in (["01", "15", "29", "33", "47"], ["02", "06", "21", "25", "43"], ["04", "13", "34", "41"]))
    j = joint("davinci_tool_5")
    model = identified(j, reference, "--estimate-backlash")

    def late(table):
        t, y = table[:, 0], table[:, 2]
        return np.column_stack([table[:, :2], np.interp(t - 0.025, t, y), table[:, 3]])

    def louder(table):
        return table * [1, 1, 1.3, 1]

    range_nm = np.quantile(np.concatenate([table[:, 2] for _, _, table in shown]), 0.85)

    def cut(table):
        return np.column_stack([table[:, :2], np.minimum(table[:, 2], range_nm), table[:, 3]])

    def touched(table):
        t = table[:, 0]
        push = sum(0.05 * np.exp(-0.5 * ((t - s * t[-1]) / 0.12) ** 2) for s in (0.23, 0.61))
        return np.column_stack([table[:, :2], table[:, 2] + push, table[:, 3]])

    for name, change, causes, told in (
        ("delay", late, ["time_delay"], "torque read 25 ms late"), ("gain", louder, ["sensor_gain", "load_coefficient"], "torque read 1.3 times too large"),
        ("clip", cut, ["saturation"], "torque clipped at one end"), ("pushes", touched, ["contact"], "two pushes of 50 mN m in each recording")):
        faulty = lambda recordings: [(n, m, change(t)) for n, m, t in recordings]
        case(out / f"mis_tool_injected_{name}", j, model, faulty(shown), faulty(unseen), SOURCE | {
            "device": "da Vinci tool 5, left spindle", "kind": "injected", "done": told, "accepted": causes,
            "figures": {"delay_s": 0.025} if name == "delay" else {}})


def main():
    download, out = arguments(__doc__)
    needed(download / "data" / "Tool_5_Maryland_L_3")
    withheld(download, out)
    injected(download, out)
    longer(download, out)
    other_tool(download, out)


if __name__ == "__main__":
    main()
