#!/usr/bin/env python3
"""The fault matrix: every fault of the software bus, and pairs of the worst, played to a capture in virtual time.

For each: the time until torque is off, the largest true speed and way of the simulated joint until then, the cause and the last words.
Exit status 1 if more than `--known` cases exceed the limits by more than one braking ramp, or end silent. data/rigs/README.md names
the cases that do.

    scripts/ethercat/fault_matrix.py [--binary target/release/tautline] [--only csv] [--known 0] [-o matrix.json]
"""

import argparse
import json
import subprocess
import sys
import time


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--binary", default="target/release/tautline")
    parser.add_argument("--only", default="", help="only cases whose name contains this")
    parser.add_argument("--known", type=int, default=0, help="cases that may exceed the limits")
    parser.add_argument("-o", "--output", help="write the matrix as JSON")
    arguments = parser.parse_args()
    began = time.monotonic()
    done = subprocess.run(
        [arguments.binary, "rig", "faults", "--only", arguments.only, "--json"], capture_output=True, text=True, check=False
    )
    if done.returncode not in (0, 1):
        sys.exit(f"{done.stderr}{arguments.binary} rig faults ended with status {done.returncode}")
    matrix = json.loads(done.stdout)
    if arguments.output:
        with open(arguments.output, "w", encoding="utf-8") as file:
            json.dump(matrix, file, indent=1)
    print("| fault | torque off after, ms | largest speed, rad/s | way, rad | cause | last words |")
    print("|---|---|---|---|---|---|")
    for case in matrix["cases"]:
        off = "never" if case["off_ms"] is None else f"{case['off_ms']:.0f}"
        words = "TORQUE IS NOT SHOWN TO BE OFF" if case["warning"] else ""
        wrong = f" **{case['wrong']}**" if case["wrong"] else ""
        print(
            f"| {case['fault']} | {off} | {case['speed_rad_s']:.3f} | {case['travel_rad']:.4f} "
            f"| {case['cause']}{wrong} | {words} |"
        )
    print(f"{len(matrix['cases'])} cases in {time.monotonic() - began:.0f} s, {matrix['wrong']} beyond the limits or silent")
    sys.exit(matrix["wrong"] > arguments.known)


if __name__ == "__main__":
    main()
