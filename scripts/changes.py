#!/usr/bin/env python3
"""What `compare` says of pairs of simulated campaigns, of which half are unchanged and half differ in one thing.

usage: scripts/changes.py [--pairs 200] [--seed 1] [--binary target/release/tautline] [--speeds 12] [--repeats 2]
                          [--rate-hz 100] [--jobs N] [--need FALSE FOUND NAMED]

Each pair is of a joint of its own, its parameters 0.7 to 1.4 times the bundled elbow's, recorded twice with noise of its own. The
change is of 2 to 40 %: Coulomb, viscous or Stribeck friction of one direction, mu_c of one direction, the clearance, gravity
(the campaign still declares the old one) or a spring (of 2 to 40 % of the gravity torque per rad). Told: how many unchanged pairs
are called changed; of changes larger than three times what the interval of their kind allows how many are found, and how many of
those found are named: the right cause and direction, alone or among rivals that are said to be as likely.
--need: exits with 1 beyond these shares. (Standard library only.)
"""
import argparse
import collections
import concurrent.futures
import copy
import json
import math
import os
import pathlib
import random
import re
import subprocess
import sys
import tempfile

TRUTH = pathlib.Path("data/elbow/truth/model.json")
KINDS = ("coulomb_friction", "viscous_friction", "stribeck_friction", "friction_per_load", "change_over", "gravity", "spring")
NAMED = {"gravity": {"gravity_or_spring"}, "spring": {"gravity_or_spring", "position_zero"}}


def joint(rng):
    model = json.loads(TRUTH.read_text())
    for branch in model["friction"].values():
        for name in branch:
            branch[name] *= rng.uniform(0.8, 1.1) if name == "mu_c" else math.exp(rng.uniform(math.log(0.7), math.log(1.4)))
    model["dynamics"]["gravity_nm"] *= rng.uniform(0.7, 1.4)
    return model


def change(model, kind, by, rng):
    """The changed model, its direction, its effects, and the change as `compare` would tell it (N m of B, or a share)."""
    after, effects = copy.deepcopy(model), []
    direction = rng.choice(("up", "down"))
    branch, r1 = after["friction"][direction], model["joint"]["winch_radius_m"]
    per_force = r1 / (1 - branch["mu_c"])
    if kind == "coulomb_friction":
        size = abs(per_force * branch["a_j"] * by)
        branch["a_j"] *= 1 + by
    elif kind == "viscous_friction":
        size = abs(per_force * branch["d"] * 0.4 * by)
        branch["d"] *= 1 + by
    elif kind == "stribeck_friction":
        size = abs(per_force * (branch["b_c"] + branch["b_j"]) * by) / 2
        for name in ("b_c", "b_j"):
            branch[name] *= 1 + by
    elif kind == "friction_per_load":
        new = branch["mu_c"] * (1 + by)
        size = abs((1 - branch["mu_c"]) / (1 - new) - 1)
        branch["mu_c"] = new
    elif kind == "change_over":
        size, direction = abs(by), None
        after["joint"]["backlash_m"] *= 1 + by
    elif kind == "gravity":
        size, direction = abs(by), None
        after["dynamics"]["gravity_nm"] *= 1 + by
    else:
        size, direction = by, None
        effects = ["--effect", f"elastic_spring:stiffness_nm_rad={by * model['dynamics']['gravity_nm']}"]
    return after, direction, effects, size


def identified(a, model, declared, seed, effects, folder):
    folder.mkdir()
    (folder / "truth.json").write_text(json.dumps(model))
    subprocess.run([a.binary, "simulate", "--model", folder / "truth.json", "-o", folder / "c", "--rate-hz", str(a.rate_hz), "--cosines", "1",
                    "--speeds", str(a.speeds), "--repeats", str(a.repeats), "--seed", str(seed), "--quiet", *effects], check=True)
    file = folder / "c" / "campaign.toml"
    text = re.sub(r"gravity_nm = .*", f"gravity_nm = {declared['dynamics']['gravity_nm']!r}", file.read_text())
    file.write_text(re.sub(r"backlash_m = .*", f"backlash_m = {declared['joint']['backlash_m']!r}", text))
    subprocess.run([a.binary, "identify", folder / "c", "-o", folder / "o", "--quiet"], check=True, stdout=subprocess.DEVNULL)
    return folder / "o" / "model.json"


