#!/usr/bin/env python3
"""Captures the whole published protocol from the software bus in virtual time (20 speeds three times, three cosine cascades),
identifies it, and compares what was identified with the truth of the simulated joint.

    scripts/ethercat/paper.py --binary target/release/tautline [--keep FOLDER]
"""

import argparse
import json
import subprocess
import tempfile
import time
from pathlib import Path

from campaign import accounted, trials

ROOT = Path(__file__).resolve().parents[2]


def within(low, value, high) -> bool:
    return (low is None or value >= low) and (high is None or value <= high)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--binary", default=ROOT / "target/release/tautline", type=Path)
    parser.add_argument("--identify", type=Path, help="the binary that identifies, if another")
    parser.add_argument("--plan", default=ROOT / "data/rigs/paper.toml", type=Path)
    parser.add_argument("--keep", type=Path, help="a new folder for campaign and model")
    options = parser.parse_args()
    scratch = tempfile.TemporaryDirectory()
    out = options.keep or Path(scratch.name)
    out.mkdir(parents=True, exist_ok=True)
    campaign, found = out / "campaign", out / "identified"

    began = time.monotonic()
    capture = [options.binary, "capture", "--rig", "demo", "--plan", options.plan, "-o", campaign, "--json"]
    outcome = json.loads(subprocess.run(capture, check=True, capture_output=True, text=True).stdout)
    took = time.monotonic() - began
    planned = outcome["trials"]
    assert outcome["complete"] == planned and outcome["stopped_by"] is None, outcome
    samples, late, missed = accounted(campaign)
    print(f"{planned} trials, {samples} samples of {outcome['cycles']} cycles in {took:.0f} s; {late} late, {missed} missed")
    assert missed == 0 and all("incomplete" not in trial for trial in trials(campaign)), "samples were lost"

    identify = [options.identify or options.binary, "identify", campaign, "-o", found, "--quiet"]
    subprocess.run(identify, check=True)
    model = json.loads((found / "model.json").read_text())
    truth = json.loads((ROOT / "data/elbow/truth/model.json").read_text())
    wrong, asked = [], 0
    for name, interval in model["confidence"].items():
        value = truth
        for key in name.split("."):
            value = value.get(key) if isinstance(value, dict) else None
        if not isinstance(value, (int, float)) or interval["status"] != "pinned":
            continue
        asked += 1
        print(f"  {name:24} true {value:<9.5g} within {interval['low']} to {interval['high']}")
        if not within(interval["low"], value, interval["high"]):
            wrong.append(name)
    # 95 % intervals: of a dozen one may miss.
    print(f"{asked - len(wrong)} of {asked} pinned parameters hold the truth{': not ' + ', '.join(wrong) if wrong else ''}")
    assert len(wrong) <= max(1, asked // 8), wrong


if __name__ == "__main__":
    main()
