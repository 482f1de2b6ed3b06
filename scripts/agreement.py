#!/usr/bin/env python3
"""Whether tautline and SciPy find the same A and B(v) on one campaign: A within 0.2 %, B within 1e-3 N m. Both take
the zero of the position as declared: the formula is (17) as printed.

usage: scripts/agreement.py CAMPAIGN [--binary target/release/tautline]      (CSV campaign; needs numpy, scipy, polars)
"""
import argparse
import csv
import json
import subprocess
import sys
import tempfile

A_TOLERANCE = 2e-3
B_TOLERANCE_NM = 1e-3


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("campaign")
    arguments.add_argument("--binary", default="target/release/tautline")
    a = arguments.parse_args()
    theirs = json.loads(subprocess.run([sys.executable, "scripts/rival.py", a.campaign], check=True, capture_output=True).stdout)
    with tempfile.TemporaryDirectory() as scratch:
        subprocess.run([a.binary, "identify", a.campaign, "-o", f"{scratch}/o", "--zero", "declared", "--quiet"], check=True)
        model = json.load(open(f"{scratch}/o/model.json"))
        legs = list(csv.DictReader(open(f"{scratch}/o/trials.csv")))
    worst_a = worst_b = 0.0
    for direction, other in theirs.items():
        worst_a = max(worst_a, abs(model["fit"][direction]["a_nm"] / other["a_nm"] - 1))
        for speed, b in zip(other["speed_rad_s"], other["b_nm"]):
            ours = [float(r["b_nm"]) for r in legs if r["direction"] == direction and float(r["speed_rad_s"]) == speed]
            worst_b = max(worst_b, abs(sum(ours) / len(ours) - b))
    print(f"A differs by at most {100 * worst_a:.4f} %, B by at most {1e3 * worst_b:.4f} mN m")
    if worst_a > A_TOLERANCE or worst_b > B_TOLERANCE_NM:
        sys.exit("too far apart")


if __name__ == "__main__":
    main()
