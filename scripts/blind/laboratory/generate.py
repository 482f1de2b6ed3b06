#!/usr/bin/env python3
"""Writes cases for the blind check as a laboratory would record them; the answers elsewhere.

usage: scripts/blind/laboratory/generate.py --seed 1 --cases 120 --out DIR --answers DIR2
                                            [--kinds effect,stale,none] [--only ID]
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

from case import EFFECTS, build  # noqa: E402
from draw import Unfit  # noqa: E402
from joints import STALE  # noqa: E402
from outside import OUTSIDE  # noqa: E402
from styles import STYLES  # noqa: E402
from write import write_case  # noqa: E402

MIX = {"effect": 0.5, "stale": 0.12, "none": 0.12, "unknown": 0.12, "pair": 0.10, "triple": 0.04}
IDS = {"effect": EFFECTS, "stale": STALE, "none": (), "unknown": OUTSIDE}
DRAWS = 400  # of a case
UNKNOWN_DRAWS = 60  # of one thing from outside the library, before others have their turn
IN_SEVERAL = (*EFFECTS, "gravity", "coulomb", "viscous", "load_coefficient", "backlash_width")
NO_PARTNERS = (  # one name may honestly cover both
    {"sensor_bias", "sensor_drift"}, {"reversal_transition", "presliding"}, {"reversal_transition", "backlash_width"},
    {"presliding", "backlash_width"}, {"sensor_gain", "load_coefficient"},
    {"load_dependent_friction", "load_coefficient"}, {"sensor_bias", "coulomb"},
)


def shares(kinds, cases):
    """How many cases of each kind: whole shares, what is left over to those that miss most."""
    total = round(sum(MIX[k] for k in kinds), 9)
    wanted = {k: MIX[k] / total * cases for k in MIX if k in kinds}
    counts = {k: int(np.floor(w)) for k, w in wanted.items()}
    for k in sorted(wanted, key=lambda k: counts[k] - wanted[k]):
        if sum(counts.values()) < cases:
            counts[k] += 1
    return counts


def plan(seed, cases, kinds, only):
    """(kind, causes) of every case, each id as often as the others; causes are None where each draw chooses some."""
    rng = np.random.default_rng([seed, 999999])
    counts = shares(kinds, cases)

    def deal(ids, count):
        """Through the ids, each round in another order."""
        dealt = []
        while len(dealt) < count:
            dealt += [ids[i] for i in rng.permutation(len(ids))]
        return dealt[:count]

    listed = []
    for kind, ids in IDS.items():
        if kind == "none":
            listed += [(kind, [])] * counts.get(kind, 0)
        else:
            listed += [(kind, [c]) for c in deal([only] if only else list(ids), counts.get(kind, 0))]
    for kind in ("pair", "triple"):
        listed += [(kind, None)] * counts.get(kind, 0)
    return [listed[i] for i in rng.permutation(len(listed))]


def causes_of(kind, planned, rng, draw, only):
    """The causes of one draw; None where they do not go together."""
    if kind in ("pair", "triple"):
        chosen = [str(c) for c in rng.choice(IN_SEVERAL, 2 if kind == "pair" else 3, replace=False)]
        return None if any(group <= set(chosen) for group in NO_PARTNERS) else chosen
    if kind == "unknown" and draw >= UNKNOWN_DRAWS and not only:
        return [list(OUTSIDE)[int(rng.integers(len(OUTSIDE)))]]
    return planned


def make(job):
    """One case, written; the answer apart."""
    number, seed, (kind, planned), out, answers, only = job
    started = time.perf_counter()
    name = f"case_{number:03d}"
    for draw in range(DRAWS):
        rng = np.random.default_rng([seed, number, draw])
        causes = causes_of(kind, planned, rng, draw, only)
        if causes is None:
            continue
        style = list(STYLES)[int(rng.integers(len(STYLES)))]
        try:
            built = build(kind, causes, style, rng)
        except Unfit:
            continue
        write_case(built, out / name, rng)
        seconds = time.perf_counter() - started
        answer = built.answer | {"case": name, "generator": "laboratory", "attempts": draw + 1, "seconds": seconds}
        (answers / f"{name}.json").write_text(json.dumps(answer, indent=2, default=float) + "\n")
        return name, answer
    raise RuntimeError(f"{name}: no fair question in {DRAWS} draws of {kind} {planned}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--cases", type=int, default=120)
    parser.add_argument("--out", type=pathlib.Path, required=True)
    parser.add_argument("--answers", type=pathlib.Path, required=True)
    parser.add_argument("--kinds", default=",".join(MIX))
    parser.add_argument("--only", help="one effect, stale parameter or gap from outside")
    parser.add_argument("--processes", type=int, default=2)
    args = parser.parse_args()
    kinds = args.kinds.split(",")
    if args.only:
        kinds = [k for k in kinds if args.only in IDS.get(k, ())]
    if not kinds or set(kinds) - set(MIX):
        sys.exit(f"no such kinds or causes: {args.kinds} {args.only or ''}")
    out, answers = args.out.resolve(), args.answers.resolve()
    if answers == out or out in answers.parents:
        sys.exit("the answers must not lie under the cases")
    for folder in (out, answers):
        if folder.exists() and any(folder.iterdir()):
            sys.exit(f"{folder} is not empty")
        folder.mkdir(parents=True, exist_ok=True)
    listed = plan(args.seed, args.cases, kinds, args.only)
    jobs = [(i, args.seed, entry, out, answers, args.only) for i, entry in enumerate(listed)]
    with multiprocessing.Pool(args.processes) as pool:
        for name, answer in pool.imap(make, jobs):
            samples, draws = answer["samples"], answer["attempts"]
            print(f"{name} {answer['seconds']:.1f} s, {samples} samples, {draws} draws", flush=True)


if __name__ == "__main__":
    main()
