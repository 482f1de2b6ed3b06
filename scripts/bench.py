#!/usr/bin/env python3
"""How long `tautline identify` takes beside the same protocol in SciPy and beside Polars merely reading the same files.

usage: scripts/bench.py CAMPAIGN [--runs 5] [--rival scripts/rival.py] [--binary target/release/tautline]

Whole processes, run in turn so that a machine's drift hits all alike; medians, ratios, peak memory. Polars' reading is
also timed without the start of Python. A CSV campaign of full size comes from scripts/full_campaign. (Needs numpy, scipy,
polars.)
"""
import argparse
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

READ = """
import pathlib, sys, time
import polars as pl
start = time.perf_counter()
rows = sum(pl.read_csv(p).height for p in sorted(pathlib.Path(sys.argv[1]).glob("*.csv")))
print(time.perf_counter() - start)
"""


def run(command):
    """Wall seconds, processor seconds, peak memory in MB and standard output of one process."""
    start = time.perf_counter()
    with tempfile.TemporaryFile() as out:
        process = subprocess.Popen(command, stdout=out, stderr=subprocess.DEVNULL)
        _, status, usage = os.wait4(process.pid, 0)
        wall = time.perf_counter() - start
        if status:
            sys.exit(f"failed: {' '.join(map(str, command))}")
        out.seek(0)
        return wall, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024, out.read().decode()


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("campaign", type=pathlib.Path)
    arguments.add_argument("--runs", type=int, default=5)
    arguments.add_argument("--rival", default="scripts/rival.py")
    arguments.add_argument("--binary", default="target/release/tautline")
    a = arguments.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        commands = {
            "tautline identify": [a.binary, "identify", a.campaign, "-o", f"{scratch}/out", "--force", "--quiet"],
            "SciPy": [sys.executable, a.rival, a.campaign],
            "Polars, reading only": [sys.executable, "-c", READ, a.campaign],
        }
        seen = {name: [] for name in commands}
        for _ in range(a.runs + 1):
            for name, command in commands.items():
                seen[name].append(run(list(map(str, command))))
    runs = {name: values[1:] for name, values in seen.items()}  # the first one warms the caches
    median = {name: statistics.median(r[0] for r in values) for name, values in runs.items()}
    print(f"{'':24}{'wall s':>10}{'processor s':>14}{'peak MB':>10}")
    for name, values in runs.items():
        print(f"{name:24}{median[name]:10.2f}{statistics.median(r[1] for r in values):14.2f}{max(r[2] for r in values):10.0f}")
    reading = statistics.median(float(r[3]) for r in runs["Polars, reading only"])
    ours = median["tautline identify"]
    print(f"\nSciPy takes {median['SciPy'] / ours:.1f} times as long as tautline")
    print(f"tautline takes {ours / median['Polars, reading only']:.2f} times as long as Polars reading, start of Python included")
    print(f"tautline takes {ours / reading:.2f} times as long as Polars reading, start of Python left out ({reading:.2f} s)")


if __name__ == "__main__":
    main()
