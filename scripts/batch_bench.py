#!/usr/bin/env python3
"""`batch` over large campaigns: campaigns per second, 1 thread to 2, peak memory, beside SciPy with multiprocessing.

usage: scripts/batch_bench.py [--campaigns 100] [--rows 200000] [--runs 3] [--binary target/release/tautline]

SciPy does the steps that A, B(v) and the friction parameters take (`scripts/rival.py`) on the sweeps, a campaign a process;
tautline those, the combination, the intervals and the judgement of the cosine trial. Needs numpy, scipy, polars.
"""
import argparse
import contextlib
import io
import multiprocessing
import os
import pathlib
import resource
import statistics
import subprocess
import sys
import tempfile
import time

import fleet

# The paper's twenty speeds once, and one cosine cascade of 265.6 s.
PROTOCOL = ["--repeats", "1", "--cosines", "1"]
# Random starts of SciPy's fit: a quarter of what `rival.py` takes to be sure of the optimum, in its favour.
STARTS = 10


def measured(command):
    """Wall seconds, processor seconds and peak memory in MB of one process."""
    began = time.monotonic()
    process = subprocess.Popen(command)
    _, status, usage = os.wait4(process.pid, 0)
    if status:
        sys.exit(f"{command} ended with status {os.waitstatus_to_exitcode(status)}")
    return time.monotonic() - began, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def rows_of(campaign):
    return sum(log.read_bytes().count(b"\n") - 1 for log in campaign.glob("*.csv"))


def identify(campaign):
    # Not above: a process counts as its own what its parent held when it was started.
    import rival

    rival.STARTS = STARTS
    sys.argv = ["rival.py", str(campaign)]
    with contextlib.redirect_stdout(io.StringIO()):
        rival.main()
    used = resource.getrusage(resource.RUSAGE_SELF)
    return os.getpid(), used.ru_utime + used.ru_stime, used.ru_maxrss / 1024


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--campaigns", type=int, default=100)
    arguments.add_argument("--rows", type=int, default=200_000)
    arguments.add_argument("--runs", type=int, default=3)
    arguments.add_argument("--binary", default="target/release/tautline")
    a = arguments.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        probe = fleet.record(scratch / "probe", 1, a.binary, 1, ["--rate-hz", "100", *PROTOCOL])
        rate_hz = round(100 * a.rows / rows_of(probe / "joint-000" / "session-000"), 1)
        began = time.monotonic()
        campaigns = fleet.record(scratch / "fleet", a.campaigns, a.binary, 20, ["--rate-hz", str(rate_hz), *PROTOCOL])
        folders = sorted(path.parent for path in campaigns.glob("**/campaign.toml"))
        print(f"{a.campaigns} campaigns of {rows_of(folders[0]):,} rows, recorded in {time.monotonic() - began:.0f} s")
        seconds, busy, memory_mb = {}, {}, {}
        for threads in (1, 2):
            times = []
            for run in range(a.runs):
                out = scratch / f"{threads}-{run}"
                command = [a.binary, "batch", str(campaigns), "-o", str(out), "--threads", str(threads), "--quiet"]
                took_s, busy[threads], memory_mb[threads] = measured(command)
                times.append(took_s)
            seconds[threads] = statistics.median(times)
            print(f"tautline, {threads} thread{'s'[:threads - 1]}: {seconds[threads]:.1f} s, {a.campaigns / seconds[threads]:.2f} campaigns/s, "
                  f"processor {busy[threads]:.1f} s, peak {memory_mb[threads]:.0f} MB")
        again_s, _, _ = measured([a.binary, "batch", str(campaigns), "-o", str(scratch / "2-0"), "--quiet"])
        print(f"scaling from 1 thread to 2: {seconds[1] / seconds[2]:.2f}; with all results there: {again_s:.1f} s")
        if fleet.table(scratch / "1-0") != fleet.table(scratch / "2-0"):
            sys.exit("the tables of 1 and 2 threads differ")
        os.environ["POLARS_MAX_THREADS"] = "1"
        for processes in (1, 2):
            began = time.monotonic()
            with multiprocessing.get_context("spawn").Pool(processes) as pool:
                used = pool.map(identify, folders, chunksize=1)
            took_s = time.monotonic() - began
            # A process' use grows over its campaigns.
            busy_s = sum(max(busy_s for other, busy_s, _ in used if other == pid) for pid in {pid for pid, _, _ in used})
            print(f"SciPy, {processes} process{'es' * (processes - 1)}: {took_s:.1f} s, {a.campaigns / took_s:.2f} campaigns/s, "
                  f"processor {busy_s:.1f} s, peak {max(mb for _, _, mb in used):.0f} MB each; tautline is {took_s / seconds[processes]:.1f} times as "
                  f"fast, with {busy_s / busy[processes]:.1f} times less processor time")


if __name__ == "__main__":
    main()