def allowed(kind, direction, models):
    """Half width of what a single cause of this kind is known to, from both models' A and B(v)."""
    def of(model):
        branches = model["functions"]
        if kind in ("gravity", "spring", "friction_per_load"):
            ds = [direction] if direction else ["up", "down"]
            return max(branches[d]["a_half_width_nm"] / abs(branches[d]["a_nm"]) for d in ds)
        if kind == "change_over":
            known = model["confidence"]["combination.p"]
            return (known["high"] - known["low"]) / 2 / model["combination"]["p"]
        levels = [level["half_width_nm"] for level in branches[direction]["b"]]
        alone = math.sqrt(sum(half**2 for half in levels)) / len(levels)
        # One speed in three tells of viscous or of Stribeck friction.
        return alone * (1 if kind == "coulomb_friction" else math.sqrt(3))
    return math.hypot(*map(of, models))


def one(a, index):
    rng = random.Random(1000 * a.seed + index)
    model = joint(rng)
    kind = None if index % 2 == 0 else KINDS[index // 2 % len(KINDS)]
    by = math.exp(rng.uniform(math.log(0.02), math.log(0.4))) * rng.choice((1, -1) if kind != "spring" else (1,))
    after, direction, effects, size = change(model, kind, by, rng) if kind else (model, None, [], 0.0)
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        files = [identified(a, model, model, 2 * index + 7, [], scratch / "before"),
                 identified(a, after, model, 2 * index + 8, effects, scratch / "after")]
        found = json.loads(subprocess.run([a.binary, "compare", *files, "--json"], check=True, capture_output=True, text=True).stdout)
        models = [json.loads(file.read_text()) for file in files]
    share = size / allowed(kind, direction, models) if kind else 0.0
    causes = found["what_changed"]
    said = [(c["what"], c["direction"]) for c in causes] + [(o["what"], o["direction"]) for c in causes for o in c["or"]]
    names = NAMED.get(kind, {kind})
    named = any(what in names and (direction is None or of == direction) for what, of in said)
    if a.verbose:
        print(index, kind, direction, f"{by:+.3f} {share:.1f} times", "changed" if found["changed"] else "same", said, file=sys.stderr)
    return kind, share, bool(found["changed"]), named


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--pairs", type=int, default=200)
    arguments.add_argument("--seed", type=int, default=1)
    arguments.add_argument("--binary", default="target/release/tautline")
    arguments.add_argument("--speeds", type=int, default=12)
    arguments.add_argument("--repeats", type=int, default=2)
    arguments.add_argument("--rate-hz", type=float, default=100.0)
    arguments.add_argument("--jobs", type=int, default=os.cpu_count())
    arguments.add_argument("--need", type=float, nargs=3)
    arguments.add_argument("--verbose", action="store_true")
    a = arguments.parse_args()
    counts = collections.Counter()
    with concurrent.futures.ThreadPoolExecutor(a.jobs) as pool:
        for kind, share, changed, named in pool.map(lambda index: one(a, index), range(a.pairs)):
            for of in (kind or "unchanged", "all" if kind else "none"):
                counts[of, "pairs"] += 1
                counts[of, "found"] += changed
                counts[of, "named"] += changed and named
                counts[of, "large"] += share > 3
                counts[of, "large found"] += share > 3 and changed
                counts[of, "large named"] += share > 3 and changed and named
    print(f"{'':18} pairs  called changed  named   beyond 3 half widths: found  named")
    for of in ("unchanged", *KINDS, "all"):
        row = [counts[of, column] for column in ("pairs", "found", "named", "large", "large found", "large named")]
        print(f"{of:18} {row[0]:5} {row[1]:15} {row[2]:6} {row[3]:21} {row[4]:6} {row[5]:6}")
    share = lambda part, whole: part / whole if whole else math.nan
    false = share(counts["unchanged", "found"], counts["unchanged", "pairs"])
    found = share(counts["all", "large found"], counts["all", "large"])
    named = share(counts["all", "named"], counts["all", "found"])
    print(f"false: {100 * false:.1f} %; large changes found: {100 * found:.1f} %; named of those found: {100 * named:.1f} %")
    if a.need:
        sys.exit(not (false <= a.need[0] and found >= a.need[1] and named >= a.need[2]))


if __name__ == "__main__":
    main()
