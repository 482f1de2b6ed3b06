#!/usr/bin/env python3
"""How many blind verdicts are right when each threshold of the diagnosis is 20 % smaller or larger.

usage: scripts/blind/sensitivity.py --cases DIR --answers DIR2 [--cases DIR3 --answers DIR4 ...] [--binary PATH] [--only NAME,...]
                                    [--markdown FILE]

DIR and DIR2 are what a generator wrote (--out, --answers), DIR/case_NNN and DIR2/case_NNN.json. Names and defaults of the thresholds are
those that `tautline schema policy` prints. Two cases run at a time, each on one thread. Cases are called by the folder above DIR where there
are several sets.
"""
import argparse
import concurrent.futures
import json
import os
import pathlib
import subprocess
import sys
import tempfile

import score

FACTORS = (0.8, 1.2)
AT_A_TIME = 2


def thresholds(binary):
    """Name -> default of every threshold."""
    schema = json.loads(subprocess.run([binary, "schema", "policy"], capture_output=True, text=True, check=True).stdout)
    return {name: about["default"] for name, about in schema["properties"].items() if "default" in about}


def questions(pairs):
    """Of each case: (its name, its folder, its answer)."""
    asked = []
    for cases, answers in pairs:
        prefix = f"{cases.resolve().parent.name}/" if len(pairs) > 1 else ""
        for path in sorted(answers.glob("*.json")):
            answer = json.loads(path.read_text())
            asked.append((prefix + answer["case"], cases / answer["case"], answer))
    return asked


def verdicts(binary, asked, policy, scratch):
    """Case -> row of the score, decided by the lines of `policy`."""
    file = scratch / "policy.toml"
    file.write_text('format = "policy/1"\n' + policy)

    def one(question):
        name, case, answer = question
        with tempfile.TemporaryDirectory(dir=scratch) as out:
            return name, score.judge(answer, *score.run(binary, case, pathlib.Path(out) / "out", ("--policy", file)))

    with concurrent.futures.ThreadPoolExecutor(AT_A_TIME) as pool:
        return dict(pool.map(one, asked))


def told(row):
    return " ".join([row["verdict"], "+".join(row["named"])]).strip()


def compared(usual, rows):
    """Right verdicts, and each case whose verdict changed: name, before, after, and + where it became right, - where wrong."""
    changed = []
    for name, row in rows.items():
        before = usual[name]
        if (told(before), before["right"]) != (told(row), row["right"]):
            sign = {(False, True): "+", (True, False): "-"}.get((before["right"], row["right"]), "")
            changed.append(f"{sign}{name}: {told(before)} -> {told(row)}")
    return sum(row["right"] for row in rows.values()), changed


HEAD = f"{'threshold':30} {'value':>8}  {'x0.8':>5} {'x1.0':>5} {'x1.2':>5}  changed"


def line(name, value, right, changed):
    """The line of one threshold, and one for each case whose verdict changed."""
    first = f"{name:30} {value:8g}  {right[0.8]:5} {right[1.0]:5} {right[1.2]:5}  {sum(map(len, changed.values())) or '-'}"
    return "\n".join([first] + [f"{'':32}x{factor}  {case}" for factor in FACTORS for case in changed[factor]])


def markdown(found, cases):
    """The table of all thresholds."""
    lines = [f"Right verdicts of {cases} cases (code {score.commit()})", "", "| threshold | value | x 0.8 | x 1.0 | x 1.2 | cases that changed |"]
    lines.append("|---|---:|---:|---:|---:|---|")
    for name, value, right, changed in found:
        cells = [f"x {factor}: {'; '.join(changed[factor])}" for factor in FACTORS if changed[factor]]
        lines.append(f"| `{name}` | {value:g} | {right[0.8]} | {right[1.0]} | {right[1.2]} | {'<br>'.join(cells)} |")
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cases", type=pathlib.Path, action="append", required=True)
    parser.add_argument("--answers", type=pathlib.Path, action="append", required=True)
    parser.add_argument("--binary", default="target/release/tautline")
    parser.add_argument("--only", help="names of thresholds, with commas between them")
    parser.add_argument("--markdown", type=pathlib.Path, help="writes the table there too, after each threshold")
    args = parser.parse_args()
    if len(args.cases) != len(args.answers):
        sys.exit("each --cases needs its --answers")
    asked = questions(list(zip(args.cases, args.answers)))
    if not asked:
        sys.exit("no answers")
    if len({name for name, _, _ in asked}) < len(asked):
        sys.exit("two sets of cases have the same name: put them into folders of different names")
    known = thresholds(args.binary)
    names = args.only.split(",") if args.only else list(known)
    unknown = [name for name in names if name not in known]
    if unknown:
        sys.exit(f"no threshold {', '.join(unknown)}; there are {', '.join(known)}")
    os.environ["RAYON_NUM_THREADS"] = "1"
    with tempfile.TemporaryDirectory() as folder:
        scratch = pathlib.Path(folder)
        usual = verdicts(args.binary, asked, "", scratch)
        hits = sum(row["right"] for row in usual.values())
        print(f"code {score.commit()}\n{len(asked)} cases, {hits} right\n\n{HEAD}", flush=True)
        found = []
        for name in names:
            right, changed = {1.0: hits}, {}
            for factor in FACTORS:
                rows = verdicts(args.binary, asked, f"{name} = {factor * known[name]!r}\n", scratch)
                right[factor], changed[factor] = compared(usual, rows)
            found.append((name, known[name], right, changed))
            print(line(*found[-1]), flush=True)
            if args.markdown:
                args.markdown.write_text(markdown(found, len(asked)))


if __name__ == "__main__":
    main()
