#!/usr/bin/env python3
"""How often the 95 % intervals of A and of B hold the truth, over simulated campaigns.

usage: scripts/coverage.py [--campaigns 500] [--binary target/release/tautline] [--within 0.93 0.97]

Each campaign is the whole protocol at 200 Hz with white noise, seed 1, 2, ... A: mean of the legs +- half width as reported.
B: each leg's B +- its own standard error and that of A. Also: every friction parameter's interval, those called pinned, and p of the change-over.
Ends with status 1 when A or B is held less or more often than `--within`. (Standard library only.)
"""
import argparse
import collections
import concurrent.futures
import csv
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile

TRUTH = pathlib.Path("data/elbow/truth/model.json")
T_18 = 2.101  # Student's t at 97.5 %, 20 blocks less two parameters


def true_values(model, direction, speed):
    joint, f = model["joint"], model["friction"][direction]
    ratio = joint["winch_radius_m"] / joint["pulley_radius_m"]
    v = speed if direction == "up" else -speed
    stribeck = f["b_c"] * math.exp(-f["c_c"] * joint["pulley_radius_m"] * v) + f["b_j"] * math.exp(-f["c_j"] * v)
    b = joint["winch_radius_m"] / (1 - f["mu_c"]) * (f["a_j"] + stribeck + f["d"] * v)
    return ratio * model["dynamics"]["gravity_nm"] / (1 - f["mu_c"]), b


def one(binary, seed, model):
    """Held or not: per quantity a list of truth values."""
    held = collections.defaultdict(list)
    with tempfile.TemporaryDirectory() as scratch:
        simulate = [binary, "simulate", "--model", TRUTH, "-o", f"{scratch}/c", "--rate-hz", "200", "--cosines", "1",
                    "--seed", str(seed), "--quiet"]
        subprocess.run(simulate, check=True)
        subprocess.run([binary, "identify", f"{scratch}/c", "-o", f"{scratch}/o", "--quiet"], check=True)
        found = json.load(open(f"{scratch}/o/model.json"))
        legs = list(csv.DictReader(open(f"{scratch}/o/trials.csv")))
    for direction in ("up", "down"):
        fit = found["fit"][direction]
        a_true, _ = true_values(model, direction, 1.0)
        held[f"A {direction}"].append(abs(fit["a_nm"] - a_true) <= fit["a_half_width_nm"])
        for leg in (r for r in legs if r["direction"] == direction):
            _, b_true = true_values(model, direction, float(leg["speed_rad_s"]))
            half = math.hypot(T_18 * float(leg["b_se_nm"]), fit["a_half_width_nm"] * float(leg["mean_sine"]))
            held[f"B {direction}"].append(abs(float(leg["b_nm"]) - b_true) <= half)
        for name, truth in model["friction"][direction].items():
            known = found["confidence"][f"friction.{direction}.{name}"]
            inside = (known["low"] is None or known["low"] <= truth) and (known["high"] is None or truth <= known["high"])
            held["any friction parameter"].append(inside)
            if known["status"] == "pinned":
                held["pinned friction parameter"].append(inside)
    known = found["confidence"]["combination.p"]
    held["p of the change-over"].append(known["low"] <= model["combination"]["p"] <= known["high"])
    return held


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--campaigns", type=int, default=500)
    arguments.add_argument("--binary", default="target/release/tautline")
    arguments.add_argument("--within", type=float, nargs=2, default=(0.93, 0.97))
    a = arguments.parse_args()
    model = json.loads(TRUTH.read_text())
    total = collections.defaultdict(list)
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for held in pool.map(lambda seed: one(a.binary, seed, model), range(1, a.campaigns + 1)):
            for name, values in held.items():
                total[name] += values
    failed = False
    for name, values in total.items():
        share = sum(values) / len(values)
        judged = name[0] in "AB"
        off = judged and not a.within[0] <= share <= a.within[1]
        failed |= off
        print(f"{name:28}{100 * share:7.1f} % of {len(values)}{'   outside the limits' if off else ''}")
    sys.exit(failed)


if __name__ == "__main__":
    main()
