#!/usr/bin/env python3
"""What `tautline compare` says of real devices recorded before and after a known change.

usage: scripts/real/compare.py FOLDER [--binary PATH] [--need N]

FOLDER holds cases that the scripts beside this one wrote: CASE/model.json is identified from recordings before the change,
CASE/campaign recorded after it, and identified here in the same way. Right is a change named as `KNOWN` has it, alone or among rivals that are
said to be as likely; "not known" is told where an interval of A or B(v) is open. Exit status 1 where fewer than --need are named
rightly, or any other change is named alone. (Standard library only.)
"""
import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

KNOWN = {  # case: what was done, and the names that tell it
    "dvrk_yaw_205g_insertion": ("205 g added, seen at the yaw joint", {"gravity_or_spring"}),
    "dvrk_yaw_205g_parallel": ("205 g added, mounted otherwise, yaw", {"gravity_or_spring"}),
    "dvrk_pitch_205g_insertion": ("205 g added, pitch", {"gravity_or_spring"}),
    "dvrk_pitch_105g_insertion": ("105 g added, pitch", {"gravity_or_spring"}),
    "mis_tool_other_tool": ("another specimen: loop 90 to 60 mN m by regression", {"coulomb_friction"}),
}


def compared(case, binary):
    """The comparison of what was identified before and after."""
    before = json.loads((case / "model.json").read_text())
    same = ["--estimate-backlash"] if "joint.backlash_m" in before["confidence"] else []
    with tempfile.TemporaryDirectory() as scratch:
        run = lambda *words: subprocess.run([str(w) for w in (binary, *words)], check=True, capture_output=True, text=True).stdout
        run("identify", case / "campaign", "-o", f"{scratch}/out", "--quiet", *same)
        return json.loads(run("compare", case / "model.json", f"{scratch}/out/model.json", "--json"))


def told(cause):
    where = f" moving {cause['direction']}" if cause["direction"] else ""
    if cause["relative"] is None:
        return cause["what"] + where
    # Friction moving down is negative at the sensor: less of it is a change upwards.
    sign = -1 if cause["direction"] == "down" and cause["change_nm"] is not None else 1
    low, high = sorted(100 * sign * cause[end] for end in ("relative_low", "relative_high"))
    size = f" {100 * sign * cause['relative']:+.0f} % [{low:.0f}, {high:.0f}]"
    return f"{cause['what']}{where}{size}"


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("folder", type=pathlib.Path)
    arguments.add_argument("--binary", default="target/release/tautline")
    arguments.add_argument("--need", type=int, default=0)
    a = arguments.parse_args()
    right = wrong = 0
    print("| case | done | `compare` | |\n|---|---|---|---|")
    for name, (done, names) in KNOWN.items():
        if not (a.folder / name / "model.json").exists():
            print(f"| {name} | {done} | not in the folder | |")
            continue
        found = compared(a.folder / name, a.binary)
        causes = found["what_changed"]
        said = [{c["what"], *(rival["what"] for rival in c["or"])} for c in causes]
        is_open = found["prediction"]["explained_by_intervals_nm"] is None
        is_right = any(of & names for of in said)
        verdict = "right" if is_right else "wrong" if causes else "not known" if is_open else "missed"
        right, wrong = right + is_right, wrong + (verdict in ("wrong", "missed"))
        width = [f for f in found["functions"] if f["function"] == "hysteresis_width"]
        loop = f"; loop {1e3 * width[-1]['before']:.0f} to {1e3 * width[-1]['after']:.0f} mN m" if width else ""
        print(f"| {name} | {done} | {'; '.join(map(told, causes)) or 'an interval of A or B(v) is open'}{loop} | {verdict} |")
    print(f"{right} right, {wrong} wrong")
    sys.exit(right < a.need or wrong > 0)


if __name__ == "__main__":
    main()
