#!/usr/bin/env python3
"""Kills a batch (kill -9) at random moments until it is done: its table must equal an uninterrupted run's.

usage: scripts/batch_kill.py [--campaigns 60] [--times 30] [--seed 1] [--binary target/release/tautline]

A batch that is done before all kills have struck begins afresh in another folder; every such table is compared.
"""
import argparse
import pathlib
import random
import subprocess
import sys
import tempfile
import time

import fleet


def run(binary, campaigns, out):
    done = subprocess.run([binary, "batch", str(campaigns), "-o", str(out), "--quiet"])
    if done.returncode not in (0, 1):
        sys.exit(f"batch ended with status {done.returncode}")


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--campaigns", type=int, default=60)
    arguments.add_argument("--times", type=int, default=30)
    arguments.add_argument("--seed", type=int, default=1)
    arguments.add_argument("--binary", default="target/release/tautline")
    a = arguments.parse_args()
    moments = random.Random(a.seed)
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        campaigns = fleet.record(scratch / "fleet", a.campaigns, a.binary)
        (campaigns / "joint-001" / "session-000" / "campaign.toml").write_text("format = \"campaign/1\"\n")
        began = time.monotonic()
        run(a.binary, campaigns, scratch / "whole")
        whole_s = time.monotonic() - began
        whole = fleet.table(scratch / "whole")
        assert len(whole) == a.campaigns and sum(row["status"] == "failed" for row in whole.values()) == 1
        killed, finished, half_done = 0, 0, []
        while killed < a.times:
            out = scratch / f"killed-{finished}"
            # A few kills over each run: whatever it is at, reading, fitting, writing results, the table or the page.
            for _ in range(4):
                process = subprocess.Popen([a.binary, "batch", str(campaigns), "-o", str(out), "--quiet"])
                time.sleep(moments.uniform(0.0, 0.6) * whole_s)
                if process.poll() is None:
                    process.kill()
                    killed += 1
                    half_done.append(len(list(out.glob("campaigns/*.json"))))
                process.wait()
            run(a.binary, campaigns, out)
            if fleet.table(out) != whole:
                sys.exit(f"{out}: the table differs from the uninterrupted run's")
            left = list(out.glob("campaigns/.writing-*"))
            if left:
                sys.exit(f"{left} is left behind")
            finished += 1
    midway = sum(0 < done < a.campaigns for done in half_done)
    print(f"{killed} kills, {midway} of them with some results there and others not, with {min(half_done)} to {max(half_done)} of {a.campaigns} results there; {finished} tables after "
          f"restarts, each equal to the uninterrupted run's ({whole_s:.1f} s)")


if __name__ == "__main__":
    main()
