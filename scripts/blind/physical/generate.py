#!/usr/bin/env python3
"""Writes cases for the blind check from the physics of joints: campaigns with a model that lacks something, the answers elsewhere.

usage: scripts/blind/physical/generate.py --seed 1 --cases 120 --out DIR --answers DIR2 [--kinds effect,stale,none] [--only ID] [--identify BINARY]
"""
import argparse
import json
import multiprocessing
import os
import pathlib
import sys
import time

for threads in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"):
    os.environ.setdefault(threads, "1")

import numpy as np  # noqa: E402

import case as cases  # noqa: E402
from joints import STALE  # noqa: E402
from outside import OUTSIDE  # noqa: E402
from write import write_case  # noqa: E402

MIX = {"effect": 0.5, "stale": 0.12, "none": 0.12, "unknown": 0.12, "pair": 0.09, "triple": 0.05}
REPLACE_THE_JUMP = {"presliding", "reversal_transition", "backlash_width"}
SETS_TO_TRY = 6  # not every set of causes can be told apart in one campaign
NO_PARTNERS = [REPLACE_THE_JUMP, {"sensor_gain", "load_coefficient", "load_dependent_friction", "gravity"}, {"sensor_bias", "coulomb"},
               {"stribeck", "stribeck_level"}, {"gravity_phase", "elastic_spring", "gravity"}, {"warm_up", "sensor_drift"}]


def deal(rng, items):
    """Endlessly through the items, each round in another order."""
    while True:
        yield from (items[i] for i in rng.permutation(len(items)))


def may_go_together(names):
    ids = [n for _, n in names]
    return len(set(ids)) == len(ids) and not any(len(group & set(ids)) > 1 for group in NO_PARTNERS)


def plan(seed, count, kinds, only):
    """(kind, options) of every case, by the mix, each id as often as the others; an option is a list of causes."""
    rng = np.random.default_rng([seed, 10])
    share = {k: MIX[k] for k in kinds}
    counts = {k: int(round(count * s / sum(share.values()))) for k, s in share.items()}
    counts[kinds[0]] += count - sum(counts.values())
    spare = {"effect": ("effect", "elastic_spring"), "stale": ("stale", "coulomb"), "unknown": ("outside", "drag_by_place")}
    effects = deal(rng, [("effect", n) for n in sorted(cases.EFFECTS)])
    stale = deal(rng, [("stale", n) for n in STALE])
    outside = deal(rng, [("outside", n) for n in sorted(OUTSIDE)])

    def several(size):
        while True:
            names = [next(stale) if rng.random() < 0.2 else next(effects) for _ in range(size)]
            if may_go_together(names):
                return names

    def options(kind):
        if kind == "none":
            return [[]]
        if kind in ("pair", "triple"):
            return [several(2 if kind == "pair" else 3) for _ in range(SETS_TO_TRY)]
        if only:
            return [[({"unknown": "outside"}.get(kind, kind), only)]]
        ids = {"effect": effects, "stale": stale, "unknown": outside}[kind]
        return [[next(ids)], [spare[kind]]]

    listed = [(kind, options(kind)) for kind in kinds for _ in range(counts[kind])]
    return [listed[i] for i in rng.permutation(len(listed))]


def make(job):
    """One case, written; the answer apart."""
    number, seed, (kind, options), out, answers, binary = job
    started = time.perf_counter()
    rng = np.random.default_rng([seed, 11, number])
    name = f"case_{number:03d}"
    built = cases.build(kind, options, rng, binary)
    write_case(built, out / name, rng)
    built.answer |= {"case": name, "generator": "physical", "seconds": time.perf_counter() - started}
    (answers / f"{name}.json").write_text(json.dumps(built.answer, indent=2, default=float) + "\n")
    return name, built.answer


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--cases", type=int, default=120)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--answers", type=pathlib.Path, required=True)
    parser.add_argument("--kinds", default=",".join(MIX))
    parser.add_argument("--only", help="one effect, stale parameter or gap from outside")
    parser.add_argument("--identify", metavar="BINARY", help="tautline, to identify some of the models; without it all are drawn")
    parser.add_argument("--processes", type=int, default=2)
    args = parser.parse_args()
    out, answers = args.out.resolve(), args.answers.resolve()
    if answers == out or out in answers.parents:
        sys.exit("the answers must not lie under the cases")
    for folder in (out, answers):
        if folder.exists() and any(folder.iterdir()):
            sys.exit(f"{folder} is not empty")
        folder.mkdir(parents=True, exist_ok=True)
    listed = plan(args.seed, args.cases, args.kinds.split(","), args.only)
    jobs = [(i, args.seed, entry, out, answers, args.identify) for i, entry in enumerate(listed)]
    with multiprocessing.Pool(args.processes) as pool:
        for name, answer in pool.imap(make, jobs):
            print(f"{name} {answer['seconds']:.1f} s, {answer['samples']} samples, {answer['attempts']} draws", flush=True)


if __name__ == "__main__":
    main()
