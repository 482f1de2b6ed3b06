#!/usr/bin/env python3
"""What diagnose says of joints that lack nothing, under their true model: coarse encoders of the physical generator.

usage: scripts/blind/physical/perfect.py [--seed 1] [--draws 120] [--binary PATH] [--most 0.1] [--verbose]

Draws joints, motions and sensors as generate.py does and keeps those whose encoder, read without care, would leave at least 0.4 of the
floor (`rounding`: speed and acceleration from low-passed steps). The torque is the true model's with noise alone, the model handed over the true
one with a confidence of 2 %. Printed are, in units of the added noise, what tautline leaves of it (rmse), its floor and the encoder's part of
that; then the mean over all joints of what the encoder leaves above the noise, of how far the floor is off, and the share of verdicts that
name something: with --most, exit status 1 above that share.
"""
import argparse
import pathlib
import sys
import tempfile

sys.path.append(str(pathlib.Path(__file__).parent.parent))

import numpy as np  # noqa: E402

import case as cases  # noqa: E402
from generate import MIX, plan  # noqa: E402
from score import run  # noqa: E402
from write import write_case  # noqa: E402

COARSE = 0.4  # of the floor
CONFIDENCE = 0.02


def joint(seed, number, names):
    """A joint without any effect, or None where its encoder is fine or the draw no fair one."""
    rng = np.random.default_rng([seed, 12, number])
    try:
        s = cases.setting(names, rng)
    except (cases.Rejected, np.linalg.LinAlgError):
        return None
    if s.rounding < COARSE * s.floor:
        return None
    noises = str(rng.choice(cases.NOISES))
    confidence = {name: (value * (1 - CONFIDENCE), value * (1 + CONFIDENCE)) for name, value in s.base.values().items()}
    recorded = s.y0 + s.noise * cases.noise(s.world, rng, noises)
    return s, cases.Case(s.world, s.style, s.base, confidence, recorded, s.encoder, False, {"floor_nm": s.floor}), rng


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--draws", type=int, default=120)
    parser.add_argument("--binary", default="target/release/tautline")
    parser.add_argument("--most", type=float, help="largest share of verdicts that name something")
    parser.add_argument("--verbose", action="store_true")
    args = parser.parse_args()
    rows = []
    for number, (_, options) in enumerate(plan(args.seed, args.draws, list(MIX), None)):
        drawn = joint(args.seed, number, options[0])
        if drawn is None:
            continue
        s, case, rng = drawn
        with tempfile.TemporaryDirectory() as scratch:
            folder = pathlib.Path(scratch)
            write_case(case, folder, rng)
            diagnosis, trouble, _ = run(args.binary, folder, folder / "out")
        if diagnosis is None:
            sys.exit(f"joint {number}: {trouble}")
        gap, verdict = diagnosis["gap"], diagnosis["verdict"]
        rmse, floor, encoder = (gap[key] / s.noise for key in ("rmse_nm", "noise_floor_nm", "encoder_nm"))
        named = " ".join([verdict["kind"], "+".join(verdict.get("effects") or [])]).strip()
        rows.append((np.sqrt(max(0.0, rmse**2 - 1)), abs(floor / rmse - 1), verdict["kind"] != "none"))
        if args.verbose or rows[-1][2]:
            print(f"joint {number}: rounding {s.rounding / s.noise:.2f}, rmse {rmse:.2f}, floor {floor:.2f}, of the encoder {encoder:.2f}: {named}")
    left, off, false = np.mean(rows, axis=0)
    print(f"{len(rows)} joints: the encoder leaves {left:.2f} times the noise, the floor is off by {100 * off:.0f} %, {100 * false:.0f} % of verdicts name something")
    if args.most is not None and false > args.most:
        sys.exit(f"more than {args.most} of the verdicts name what is not there")


if __name__ == "__main__":
    main()
