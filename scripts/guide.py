#!/usr/bin/env python3
"""Runs every command of the README and the guide as written, one after the other, on the bundled data.

usage: scripts/guide.py [--binary target/release/tautline] [--list]

Commands stand in ```sh blocks of the guide and in indented blocks of the README. Names that a reader would fill in (my-campaign,
before, fleet, ...) are made first, small. Left out, and listed: what needs a bus, a cluster, a recorder or a diagnosis that
proposes a motion, and cargo and pip; what plays MuJoCo where it is not installed.
An output folder that an earlier command wrote is set aside first. Exit status 1 if a command fails. (Standard library only.)
"""
import argparse
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGES = ("identify", "campaign", "evaluate", "diagnose", "gallery", "changes", "simulate", "simulators", "capture", "model", "measured", "security")
NEED_MORE = ("cargo ", "pip ", "sbatch ", "recorder ", "tautline rig ", "--rig rig.toml", "tautline import", "tautline excite next", "tautline completions", "tautline man")
try:
    import mujoco  # noqa: F401
except ImportError:
    NEED_MORE += ("record.py", "diagnose real", "diagnose again", "gap/model.json")
SMALL = "--rate-hz 50 --speeds 6 --slowest-rad-s 0.05 --repeats 1 --cosines 1 --quiet"


def commands():
    """(page, command) in the order in which they are read."""
    for line in (ROOT / "README.md").read_text().splitlines():
        if line.startswith("    ") and line.strip().startswith("tautline"):
            yield "README", line.strip()
    for page in PAGES:
        inside = False
        for line in (ROOT / f"src/guide/{page}.md").read_text().splitlines():
            if line.startswith("```"):
                inside = line == "```sh"
            elif inside and line.strip():
                yield page, line.strip()


def fixtures(run):
    """What a reader would have: campaigns, models, lists."""
    truth = "data/elbow/truth/model.json"
    run(f"tautline simulate --model {truth} -o my-campaign {SMALL}")
    for seed in (1, 2, 3):
        run(f"tautline simulate --model {truth} -o fleet/elbow-1/2026-0{seed} {SMALL} --seed {seed}")
    run("tautline identify fleet/elbow-1/2026-01 -o before --quiet && tautline identify fleet/elbow-1/2026-02 -o after --quiet")
    run("tautline identify my-campaign -o out --quiet")
    listed = "".join(f'[[campaigns]]\npath = "fleet/elbow-1/2026-0{seed}"\n' for seed in (1, 2, 3))
    for name in ("fleet.toml", "runs.toml"):
        pathlib.Path(name).write_text(f'format = "batch/1"\n{listed}')
    pathlib.Path("rig.toml").write_text("[limits]\nlow_rad = 0.0\nhigh_rad = 1.75\nspeed_rad_s = 2.0\nacceleration_rad_s2 = 20.0\n")


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--binary", type=pathlib.Path, default=ROOT / "target/release/tautline")
    arguments.add_argument("--list", action="store_true")
    a = arguments.parse_args()
    if a.list:
        print("\n".join(f"{page:10} {command}" for page, command in commands()))
        return
    binary = a.binary.resolve()
    with tempfile.TemporaryDirectory() as scratch:
        os.chdir(scratch)
        shutil.copytree(ROOT / "data", "data")
        pathlib.Path("bin").mkdir()
        os.symlink(binary, "bin/tautline")
        environment = {**os.environ, "PATH": f"{scratch}/bin:{os.environ['PATH']}", "PYTHONPATH": str(ROOT / "src/python"), "TAUTLINE": str(binary)}
        run = lambda command: subprocess.run(["bash", "-c", command], env=environment, capture_output=True, text=True)
        fixtures(lambda command: run(command).check_returncode())
        failed, left_out = 0, []
        for page, command in commands():
            if any(part in command for part in NEED_MORE):
                left_out.append(command)
                continue
            words = command.split("#")[0].split()
            if "-o" in words:
                out = pathlib.Path(words[words.index("-o") + 1])
                # A batch goes on in its own folder.
                if "batch" not in words or not (out / "campaigns").is_dir():
                    shutil.rmtree(out, ignore_errors=True)
            done = run(command)
            failed += done.returncode != 0
            print(f"{'ok' if done.returncode == 0 else 'FAILED':7}{page:10} {command}")
            if done.returncode != 0:
                print(done.stderr, file=sys.stderr)
    print(f"\nleft out: {len(left_out)}", *left_out, sep="\n  ")
    sys.exit(failed > 0)


if __name__ == "__main__":
    main()
