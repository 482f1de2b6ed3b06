#!/usr/bin/env python3
"""A part of the fault matrix over a pair of virtual Ethernet interfaces, in real time: the program with its raw socket at one end, the
software bus in another process at the other, which puts the fault in and watches the true joint.

    scripts/ethercat/fault_veth.py --binary target/release/tautline [--only frozen] [--times 3]

For each fault the joint must be stopped for a cause that fits, the torque be off within a second (or the last words say that it is not
shown to be), and the joint stay within 1.25 times its limit of speed. A machine that stalls ends runs before the fault strikes: such a
run is repeated up to `--times`, and then counted as spoiled, not as right. Exit status 1 if a fault was not stopped as it should be, or
if none struck. Needs no root, but user namespaces; where they are not allowed it reports that and ends with 0.
"""

import argparse
import json
import subprocess
import tempfile
import time
from pathlib import Path

from namespace import run_inside
from veth import ROOT, relaxed_rig, scheduled

# The fault, and the causes that fit it.
FAULTS = {
    "frozen-encoder": {"not_following", "speed_gap", "lag"},
    "frozen-inputs": {"drive_stale", "not_following"},
    "stale-sensor": {"sensor_stale"},
    "saturated-sensor": {"sensor_saturated"},
    "drive-fault:0x2310": {"drive_fault", "emergency"},
    "inhibit": {"drive_left"},
    "quick-stop": {"drive_quick_stop", "drive_left"},
    "internal-limit": {"internal_limit"},
    "encoder-jump:0.03": {"encoder_jump", "torque_step"},
    "cable-break": {"torque_step", "speed_gap"},
    "safe-op:0": {"device_state", "drive_fault", "working_counter"},
    "second-master": {"device_state", "working_counter"},
    "gone:0": {"missed_cycles", "working_counter", "device_state"},
    "unsent:200": {"missed_cycles", "device_state", "working_counter"},
}
# Limits of the rig that see a fault which those of an ordinary machine let pass. A stall makes larger steps of the torque, too: such a run
# ends before its fault and is repeated.
LIMITS = {"cable-break": [("torque_step_nm = 5.0", "torque_step_nm = 0.3")]}
# Where the joint is when it goes wrong, rad: a cable that breaks is seen by the load that it carried.
AT_RAD = {"cable-break": "0.8"}
PLAN = """format = "plan/1"
rest_s = 0.5
[[motions]]
protocol = "uniform"
speed_rad_s = 0.2
"""
# The rig's limit of speed, rad/s, and the share above it that is allowed to be measured.
SPEED_RAD_S, ROOM = 1.5, 1.25
OFF_MS = 1000.0


def run(options: argparse.Namespace, fault: str) -> tuple[dict, dict, int]:
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        rig = relaxed_rig()
        for before, after in LIMITS.get(fault, []):
            assert before in rig
            rig = rig.replace(before, after)
        (folder / "rig.toml").write_text(rig)
        (folder / "plan.toml").write_text(PLAN)
        emulate = [*scheduled(), options.binary, "rig", "emulate", "--interface", "ec1", "--fault", fault]
        emulate += ["--at-rad", AT_RAD.get(fault, "0.3")]
        emulator = subprocess.Popen([*emulate, "--report", folder / "report.json"])
        try:
            time.sleep(0.5)
            command = [options.binary, "capture", "--rig", folder / "rig.toml", "--plan", folder / "plan.toml"]
            command += ["-o", folder / "out", "--arm", "--json"]
            done = subprocess.run(command, input="arm\n", capture_output=True, text=True)
            time.sleep(0.3)
        finally:
            emulator.kill()
            emulator.wait()
        if done.returncode == 2:
            return {}, {}, 2
        report = folder / "report.json"
        return json.loads(done.stdout), json.loads(report.read_text()) if report.exists() else {}, done.returncode


def judged(fault: str, outcome: dict, report: dict, status: int) -> str:
    cause = (outcome.get("stopped_by") or {}).get("name")
    if cause not in FAULTS[fault]:
        return f"stopped by {cause}"
    if not report:
        return "" if status == 3 and outcome.get("torque_warning") else "torque on, and not told"
    if report["off_ms"] > OFF_MS:
        return "torque on for too long"
    return "" if report["speed_rad_s"] <= ROOM * SPEED_RAD_S else "too fast"


def inside(options: argparse.Namespace) -> None:
    wrong = spoiled = 0
    print("| fault | torque off after, ms | largest speed, rad/s | travel, rad | cause | last words |")
    print("|---|---|---|---|---|---|")
    for fault in (fault for fault in FAULTS if options.only in fault):
        for attempt in range(options.times):
            outcome, report, status = run(options, fault)
            # Without a report the fault did not strike, or the drive has torque still, which must then have been told.
            has_struck = bool(report or outcome.get("torque_warning"))
            if has_struck or attempt + 1 == options.times:
                break
        why = judged(fault, outcome, report, status) if has_struck else ""
        cause = (outcome.get("stopped_by") or {}).get("name", "did not start")
        if not has_struck:
            print(f"| {fault} | | | | spoiled by the machine: {cause} | |", flush=True)
            spoiled += 1
            continue
        told = "TORQUE IS NOT SHOWN TO BE OFF" if outcome.get("torque_warning") else ""
        numbers = [f"{report[key]:.3f}" if key in report else "" for key in ("off_ms", "speed_rad_s", "travel_rad")]
        print(f"| {fault} | {' | '.join(numbers)} | {cause}{' **' + why + '**' if why else ''} | {told} |", flush=True)
        wrong += bool(why)
    print(f"{wrong} faults were not stopped as they should be, {spoiled} runs were spoiled by stalls of the machine")
    raise SystemExit(wrong > 0 or spoiled == sum(options.only in fault for fault in FAULTS))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--binary", default=ROOT / "target/release/tautline", type=Path)
    parser.add_argument("--only", default="", help="only faults whose name contains this")
    parser.add_argument("--times", default=3, type=int, help="runs of a fault that a stall of the machine may spoil")
    options = parser.parse_args()
    run_inside(lambda: inside(options))


if __name__ == "__main__":
    main()
