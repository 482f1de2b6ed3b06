#!/usr/bin/env python3
"""How a command scales: its processor time and peak memory over campaigns of growing size.

Simulates campaigns of the bundled elbow (the protocol at a higher rate, more repeats of it, or one long trial of free
motion), runs the command on each, and prints a table. Linear means: from one size to the next the processor time per row
grows by no more than the factor LINEAR. Needs nothing beside Python; 40 million rows take 1.1 GB on disk.

    python3 scripts/scale.py                                   0.4, 4 and 40 million rows: 100 Hz, 1 kHz, 10 kHz in 63 trials
    python3 scripts/scale.py --shape trials --sizes 0.4 4      one rate, more repeats
    python3 scripts/scale.py --shape one --command validate    one trial of free motion
    python3 scripts/scale.py --baseline OLD                    and by another binary beside it
"""

import argparse
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).parent.parent
MODEL = ROOT / "data/elbow/truth/model.json"
# Processor time per row may grow by this factor from one size to the next: caches and page faults, not algorithms.
LINEAR = 1.5
# A run shorter than this, s, is mostly the start of the process, and is not compared.
COUNTS_S = 0.2
# Rows of the default protocol (63 trials) at 1 Hz.
ROWS_PER_HZ = 3990
# Length of the one long trial, s.
LONG_S = 4000

LONG = f"""format = "trajectory/1"
name = "long"
start_rad = 0.7
[[segments]]
kind = "multisine"
duration_s = {LONG_S}.0
fade_s = 5.0
waves = [
  {{ amplitude_rad = 0.2, frequency_hz = 0.05 }},
  {{ amplitude_rad = 0.1, frequency_hz = 0.13, phase_rad = 1.0 }},
  {{ amplitude_rad = 0.05, frequency_hz = 0.31, phase_rad = 2.0 }},
]
"""


def simulation(shape, rows, folder):
    """Arguments of `simulate` for a campaign of about so many rows."""
    if shape == "rate":
        return ["--rate-hz", f"{rows / ROWS_PER_HZ:.0f}"]
    if shape == "trials":
        repeats = max(1, round(3 * rows / (1000 * ROWS_PER_HZ)))
        return ["--repeats", str(repeats), "--cosines", str(repeats)]
    trajectory = folder / "long.toml"
    trajectory.write_text(LONG)
    return ["--rate-hz", f"{rows / LONG_S:.0f}", "--repeats", "1", "--trajectory", str(trajectory)]


def counted(campaign):
    """Rows of all logs of a campaign."""
    rows = 0
    for log in campaign.glob("*.csv"):
        with log.open("rb") as stream:
            while block := stream.read(1 << 20):
                rows += block.count(b"\n")
        rows -= 1
    return rows


def measured(command, status=0):
    """Wall clock, s, processor time, s, and peak memory, MB, of a command that must end with this exit status."""
    began = time.monotonic()
    # In a process of its own: the kernel keeps the largest peak of all children so far.
    script = (
        "import resource, subprocess, sys; code = subprocess.call(sys.argv[1:], stdout=subprocess.DEVNULL);"
        "used = resource.getrusage(resource.RUSAGE_CHILDREN);"
        "print(used.ru_utime + used.ru_stime, used.ru_maxrss); sys.exit(code)"
    )
    done = subprocess.run([sys.executable, "-c", script, *map(str, command)], capture_output=True, text=True)
    if done.returncode != status:
        sys.exit(f"{' '.join(map(str, command))}: status {done.returncode}\n{done.stderr}")
    processor_s, peak_kb = done.stdout.split()
    return time.monotonic() - began, float(processor_s), float(peak_kb) / 1024


def run_of(command, binary, campaign, model, output):
    """The command line of one run."""
    line = [binary, command, campaign, "--quiet"]
    if command == "validate":
        return line
    line += ["-o", output, "--force"]
    return line if command == "identify" else [*line, "--model", model]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--tautline", default=ROOT / "target/release/tautline", type=Path)
    parser.add_argument("--baseline", type=Path, help="another binary to compare with")
    parser.add_argument("--command", default="identify", choices=["identify", "validate", "evaluate", "diagnose"])
    parser.add_argument("--shape", default="rate", choices=["rate", "trials", "one"])
    parser.add_argument("--sizes", nargs="+", type=float, default=[0.4, 4, 40], help="million rows")
    parser.add_argument("--keep", type=Path, help="folder in which campaigns are kept and found again")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = arguments.keep or Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        binaries = [b for b in (arguments.baseline, arguments.tautline) if b]
        print(f"{arguments.command}, shape `{arguments.shape}`")
        print("     rows   binary            wall s   processor s   us/row   peak MB   B/row")
        per_row = {}
        for size in arguments.sizes:
            campaign = folder / f"{arguments.shape}_{size:g}"
            if not campaign.exists():
                settings = simulation(arguments.shape, size * 1e6, folder)
                line = [arguments.tautline, "simulate", "--model", MODEL, "-o", campaign, "--quiet", *settings]
                subprocess.run(list(map(str, line)), check=True)
            rows = counted(campaign)
            for binary in binaries:
                line = run_of(arguments.command, binary, campaign, MODEL, folder / "result")
                wall_s, processor_s, peak_mb = measured(line)
                each_us, each_b = 1e6 * processor_s / rows, peak_mb * 2**20 / rows
                if processor_s > COUNTS_S:
                    per_row.setdefault(binary, []).append(each_us)
                print(
                    f"{rows:10d}   {binary.name:15s} {wall_s:8.1f} {processor_s:13.2f} {each_us:8.3f} {peak_mb:9.0f} {each_b:7.1f}",
                    flush=True,
                )
        ours = per_row.get(arguments.tautline, [])
        worst = max((b / a for a, b in zip(ours, ours[1:])), default=1.0)
        print(f"processor time per row grows by at most {worst:.2f} from size to size: "
              f"{'linear' if worst <= LINEAR else 'NOT linear'}")
        return 0 if worst <= LINEAR else 1


if __name__ == "__main__":
    sys.exit(main())
