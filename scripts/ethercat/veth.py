#!/usr/bin/env python3
"""Captures for five minutes (or --minutes) at 1 kHz over a pair of virtual Ethernet interfaces, in a network namespace of its own: the
program with its raw socket at one end, the software bus in another process at the other. Every cycle must be accounted for.

    scripts/ethercat/veth.py --binary target/release/tautline [--short | --minutes 10]

Needs no root, but user namespaces; where they are not allowed it says so and ends with 0.
"""

import argparse
import json
import subprocess
import tempfile
import time
from pathlib import Path

from campaign import accounted
from namespace import run_inside

ROOT = Path(__file__).resolve().parents[2]
# Slow motions: a drive that gets no target stops, and starts again at full speed.
LONG = """format = "plan/1"
rest_s = 0.5
[[motions]]
protocol = "uniform"
speed_rad_s = 0.03
repeats = {repeats}
"""
# One sweep of LONG, s.
SWEEP_S = 100.0
SHORT = """format = "plan/1"
rest_s = 0.5
[[motions]]
protocol = "uniform"
speed_rad_s = 0.2
"""


def inside(options: argparse.Namespace) -> None:
    emulator = subprocess.Popen([*scheduled(), options.binary, "rig", "emulate", "--interface", "ec1"])
    try:
        time.sleep(0.5)
        with tempfile.TemporaryDirectory() as scratch:
            capture(options, Path(scratch))
    finally:
        emulator.kill()


def relaxed_rig() -> str:
    """The demo's rig on the interface `ec0`, with the limits of an ordinary machine, which sleeps through many cycles; a rig on a
    real-time kernel keeps those of the demo's."""
    rig = (ROOT / "data/rigs/demo/rig.toml").read_text()
    for before, after in [
        ('interface = "demo"', 'interface = "ec0"'),
        ("missed_cycles_max = 1 ", "watchdog_ms = 200\nmissed_cycles_max = 90 "),
        ("lowpass_hz = 5.0", "lowpass_hz = 1.0"),
        ("stale_cycles = 3", "stale_cycles = 100"),
        ("torque_step_nm = 0.3", "torque_step_nm = 5.0"),
        ("lag_rad = 0.05", "lag_rad = 0.2"),
        ("following_error_rad = 0.05", "following_error_rad = 0.2"),
        ("\ntorque_nm = 2.5", "\ntorque_nm = 4.5"),
        ("torque_max_nm = 2.0", "torque_max_nm = 4.0"),
    ]:
        assert before in rig
        rig = rig.replace(before, after)
    return rig


def scheduled() -> list[str]:
    """Real-time scheduling for the emulator, as the program asks for it by itself, where there is a right to it: one end that stalls
    spoils what the other measures."""
    real_time = ["chrt", "--fifo", "60"]
    try:
        allowed = subprocess.run([*real_time, "true"], capture_output=True).returncode == 0
    except FileNotFoundError:
        allowed = False
    return real_time if allowed else []


def capture(options: argparse.Namespace, folder: Path) -> None:
    (folder / "rig.toml").write_text(relaxed_rig())
    repeats = max(1, round(options.minutes * 60 / SWEEP_S))
    (folder / "plan.toml").write_text(SHORT if options.short else LONG.format(repeats=repeats))
    command = [options.binary, "capture", "--rig", folder / "rig.toml", "--plan", folder / "plan.toml"]
    command += ["-o", folder / "out", "--arm", "--json"]
    began = time.monotonic()
    done = subprocess.run(command, input="arm\n", capture_output=True, text=True)
    took = time.monotonic() - began
    if done.returncode == 2:
        raise SystemExit(done.stderr)
    outcome = json.loads(done.stdout)
    for line in outcome["report"]:
        print(f"  {line}")
    samples, late, missed = accounted(folder / "out")
    print(f"{outcome['complete']} of {outcome['trials']} trials in {took:.0f} s; {outcome['cycles']} cycles, of all of them")
    print(f"{outcome['late_cycles']} late, {outcome['missed_cycles']} missed; in trials {samples} recorded, {late} late, {missed} missed")
    if outcome["stopped_by"]:
        # A machine that stalls for longer than the drive's watchdog ends the run, as it should.
        print(f"stopped: {outcome['stopped_by']['what']}")
        raise SystemExit(0 if options.allow_stop else 1)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--binary", default=ROOT / "target/release/tautline", type=Path)
    parser.add_argument("--short", action="store_true", help="one sweep of 9 s")
    parser.add_argument("--minutes", type=float, default=5.0, help="how long it goes on, without --short")
    parser.add_argument("--allow-stop", action="store_true", help="a stall of the machine that stops the drive is no failure")
    options = parser.parse_args()
    run_inside(lambda: inside(options))


if __name__ == "__main__":
    main()
