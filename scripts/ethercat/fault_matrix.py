#!/usr/bin/env python3
"""The fault matrix: every fault of the software bus, and every pair of the ten worst, played to a capture in virtual time in `csp`,
`csv` and `cst`, and some with two drives.

For each: the time until torque is off, the largest true speed and travel of the simulated joint until then, what is allowed (the limits
and one braking ramp, as defined in src/cli/rig/faults/allowed.rs), the cause and the last words. Some faults exceed that whatever is
sent, because nothing acts before they have happened: they are bounded as well, and listed at the end by name with the reason. Exit
status 1 if more than `--known` cases exceed that bound or end silently, or if more than `--beyond` are on the list.

    scripts/ethercat/fault_matrix.py [--binary target/release/tautline] [--only csv] [--known 0] [--beyond 1] [-o matrix.json]
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
    parser.add_argument("--beyond", type=int, default=1, help="cases that exceed them by what no command could prevent")
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
        print(
            f"| {case['fault']} | {off} | {case['speed_rad_s']:.3f} ({case['speed_allowed_rad_s']:.3f}) "
            f"| {case['travel_rad']:.4f} ({case['travel_allowed_rad']:.3f}) | {case['cause']}{wrong} | {words} |"
        )
    beyond = [case for case in matrix["cases"] if case["beyond"] and not case["wrong"]]
    print(f"\n{len(beyond)} cases exceed the limits and one braking ramp by what no command could prevent:\n")
    for case in beyond:
        print(f"- {case['fault']}: {case['beyond']}, {case['speed_rad_s']:.2f} rad/s, {case['travel_rad']:.3f} rad")
    took = time.monotonic() - began
    print(f"\n{len(matrix['cases'])} cases in {took:.0f} s; {matrix['wrong']} exceed even that or end silently")
    sys.exit(matrix["wrong"] > arguments.known or len(beyond) > arguments.beyond)


if __name__ == "__main__":
    main()
