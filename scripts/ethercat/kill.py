#!/usr/bin/env python3
"""Kills a capture in real time at random moments (kill -9). Every recording must open, and at most 0.1 s may be lost.

    scripts/ethercat/kill.py --binary target/release/tautline [--times 50] [--seed 1]
"""

import argparse
import random
import subprocess
import tempfile
import time
from pathlib import Path

from campaign import rows, trials

ROOT = Path(__file__).resolve().parents[2]
# Short motions one after the other, so that kills fall into all there is: rests, moves, beginnings and ends of trials. Slow
# ones, because an ordinary machine oversleeps, and a drive that gets no target stops: neither is what is tried here.
PLAN = """format = "plan/1"
rest_s = 0.2
repeats = 20
[[motions]]
trajectory = "short.toml"
"""
MOTION = """format = "trajectory/1"
start_rad = 0.0
segments = [
    { kind = "sweep", to_rad = 0.1, speed_rad_s = 0.1 },
    { kind = "rest", duration_s = 0.2 },
    { kind = "sweep", to_rad = 0.0, speed_rad_s = 0.1 },
]
"""
LOST_S = 0.1
# A recording shorter than this can be used for nothing, s.
SHORT_S = 1.0


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--binary", default=ROOT / "target/release/tautline", type=Path)
    parser.add_argument("--reader", type=Path, help="the binary that opens the recordings, if another")
    parser.add_argument("--times", default=50, type=int)
    parser.add_argument("--seed", default=1, type=int)
    options = parser.parse_args()
    chance = random.Random(options.seed)
    scratch = tempfile.TemporaryDirectory()
    folder = Path(scratch.name)
    rig = (ROOT / "data/rigs/demo/rig.toml").read_text()
    # A gap of a tenth of the low-pass's period is as long as a log may have: a slower one lets longer stalls pass.
    rig = rig.replace("lowpass_hz = 5.0", "lowpass_hz = 2.0").replace("missed_cycles_max = 1 ", "missed_cycles_max = 49 ")
    rig = rig.replace("stale_cycles = 3", "stale_cycles = 1000")
    rig = rig.replace("torque_step_nm = 0.3", "torque_step_nm = 5.0").replace("torque_nm = 2.5", "torque_nm = 4.5")
    # Pulses of its clock that the drive lets go by without outputs.
    rig = rig.replace('mode = "csp"\n', 'mode = "csp"\nstartup = [{ index = 0x10F1, sub = 2, type = "u16", value = 100 }]\n')
    (folder / "rig.toml").write_text(rig)
    (folder / "plan.toml").write_text(PLAN)
    (folder / "short.toml").write_text(MOTION)
    losses, opened, in_trial, ended = [], 0, 0, 0
    for number in range(options.times):
        out = folder / f"capture_{number}"
        command = [options.binary, "capture", "--rig", folder / "rig.toml", "--plan", folder / "plan.toml", "-o", out]
        process = subprocess.Popen([*command, "--real-time", "--quiet"], stderr=subprocess.DEVNULL)
        # The first motion, which is not recorded, takes the first seconds.
        time.sleep(6.0 + 9.0 * chance.random())
        killed_s = time.time()
        process.kill()
        if process.wait() >= 0:
            # A machine that stalls for longer than the drive's watchdog ends the run before the kill.
            ended += 1
            continue
        listed = trials(out)
        if not listed:
            # On a busy machine the way to the first trial takes longer.
            ended += 1
            continue
        log = rows(out / listed[-1]["file"])
        began_s = float((out / "capture.log").read_text().split(" ", 1)[0])
        lasted_s = float(log[-1]["time_s"]) - float(log[0]["time_s"]) if log else 0.0
        whole = [trial for trial in listed if "incomplete" not in trial]
        assert all("incomplete" not in trial for trial in listed[:-1]), "only the last trial can be broken off"
        if "incomplete" in listed[-1] and log:
            in_trial += 1
            losses.append(killed_s - began_s - float(log[-1]["time_s"]))
        reader = [options.reader or options.binary, "predict", out, "--model", ROOT / "data/elbow/truth/model.json"]
        done = subprocess.run([*reader, "-o", folder / "read", "--force", "--quiet"], capture_output=True, text=True)
        if done.returncode == 0:
            opened += 1
        elif whole or lasted_s >= SHORT_S:
            raise SystemExit(f"{number}: {out} does not open: {done.stderr}")
    losses.sort()
    kills = options.times - ended
    print(f"{kills} kills ({ended} runs ended before, or had no trial yet): {opened} recordings open, {kills - opened} were too short for any use;")
    print(f"{in_trial} within a trial", end=", ")
    assert losses, "no kill fell into a trial"
    print(f"lost: median {losses[len(losses) // 2] * 1e3:.0f} ms, at most {losses[-1] * 1e3:.0f} ms")
    assert losses[-1] <= LOST_S, "more than 0.1 s was lost"


if __name__ == "__main__":
    main()
