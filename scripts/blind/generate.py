#!/usr/bin/env python3
"""Writes cases for the blind check: campaigns with a model that lacks something, the answers elsewhere.

usage: scripts/blind/generate.py --seed 1 --cases 120 --out DIR --answers DIR2 [--kinds effect,stale,none] [--only ID] [--variant NAME]
"""
import argparse
import json
import multiprocessing
import os
import pathlib
import sys
import time

for threads in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "POLARS_MAX_THREADS"):
    os.environ.setdefault(threads, "1")

import numpy as np  # noqa: E402

import case as cases  # noqa: E402
from causes import STALE, TIES, may_pair  # noqa: E402
from forms import FORMS  # noqa: E402
from unknowns import UNKNOWNS  # noqa: E402
from write import write_case  # noqa: E402

MIX = {"effect": 0.58, "stale": 0.12, "none": 0.12, "unknown": 0.08, "pair": 0.08, "tie": 0.02}
PAIRS_TO_TRY = 4  # not every two causes can be told apart in one campaign


def deal(rng, items):
    """Endlessly through the items, each round in another order."""
    while True:
        yield from (items[i] for i in rng.permutation(len(items)))


def plan(seed, count, kinds, only, variant):
    """(kind, options) of every case, by the mix, each id as often as the others; an option is the names and the variants of its causes."""
    rng = np.random.default_rng([seed, 0])
    share = {k: MIX[k] for k in kinds}
    counts = {k: int(round(count * s / sum(share.values()))) for k, s in share.items()}
    counts[kinds[0]] += count - sum(counts.values())
    ids, stale, unknowns, ties = (deal(rng, sorted(items)) for items in (FORMS, STALE, UNKNOWNS, TIES))
    variants = {effect: deal(rng, sorted(FORMS[effect])) for effect in FORMS}

    def effect_or(name=None):
        name = name or next(ids)
        return (name, next(variants[name])) if name in FORMS else (name, None)

    def pair():
        first = effect_or(only)
        while True:
            second = effect_or() if rng.random() < 0.75 else (next(stale), None)
            if may_pair(first[0], second[0]):
                return [first[0], second[0]], [first[1], second[1]]

    def options(kind):
        if kind == "none":
            return [([], [])]
        if kind == "pair":
            return [pair() for _ in range(PAIRS_TO_TRY)]
        if kind == "stale":
            return [([only or next(stale)], [None])]
        if kind == "effect":
            name, its_variant = effect_or(only)
            return [([name], [variant or its_variant])]
        return [([kind], [variant or next(unknowns if kind == "unknown" else ties)])]

    listed = [(kind, options(kind)) for kind in kinds for _ in range(counts[kind])]
    return [listed[i] for i in rng.permutation(len(listed))]


def make(job):
    """One case, written; the answer apart."""
    number, seed, (kind, options), out, answers = job
    started = time.perf_counter()
    rng = np.random.default_rng([seed, 1, number])
    name = f"case_{number:03d}"
    built = cases.build(kind, options, rng)
    write_case(built, out / name, rng)
    built.answer["case"] = name
    built.answer["seconds"] = time.perf_counter() - started
    (answers / f"{name}.json").write_text(json.dumps(built.answer, indent=2, default=float) + "\n")
    return name, built.answer


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--cases", type=int, default=120)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--answers", type=pathlib.Path, required=True)
    parser.add_argument("--kinds", default=",".join(MIX))
    parser.add_argument("--only", help="one effect or stale parameter")
    parser.add_argument("--variant", help="one variant of it")
    parser.add_argument("--processes", type=int, default=2)
    args = parser.parse_args()
    out, answers = args.out.resolve(), args.answers.resolve()
    if answers == out or out in answers.parents:
        sys.exit("the answers must not lie under the cases")
    for folder in (out, answers):
        if folder.exists() and any(folder.iterdir()):
            sys.exit(f"{folder} is not empty")
        folder.mkdir(parents=True, exist_ok=True)
    listed = plan(args.seed, args.cases, args.kinds.split(","), args.only, args.variant)
    jobs = [(i, args.seed, entry, out, answers) for i, entry in enumerate(listed)]
    with multiprocessing.Pool(args.processes) as pool:
        for name, answer in pool.imap(make, jobs):
            print(f"{name} {answer['seconds']:.1f} s, {answer['samples']} samples")


if __name__ == "__main__":
    main()
