#!/usr/bin/env python3
"""The case of the EMPS slide: a ball screw under its published model with symmetric friction, its last cycle held out.

usage: scripts/real/emps.py DATA_EMPS.mat OUTPUT

scripts/emps.py tells where the file comes from. The authors found friction of its own in each direction; scripts/emps_diagnose.py
leaves every cycle out in turn and compares with their errors.
"""
import importlib.util
import pathlib
import shutil
import tempfile

import numpy as np

from common import Joint, arguments, case, needed

spec = importlib.util.spec_from_file_location("emps_campaign", pathlib.Path(__file__).resolve().parents[1] / "emps.py")
benchmark = importlib.util.module_from_spec(spec)
spec.loader.exec_module(benchmark)


def main():
    mat, out = arguments(__doc__)
    scratch = pathlib.Path(tempfile.mkdtemp())
    try:
        cycles = benchmark.write(needed(mat), scratch / "cycles")
        tables = [("cycle_%d" % k, "reference", np.loadtxt(scratch / "cycles" / f"cycle_{k}.csv", delimiter=",", skiprows=1)) for k in range(1, cycles + 1)]
    finally:
        shutil.rmtree(scratch)
    joint = Joint("emps_slide", kind="prismatic", inertia=benchmark.MASS_KG, lowpass_hz=100.0)
    case(out / "emps_asymmetry", joint, benchmark.published_model(), tables[:-1], tables[-1:], {
        "device": "EMPS slide", "kind": "withheld", "done": "friction by direction withheld from the model", "accepted": ["viscous", "coulomb"],
        "why": "the authors' model with friction by direction fits their record better: 3.11 against 4.08 %",
        "source": "Janot, Gautier, Brunot, Data Set and Reference Models of EMPS", "licence": "terms do not allow bundling: read from a download"})


if __name__ == "__main__":
    main()
