#!/usr/bin/env python3
"""A batch over machines, here two Dask workers on loopback, one of which is killed halfway: nothing lost, nothing twice.

usage: scripts/batch_dask.py [--campaigns 200] [--parts 40] [--no-kill] [--binary target/release/tautline]

Needs `dask` and `distributed`. The program is the task (`batch --shard K/N`); Dask places the parts, tries again what a lost
worker held, and collects. On a cluster only the client's address differs, and the folders lie on a shared file system.
"""
import argparse
import os
import pathlib
import subprocess
import sys
import tempfile
import time

from distributed import Client, as_completed

import fleet

SCHEDULER = "import sys; from distributed.cli.dask_scheduler import main; sys.exit(main())"
WORKER = "import sys; from distributed.cli.dask_worker import main; sys.exit(main())"


def part(binary, campaigns, out, k, n):
    """One part, on whatever machine this runs. Status 1 says that a campaign failed: its reason stands in the table."""
    command = [binary, "batch", campaigns, "-o", out, "--shard", f"{k}/{n}", "--threads", "1", "--quiet"]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode not in (0, 1):
        raise RuntimeError(done.stderr)
    return k


def start(script, *arguments):
    return subprocess.Popen([sys.executable, "-c", script, *arguments], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                            start_new_session=True)


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--campaigns", type=int, default=200)
    arguments.add_argument("--parts", type=int, default=40)
    arguments.add_argument("--kill", action=argparse.BooleanOptionalAction, default=True)
    arguments.add_argument("--binary", default="target/release/tautline")
    a = arguments.parse_args()
    binary = str(pathlib.Path(a.binary).resolve())
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        campaigns = fleet.record(scratch / "fleet", a.campaigns, binary)
        (campaigns / "joint-001" / "session-000" / "campaign.toml").write_text("format = \"campaign/1\"\n")
        began = time.monotonic()
        process = subprocess.Popen([binary, "batch", str(campaigns), "-o", str(scratch / "local"), "--quiet"])
        usage = os.wait4(process.pid, 0)[2]
        local_s = time.monotonic() - began

        address = scratch / "scheduler.json"
        running = [start(SCHEDULER, "--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--scheduler-file", str(address))]
        try:
            workers = [start(WORKER, "--scheduler-file", str(address), "--nthreads", "1", "--no-nanny", "--no-dashboard",
                             "--host", "127.0.0.1", "--local-directory", str(scratch)) for _ in range(2)]
            running += workers
            with Client(scheduler_file=str(address), timeout=60) as client:
                client.wait_for_workers(2, timeout=60)
                out = str(scratch / "spread")
                began = time.monotonic()
                tasks = [client.submit(part, binary, str(campaigns), out, k, a.parts, pure=False, retries=3)
                         for k in range(1, a.parts + 1)]
                collected = []
                for task in as_completed(tasks):
                    collected.append(task.result())
                    if a.kill and len(collected) == a.parts // 2:
                        workers[0].kill()
                        # What is left of its part may still be at work: a result is one file, whoever writes it.
                        print(f"killed one worker after {len(collected)} of {a.parts} parts")
                spread_s = time.monotonic() - began
        finally:
            for process in running:
                if process.poll() is None:
                    process.terminate()
                process.wait()
        assert sorted(collected) == list(range(1, a.parts + 1)), "a part is lost, or counted twice"
        results = len(list(pathlib.Path(out).glob("campaigns/*.json")))
        subprocess.run([binary, "batch", str(campaigns), "-o", out, "--quiet"])
        spread, local = fleet.table(out), fleet.table(scratch / "local")
        assert results == a.campaigns == len(spread), f"{results} results of {a.campaigns}"
        failed = sum(row["status"] == "failed" for row in spread.values())
        assert failed == 1, f"{failed} failed, and one was made to"
        assert spread == local, "the tables differ"
    # Processor time, which other work on the machine does not change.
    each_ms = 1e3 * (usage.ru_utime + usage.ru_stime) / a.campaigns
    print(f"{a.campaigns} campaigns: all there once, equal to the local run's; one failed, as it was made to")
    print(f"local, {os.cpu_count()} cores: {local_s:.1f} s; Dask, two workers{' and one of them killed' if a.kill else ''}: {spread_s:.1f} s")
    print(f"a campaign costs {each_ms:.0f} ms of processor time; extrapolated, 100,000 such take {100_000 * each_ms / 3.6e6:.2f} core-hours")


if __name__ == "__main__":
    main()
