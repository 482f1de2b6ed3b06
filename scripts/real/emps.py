#!/usr/bin/env python3
"""Cases of the EMPS slide, a ball screw: the published model with symmetric friction, and a spring put into the recording.

usage: scripts/real/emps.py DATA_EMPS.mat OUTPUT      (TAUTLINE names the binary)

scripts/emps.py tells where the file comes from; its terms do not allow bundling. The authors found friction of its own in each
direction; scripts/emps_diagnose.py leaves every cycle out in turn and compares with their errors. The spring is a force by the measured
position, added to cycles that a model of the first two cycles predicts.
"""
import importlib.util
import pathlib
import tempfile

import numpy as np

from common import Joint, arguments, case, case_with_residual, changed, explained, identified, needed, rms, with_torque

spec = importlib.util.spec_from_file_location("emps_campaign", pathlib.Path(__file__).resolve().parents[1] / "emps.py")
benchmark = importlib.util.module_from_spec(spec)
spec.loader.exec_module(benchmark)

LOWPASS_HZ = 100.0
STIFFNESS_N_M = 120.0
RIPPLE_N, RIPPLE_RAD_M = 1e-6, 1e4  # added to the spring before the regressions, whose spring would else leave nothing but rounding
TIED = 0.05  # a rival that leaves less than this share of the injected force cannot be told from a spring
SOURCE = {"device": "EMPS slide", "source": "Janot, Gautier, Brunot, Data Set and Reference Models of EMPS",
          "licence": "terms do not allow bundling: read from a download"}


def read(mat):
    """The record's cycles, each a recording of one and the same trajectory."""
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch) / "cycles"
        count = benchmark.write(needed(mat), folder)
        return [(f"cycle_{k}", "reference", np.loadtxt(folder / f"cycle_{k}.csv", delimiter=",", skiprows=1)) for k in range(1, count + 1)]


def asymmetry(joint, cycles, out):
    """Friction of its own in each direction withheld: the published symmetric model, the last cycle held out."""
    case(out / "emps_asymmetry", joint, benchmark.published_model(), cycles[:-1], cycles[-1:], SOURCE | {
        "kind": "withheld", "done": "friction by direction withheld from the model", "accepted": ["viscous", "coulomb"],
        "why": "the authors' model with friction by direction fits their record better: 3.11 against 4.08 %"})


def spring(joint, cycles, out):
    """A spring about mid-travel: two cycles with it shown, the two that the model was identified from held out, with it too."""
    reference, clean = cycles[:2], cycles[2:]
    position = reference[0][2][:, 1]
    centre_m = float((position.max() + position.min()) / 2)
    sprung = lambda table: with_torque(table, table[:, 2] + STIFFNESS_N_M * (table[:, 1] - centre_m))
    shown = changed(clean, sprung)
    q, force = np.vstack([table for _, _, table in shown]).T[1:]
    added = STIFFNESS_N_M * (q - centre_m)
    left = explained(added + RIPPLE_N * np.sin(RIPPLE_RAD_M * q), q, force)
    case_with_residual(out / "emps_injected_spring", joint, identified(joint, reference, "--estimate-backlash"), shown, changed(reference, sprung), SOURCE | {
        "kind": "injected", "done": f"a spring of {STIFFNESS_N_M} N/m about mid-travel", "accepted": ["elastic_spring"],
        "cannot_be_told_from": sorted(n for n, v in left.items() if n != "elastic_spring" and v < TIED * rms(added)),
        "why": "force by the measured position added",
        "figures": {"added_rms_n": rms(added), "stiffness_n_m": STIFFNESS_N_M, "centre_m": centre_m, "left_by_regression": left}}, before=clean)


def main():
    mat, out = arguments(__doc__)
    cycles = read(mat)
    joint = Joint("emps_slide", kind="prismatic", inertia=benchmark.MASS_KG, lowpass_hz=LOWPASS_HZ)
    asymmetry(joint, cycles, out)
    spring(joint, cycles, out)


if __name__ == "__main__":
    main()
