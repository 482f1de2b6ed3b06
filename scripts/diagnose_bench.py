#!/usr/bin/env python3
"""How long `tautline diagnose` takes: rows, trials, causes, seconds, processor seconds, memory.

usage: scripts/diagnose_bench.py [--binary target/release/tautline] [--runs 3] [--large]

Simulated campaigns of the elbow with one, two and three effects, the bundled da Vinci recording, and with --large one of some 4 million
rows. Whole processes, medians. (Needs Python 3 only.)
"""
import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

MODEL = "data/elbow/truth/model.json"
SPRING = "elastic_spring:stiffness_nm_rad=0.1,preload_nm=-0.05"
RIPPLE = "torque_ripple:periods_per_rad=6,sin_1_nm=0.02"
GAIN = "sensor_gain:error=0.05"
MIDDLE = ["--speeds", "4", "--repeats", "3", "--cosines", "3", "--rate-hz", "330"]
LARGE = ["--speeds", "20", "--repeats", "3", "--cosines", "3", "--rate-hz", "1000"]


def run(command):
    """Wall seconds, processor seconds, peak memory in MB of one process."""
    start = time.perf_counter()
    process = subprocess.Popen(list(map(str, command)), stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    if status:
        sys.exit(f"failed: {' '.join(map(str, command))}")
    return time.perf_counter() - start, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def rows_of(campaign):
    """Rows of all CSV logs; nothing where they are of another format."""
    logs = list(campaign.glob("*.csv"))
    return sum(sum(1 for _ in log.open("rb")) - 1 for log in logs), len(logs)


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--binary", default="target/release/tautline")
    arguments.add_argument("--runs", type=int, default=3)
    arguments.add_argument("--large", action="store_true")
    a = arguments.parse_args()
    cases = [("one", [SPRING], MIDDLE), ("two", [SPRING, RIPPLE], MIDDLE), ("three", [SPRING, RIPPLE, GAIN], MIDDLE)]
    if a.large:
        cases.append(("large", [SPRING], LARGE))
    print(f"{'campaign':10}{'rows':>10}{'trials':>8}{'causes':>8}{'s':>8}{'cpu s':>8}{'MB':>6}  verdict")
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        jobs = []
        for name, effects, plan in cases:
            asked = [word for effect in effects for word in ("--effect", effect)]
            run([a.binary, "simulate", "--model", MODEL, "-o", scratch / name, "--seed", "1", "--quiet", *plan, *asked])
            jobs.append((name, scratch / name, MODEL, len(effects)))
        jobs.append(("davinci_l4", pathlib.Path("data/davinci_l4"), "data/davinci_l4/base_model.json", 2))
        for name, campaign, model, causes in jobs:
            out = scratch / "out"
            command = [a.binary, "diagnose", campaign, "--model", model, "-o", out, "--quiet", "--force"]
            seen = [run(command) for _ in range(a.runs)]
            seconds, cpu, memory = (statistics.median(part) for part in zip(*seen))
            verdict = json.loads((out / "diagnosis.json").read_text())["verdict"]
            rows, trials = rows_of(campaign)
            said = f"{verdict['kind']} {'+'.join(verdict['effects'])}"
            print(f"{name:10}{rows:10}{trials:8}{causes:8}{seconds:8.1f}{cpu:8.1f}{memory:6.0f}  {said}", flush=True)


if __name__ == "__main__":
    main()
