#!/usr/bin/env python3
"""The fault matrix: every fault of the software bus, and every pair of the ten worst, played to a capture in virtual time in `csp`,
`csv` and `cst`.

For each: the time until torque is off, the largest true speed and travel of the simulated joint until then, what is allowed, the cause
and the last words. What is allowed is defined in src/cli/rig/faults/allowed.rs: the limits and one braking ramp. Exit status 1 if more
than `--known` cases exceed that, or end silently.

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
    print("| fault | torque off after, ms | largest speed (allowed), rad/s | travel (allowed), rad | cause | last words |")
    print("|---|---|---|---|---|---|")
    for case in matrix["cases"]:
        off = "never" if case["off_ms"] is None else f"{case['off_ms']:.0f}"
        words = "TORQUE IS NOT SHOWN TO BE OFF" if case["warning"] else ""
        wrong = f" **{case['wrong']}**" if case["wrong"] else ""
        allowed = "range" if case["travel_allowed_rad"] is None else f"{case['travel_allowed_rad']:.3f}"
        print(
            f"| {case['fault']} | {off} | {case['speed_rad_s']:.3f} ({case['speed_allowed_rad_s']:.3f}) "
            f"| {case['travel_rad']:.4f} ({allowed}) | {case['cause']}{wrong} | {words} |"
        )
    print(f"{len(matrix['cases'])} cases in {time.monotonic() - began:.0f} s, {matrix['wrong']} exceed what is allowed or end silently")
    sys.exit(matrix["wrong"] > arguments.known)


if __name__ == "__main__":
    main()
