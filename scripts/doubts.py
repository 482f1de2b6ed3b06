#!/usr/bin/env python3
"""How often `tautline validate` names a wrong scale, sign, zero, radius or gravity, and how often it doubts what is right.

usage: scripts/doubts.py [--campaigns 100] [--binary target/release/tautline] [--seed 1] [--jobs 2]

Each campaign is a random joint, recorded by `tautline simulate`: once declared rightly, once with one mistake in its campaign.toml.
A factor of 2 in gravity, in a radius and in the torque are one and the same to any data: `named` counts a mistake among the
causes that the doubt names, `named first` as the first of them.
Ends with status 1 when fewer than 90 % are named or more than 3 % of the right ones are doubted. (Standard library only.)
"""
import argparse
import collections
import concurrent.futures
import json
import math
import pathlib
import random
import re
import subprocess
import sys
import tempfile


def joint(rng):
    """A cable-driven joint of any size."""
    r2 = math.exp(rng.uniform(math.log(0.02), math.log(0.09)))
    r1 = r2 * rng.uniform(0.15, 0.6)
    gravity = math.exp(rng.uniform(math.log(0.3), math.log(8.0)))
    coulomb = gravity / r2 * rng.uniform(0.08, 0.5)
    mu = rng.uniform(0.05, 0.42)
    sides = {}
    for direction, sense in (("up", 1), ("down", -1)):
        force = coulomb * (1.0 if sense > 0 else rng.uniform(0.4, 1.2))
        sides[direction] = {"mu_c": mu * rng.uniform(0.93, 1.05), "a_j": sense * force, "b_c": sense * force * rng.uniform(0, 0.4),
                            "c_c": sense / (0.08 * r2), "b_j": 0.0, "c_j": sense / 0.3, "d": force * rng.uniform(0.1, 0.6)}
    return {"format": "model/1", "joint": {"name": "joint", "winch_radius_m": r1, "pulley_radius_m": r2, "backlash_m": r2 * 0.015},
            "dynamics": {"gravity_nm": gravity, "inertia_kg_m2": gravity / 9.81 * 0.15}, "friction": sides,
            "combination": {"kind": "arctan", "k": 0.75, "p": 2.0}, "effects": []}


def times(key, factor):
    """Multiplies a key's value in campaign.toml."""
    return lambda text: re.sub(rf"^{key} = (\S+)", lambda found: f"{key} = {float(found[1]) * factor!r}", text, flags=re.M)


def swap(text):
    text = text.replace("winch_radius_m", "x").replace("pulley_radius_m", "winch_radius_m")
    return text.replace("x =", "pulley_radius_m =")


def column(key, more):
    return lambda text: re.sub(rf"^({key} = {{.*?) }}$", rf"\1, {more} }}", text, flags=re.M)


MISTAKES = {
    "scale": [column("torque", "scale = 1000.0"), column("torque", "scale = 0.001"), column("torque", "scale = 100.0")],
    "sign": [lambda text: text.replace("torque_sign = -1", "torque_sign = 1"), column("position", "scale = -1.0")],
    "zero": [column("position", f"offset = {degrees}.0") for degrees in (-25, -12, -8, 8, 12, 25)],
    "radius": [swap, times("winch_radius_m", 2.0), times("pulley_radius_m", 0.5)],
    "gravity": [times("gravity_nm", 2.0), times("gravity_nm", 9.81), times("gravity_nm", 1 / 9.81), times("gravity_nm", -1.0)],
}


def causes(binary, campaign):
    done = subprocess.run([binary, "validate", campaign, "--json"], capture_output=True, text=True)
    return [doubt["causes"] for doubt in json.loads(done.stdout)["doubts"]]


def one(binary, seed):
    """The doubts of a right campaign, the mistake made in it, and the doubts then."""
    rng = random.Random(seed)
    with tempfile.TemporaryDirectory() as scratch:
        model = pathlib.Path(scratch) / "model.json"
        model.write_text(json.dumps(joint(rng)))
        campaign = pathlib.Path(scratch) / "campaign"
        gravity = json.loads(model.read_text())["dynamics"]["gravity_nm"]
        noise = 0.005 * gravity * rng.uniform(0.2, 2.0)
        subprocess.run([binary, "simulate", "--model", model, "-o", campaign, "--rate-hz", "100", "--speeds", "4", "--slowest-rad-s", "0.05",
                        "--repeats", "1", "--cosines", str(rng.randrange(2)), "--noise-nm", str(noise), "--seed", str(seed), "--quiet"], check=True)
        right = causes(binary, campaign)
        kind = list(MISTAKES)[seed % len(MISTAKES)]
        variant = rng.randrange(len(MISTAKES[kind]))
        file = campaign / "campaign.toml"
        file.write_text(MISTAKES[kind][variant](file.read_text()))
        return right, f"{kind} {variant}", causes(binary, campaign)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--campaigns", type=int, default=100)
    parser.add_argument("--binary", default="target/release/tautline")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    a = parser.parse_args()
    with concurrent.futures.ThreadPoolExecutor(a.jobs) as pool:
        results = list(pool.map(lambda i: one(a.binary, a.seed + i), range(a.campaigns)))
    false = [(i, right) for i, (right, _, _) in enumerate(results) if right]
    tally = collections.defaultdict(lambda: [0, 0, 0])
    for _, mistake, found in results:
        kind = mistake.split()[0]
        counts = tally[mistake]
        counts[0] += 1
        counts[1] += any(kind in named for named in found)
        counts[2] += bool(found) and found[0][0] == kind
    for mistake, (count, named, first) in sorted(tally.items()):
        print(f"{mistake:12} {named:3} of {count:3} named, {first:3} named first")
    named, first = (sum(counts[i] for counts in tally.values()) for i in (1, 2))
    print(f"named {named} of {len(results)}, named first {first}; right campaigns doubted: {len(false)} of {len(results)} {false[:5]}")
    sys.exit(0 if named >= 0.9 * len(results) and len(false) <= 0.03 * len(results) else 1)


if __name__ == "__main__":
    main()
