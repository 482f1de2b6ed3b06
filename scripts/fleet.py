#!/usr/bin/env python3
"""A fleet of simulated campaigns, and what `batch` makes of it: shared by batch_kill.py, batch_dask.py and batch_bench.py.

usage: scripts/fleet.py OUT [--campaigns 60] [--joints 20] [--binary target/release/tautline]
"""
import argparse
import concurrent.futures
import csv
import json
import os
import pathlib
import subprocess
import tempfile

TRUTH = "data/elbow/truth/model.json"
SMALL = ["--rate-hz", "50", "--speeds", "8", "--repeats", "1", "--cosines", "1", "--slowest-rad-s", "0.05"]


def record(folder, campaigns, binary, joints=20, protocol=SMALL):
    """Records `campaigns` campaigns of `joints` joints, differing in noise; every seventh joint's last ones on slacker cables."""
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    truth = json.load(open(TRUTH))
    with tempfile.TemporaryDirectory() as scratch:
        def one(number):
            joint, session = number % joints, number // joints
            model = json.loads(json.dumps(truth))
            model["joint"]["name"] = f"joint-{joint:03}"
            if joint % 7 == 0 and session > 0:
                model["friction"]["up"]["a_j"] *= 0.8
            file = f"{scratch}/{number}.json"
            json.dump(model, open(file, "w"))
            out = folder / f"joint-{joint:03}" / f"session-{session:03}"
            command = [binary, "simulate", "--model", file, "-o", str(out), "--seed", str(number + 1), "--quiet", *protocol]
            subprocess.run(command, check=True, env={**os.environ, "RAYON_NUM_THREADS": "1"})
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            list(pool.map(one, range(campaigns)))
    return folder


def table(out):
    """The rows of a batch's table by name, without how long each took; no campaign may be there twice."""
    rows = list(csv.DictReader(open(pathlib.Path(out) / "fleet" / "table.csv", newline="")))
    by_name = {row["name"]: {key: value for key, value in row.items() if key != "duration_s"} for row in rows}
    assert len(by_name) == len(rows), "a campaign is counted twice"
    return by_name


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("out")
    arguments.add_argument("--campaigns", type=int, default=60)
    arguments.add_argument("--joints", type=int, default=20)
    arguments.add_argument("--binary", default="target/release/tautline")
    a = arguments.parse_args()
    record(a.out, a.campaigns, a.binary, a.joints)


if __name__ == "__main__":
    main()
