#!/usr/bin/env python3
"""Captures from the software bus at 4 kHz in virtual time: every cycle must be a row of a log or counted as missed.

    scripts/ethercat/fast.py --binary target/release/tautline [--cycle-us 250] [--plan PLAN]
"""

import argparse
import json
import subprocess
import tempfile
import time
from pathlib import Path

from campaign import accounted

ROOT = Path(__file__).resolve().parents[2]
PLAN = """format = "plan/1"
rest_s = 0.5
[[motions]]
protocol = "uniform"
speeds = 4
slowest_rad_s = 0.1
fastest_rad_s = 0.4
"""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--binary", default=ROOT / "target/release/tautline", type=Path)
    parser.add_argument("--cycle-us", default=250, type=int)
    parser.add_argument("--plan", type=Path, help="another plan than four sweeps")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        rig = (ROOT / "data/rigs/demo/rig.toml").read_text()
        assert "cycle_us = 1000" in rig
        (folder / "rig.toml").write_text(rig.replace("cycle_us = 1000", f"cycle_us = {options.cycle_us}"))
        (folder / "plan.toml").write_text(PLAN)
        began = time.monotonic()
        command = [options.binary, "capture", "--rig", folder / "rig.toml", "--plan"]
        command += [options.plan or folder / "plan.toml", "-o", folder / "out"]
        done = subprocess.run([*command, "--json"], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        outcome = json.loads(done.stdout)
        samples, late, missed = accounted(folder / "out")
        print(
            f"{outcome['complete']} of {outcome['trials']} trials at {1e6 / options.cycle_us:.0f} Hz in {time.monotonic() - began:.0f} s: "
            f"{outcome['cycles']} cycles, {samples} recorded, {late} late, {missed} missed"
        )
        assert outcome["complete"] == outcome["trials"] and missed == 0 and late == 0


if __name__ == "__main__":
    main()
