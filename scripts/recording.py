#!/usr/bin/env python3
"""Plays the terminal recording of the guide's page `start` and holds what it prints against the page.

usage: scripts/recording.py [--binary target/release/tautline] [--write]

```console blocks hold commands behind `$ ` and all that they print. They run one after the other in an empty folder that holds
`data`, as in a shell of 100 columns without colours. --write puts what was printed into the page. Exit status 1 where it differs.
(Standard library only.)
"""
import argparse
import difflib
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGE = ROOT / "src/guide/start.md"


def played(page, run):
    """The page with what its commands print now; `...` ends what is shown of a long answer."""
    lines, out, at = page.splitlines(), [], 0
    while at < len(lines):
        out.append(lines[at])
        at += 1
        if out[-1] != "```console":
            continue
        while lines[at] != "```":
            command = lines[at]
            assert command.startswith("$ "), command
            at += 1
            shown = []
            while lines[at] != "```" and not lines[at].startswith("$ "):
                shown.append(lines[at])
                at += 1
            answer = run(command[2:]).rstrip("\n").splitlines()
            if shown and shown[-1] == "..." and len(answer) >= len(shown):
                answer = answer[: len(shown) - 1] + ["..."]
            out += [command, *(line.rstrip() for line in answer)]
    return "\n".join(out) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--binary", type=pathlib.Path, default=ROOT / "target/release/tautline")
    parser.add_argument("--write", action="store_true")
    a = parser.parse_args()
    binary = a.binary.resolve()
    with tempfile.TemporaryDirectory() as scratch:
        shutil.copytree(ROOT / "data", f"{scratch}/data")
        (pathlib.Path(scratch) / "bin").mkdir()
        os.symlink(binary, f"{scratch}/bin/tautline")
        environment = {**os.environ, "PATH": f"{scratch}/bin:{os.environ['PATH']}", "COLUMNS": "100", "NO_COLOR": "1"}

        def run(command):
            done = subprocess.run(["bash", "-c", command], cwd=scratch, env=environment, text=True, stdin=subprocess.DEVNULL,
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
            return done.stdout

        page = PAGE.read_text()
        now = played(page, run)
    if a.write:
        PAGE.write_text(now)
    elif now != page:
        sys.stdout.writelines(difflib.unified_diff(page.splitlines(True), now.splitlines(True), str(PAGE), "as printed now"))
        sys.exit(1)
    print(f"{PAGE.relative_to(ROOT)}: {now.count(chr(10) + '$ ')} commands print what the page shows")


if __name__ == "__main__":
    main()
