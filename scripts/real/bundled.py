#!/usr/bin/env python3
"""The case that needs no download: the bundled da Vinci tool drive under constant friction, two of its six runs held out.

usage: scripts/real/bundled.py OUTPUT

Its transition after reversals and its friction by load are withheld from the model (data/davinci_l4/README.md).
"""
import json
import pathlib
import sys

import numpy as np

from common import case
from mis_tool import SOURCE, joint

DATA = pathlib.Path(__file__).resolve().parents[2] / "data" / "davinci_l4"
SHOWN, UNSEEN = ("02", "21", "25", "43"), ("06", "47")


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    runs = lambda names: [(f"run_{n}", f"run_{n}", np.loadtxt(DATA / f"run_{n}.csv", delimiter=",", skiprows=1)) for n in names]
    folder, model = pathlib.Path(sys.argv[1]) / "bundled_davinci_l4", json.loads((DATA / "base_model.json").read_text())
    case(folder, joint("davinci_left_spindle"), model, runs(SHOWN), runs(UNSEEN), SOURCE | {
        "device": "da Vinci tool 4, left spindle", "kind": "withheld", "done": "transition and friction by load withheld from the model",
        "accepted": ["reversal_transition", "presliding", "load_dependent_friction"], "why": "constant friction by direction, identified on steady sliding",
        "figures": {"rmse_after_unseen_at_most_nm": 0.006}})


if __name__ == "__main__":
    main()
