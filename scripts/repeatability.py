#!/usr/bin/env python3
"""What `repeatability` says of simulated sets of runs, of which most hold something that was planted.

usage: scripts/repeatability.py [--sets 30] [--seed 1] [--binary target/release/tautline] [--jobs N] [--need 0.95] [--verbose]

A set is four to six runs of a joint of its own, its parameters 0.7 to 1.4 times the bundled elbow's, 12 speeds, with two named
conditions: one in numbers, one in words. Planted is one of: nothing; friction of one direction that follows the one or the other
condition (Coulomb or viscous, 6 to 25 % over their range); gravity that follows the number (payload, 4 to 15 %, not declared);
friction of one direction that scatters from run to run for no reason told (standard deviation 4 to 10 %). A and B(v) at three speeds and
both directions are judged: what was planted changes is to be called so, with the right condition or none; what it does not
change is to be called repeatable. A planted change of a function below three times the half width of its interval counts for nothing either way.
Told: precision and recall. --need: exits with 1 below it. (Standard library only.)
"""
import argparse
import collections
import concurrent.futures
import copy
import json
import os
import pathlib
import random
import re
import subprocess
import sys
import tempfile

from changes import joint

PLANTED = ("nothing", "number", "word", "payload", "scatter")
LARGE = 3.0  # half widths


def b_nm(model, direction, speed):
    from coverage import true_values
    return true_values(model, direction, speed)[1]


def plan(rng, kind, runs):
    """Each run's conditions, and its model's friction or gravity relative to the joint's."""
    numbers = rng.sample((0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0), runs)
    words = [rng.choice(("ann", "ben")) for _ in range(runs)]
    words[:2] = rng.sample(("ann", "ben"), 2)
    if kind == "word":
        # Each word at least twice, or chance explains it as well.
        words = rng.sample(["ann", "ben"] * 3, 6)[:runs]
        while min(words.count("ann"), words.count("ben")) < 2:
            words = rng.sample(["ann", "ben"] * 3, 6)[:runs]
    reach = max(numbers) - min(numbers)
    sign = rng.choice((-1, 1))
    size = rng.uniform(0.04, 0.15) if kind == "payload" else rng.uniform(0.06, 0.25)
    shares = {
        "nothing": [1.0] * runs,
        "number": [1 + sign * size * (x - min(numbers)) / reach for x in numbers],
        "payload": [1 + size * (x - min(numbers)) / reach for x in numbers],
        "word": [1 + sign * size * (w == "ben") for w in words],
    }
    scatter = rng.uniform(0.04, 0.1)
    return numbers, words, shares.get(kind) or [max(0.5, rng.gauss(1, scatter)) for _ in range(runs)]


def one(a, index):
    rng = random.Random(1000 * a.seed + index)
    kind, runs = PLANTED[index % len(PLANTED)], rng.randint(5 if PLANTED[index % len(PLANTED)] == "word" else 4, 6)
    model, direction, term = joint(rng), rng.choice(("up", "down")), rng.choice(("a_j", "d"))
    numbers, words, shares = plan(rng, kind, runs)
    models = []
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        lines = ['format = "batch/1"']
        for i in range(runs):
            run = copy.deepcopy(model)
            if kind == "payload":
                run["dynamics"]["gravity_nm"] *= shares[i]
            else:
                run["friction"][direction][term] *= shares[i]
            models.append(run)
            (scratch / "truth.json").write_text(json.dumps(run))
            subprocess.run([a.binary, "simulate", "--model", scratch / "truth.json", "-o", scratch / f"{i}", "--rate-hz", "100", "--cosines", "1",
                            "--speeds", "12", "--repeats", "2", "--seed", str(100_000 * a.seed + 100 * index + i + 1), "--quiet"], check=True)
            file = scratch / f"{i}" / "campaign.toml"
            file.write_text(re.sub(r"gravity_nm = .*", f"gravity_nm = {model['dynamics']['gravity_nm']!r}", file.read_text()))
            lines += ["[[campaigns]]", f'path = "{i}"', f'conditions = {{ payload_kg = {numbers[i]}, operator = "{words[i]}" }}']
        (scratch / "runs.toml").write_text("\n".join(lines) + "\n")
        done = subprocess.run([a.binary, "repeatability", scratch / "runs.toml", "--json"], check=True, capture_output=True, text=True)
    counts = collections.Counter()
    for q in json.loads(done.stdout)["joints"][0]["quantities"]:
        if not re.match(r"A |B\(", q["name"]):
            if kind == "nothing" and q["verdict"] != "not_identifiable":
                counts["parameters"] += 1
                counts["parameters called"] += q["verdict"] != "repeatable"
            continue
        judge(counts, kind, q, models, direction, a, index)
    return kind, counts


def judge(counts, kind, q, models, direction, a, index):
    """Whether the verdict on a function is right."""
    of = q["name"].split()[-1]
    if q["name"].startswith("A "):
        values = [m["dynamics"]["gravity_nm"] / (1 - m["friction"][of]["mu_c"]) * m["joint"]["winch_radius_m"] / m["joint"]["pulley_radius_m"] for m in models]
    else:
        speed = float(re.match(r"B\(([0-9.]+)", q["name"])[1])
        values = [b_nm(m, of, speed) for m in models]
    reach, is_changed = max(values) - min(values), max(values) != min(values)
    claimed = q["claimed_half_width"]
    called = q["verdict"] not in ("repeatable", "not_identifiable")
    wanted = {"number": ("depends_on_condition", "payload_kg"), "payload": ("depends_on_condition", "payload_kg"),
              "word": ("depends_on_condition", "operator"), "scatter": ("scatters_more_than_claimed", None)}.get(kind)
    right = called and is_changed and (q["verdict"], q["condition"]) == wanted
    if is_changed and (claimed is None or reach < LARGE * claimed):
        counts["too small to judge"] += 1
        return
    counts["called"] += called
    counts["called rightly"] += called and is_changed and (q["verdict"] == wanted[0])
    counts["planted"] += is_changed
    counts["found"] += right
    if a.verbose and (called or is_changed) and not right:
        print(index, kind, len(models), q["name"], q["verdict"], q["condition"], f"reach {reach:.4f} claimed {claimed:.4f} honest {q['honest_half_width']:.4f}", file=sys.stderr)


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--sets", type=int, default=30)
    arguments.add_argument("--seed", type=int, default=1)
    arguments.add_argument("--binary", default="target/release/tautline")
    arguments.add_argument("--jobs", type=int, default=os.cpu_count())
    arguments.add_argument("--need", type=float)
    arguments.add_argument("--verbose", action="store_true")
    a = arguments.parse_args()
    total, by_kind = collections.Counter(), collections.defaultdict(collections.Counter)
    with concurrent.futures.ThreadPoolExecutor(a.jobs) as pool:
        for kind, counts in pool.map(lambda index: one(a, index), range(a.sets)):
            total.update(counts)
            by_kind[kind].update(counts)
    print(f"{'planted':10} functions changed  found  called  rightly")
    for kind, counts in by_kind.items():
        print(f"{kind:10} {counts['planted']:17} {counts['found']:6} {counts['called']:7} {counts['called rightly']:8}")
    precision = total["called rightly"] / max(total["called"], 1)
    recall = total["found"] / max(total["planted"], 1)
    print(f"precision {precision:.3f}, recall {recall:.3f}; {total['too small to judge']} planted changes too small to judge;"
          f" parameters of sets without a change called anything: {total['parameters called']} of {total['parameters']}")
    if a.need:
        sys.exit(not (precision >= a.need and recall >= a.need))


if __name__ == "__main__":
    main()
