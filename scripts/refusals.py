#!/usr/bin/env python3
"""How long a refusal takes: texts that no lab wrote, each at two sizes.

A file that is refused must not hold the program up: from a size to one four times as large, processor time may grow as the
file does (or stay), not as its square. Each figure is the median of --runs. Needs nothing beside Python.

    python3 scripts/refusals.py
"""

import argparse
import statistics
import sys
import tempfile
from pathlib import Path

from scale import COUNTS_S, ROOT, measured

GROWTH = 4
# Four times the file may take this many times as long; its square would take 16 times.
WORST = 10

HEAD = """format = "campaign/1"
[columns]
time = { name = "t", unit = "s" }
position = { name = "pos", unit = "deg" }
torque = { name = "trq", unit = "N m" }
"""
TRIAL = '[[trials]]\nfile = "a.csv"\nprotocol = "free"\n'
START = "t,pos,trq\n"

# A file of a campaign by its kind, of a size: its name, and what stands in it.
KINDS = {
    "unknown keys": lambda n: ("campaign.toml", "".join(f"c{at}=1\n" for at in range(n // 2)) + HEAD + TRIAL),
    "trials of no file": lambda n: ("campaign.toml", HEAD + "".join(TRIAL.replace("a.csv", f"{at}.csv") for at in range(n // 40))),
    "lists in lists": lambda n: ("campaign.toml", f"{HEAD}a = {'[' * n}{']' * n}\n{TRIAL}"),
    "a first line without end": lambda n: ("a.csv", "x" * (20 * n)),
    "names by the million": lambda n: ("a.csv", ",".join(f"c{at}" for at in range(n)) + "\n"),
    "NUL bytes": lambda n: ("a.csv", "\0" * (20 * n)),
    "a quote that stays open": lambda n: ("a.csv", START + "0,1,2\n" + '"' + "1,2,3\n" * n),
    "a word in each row": lambda n: ("a.csv", START + "".join(f"{at},x{at},1\n" for at in range(n))),
    "time that falls": lambda n: ("a.csv", START + "".join(f"{n - at},1,1\n" for at in range(n))),
}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--binary", default=ROOT / "target/release/tautline", type=Path)
    parser.add_argument("--size", type=int, default=100_000, help="rows, names or keys of the smaller file")
    parser.add_argument("--runs", type=int, default=3)
    arguments = parser.parse_args()
    slow = []
    print("file                        MB   processor s     MB   processor s   growth")
    for kind, content in KINDS.items():
        figures = []
        for size in (arguments.size, GROWTH * arguments.size):
            with tempfile.TemporaryDirectory() as folder:
                folder = Path(folder)
                (folder / "campaign.toml").write_text(HEAD + TRIAL)
                (folder / "a.csv").write_text(START + "".join(f"{at / 100},{at % 90},1\n" for at in range(500)))
                name, text = content(size)
                (folder / name).write_text(text)
                line = [arguments.binary, "validate", folder, "--quiet"]
                took_s = statistics.median(measured(line, status=2)[1] for _ in range(arguments.runs))
                figures += [len(text) / 1e6, took_s]
        # Less than that is mostly the start of the process.
        growth = figures[3] / max(figures[1], COUNTS_S)
        if growth > WORST:
            slow.append(kind)
        print(f"{kind:25s} {figures[0]:5.1f} {figures[1]:13.2f} {figures[2]:6.1f} {figures[3]:13.2f} {growth:8.1f}", flush=True)
    print(f"slower than the file grows: {', '.join(slow) or 'none'}")
    return 1 if slow else 0


if __name__ == "__main__":
    sys.exit(main())
