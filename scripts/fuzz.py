#!/usr/bin/env python3
"""Damages a small campaign in N ways and holds the program to its word: never a panic, exit status 0 or 2, every
refusal names the file at fault, and damage that is known to matter is never passed over.

usage: scripts/fuzz.py [--binary target/release/tautline] [--campaign data/elbow] [--number 10000] [--seed 1] [--case K]

Case K of a seed is always the same; `--case K` runs it alone and keeps its folder. Exit status: 0, or 1 on a violation.
"""

import argparse
import collections
import concurrent.futures
import dataclasses
import json
import os
import pathlib
import random
import re
import shutil
import subprocess
import sys
import tempfile

# A small CSV campaign is made with this where the campaign given holds other logs, or more than ROWS_MAX rows.
SIMULATE = (
    "simulate --model {campaign}/truth/model.json -o {output} --quiet "
    "--speeds 8 --slowest-rad-s 0.1 --repeats 1 --cosines 0 --rate-hz 50 --seed 1"
)
ROWS_MAX = 50_000
IDENTIFY_SHARE = 0.1  # of the cases also go through `identify`, which takes longer
TIMEOUT_S = 60
REFUSED, ACCEPTED, EITHER = "refused", "accepted", "either"


@dataclasses.dataclass
class Base:
    """The undamaged campaign: its text, its logs by name, and the columns that are read."""

    folder: pathlib.Path
    toml: str
    logs: dict[str, list[str]]

    @staticmethod
    def read(folder):
        toml = (folder / "campaign.toml").read_text()
        names = re.findall(r'^file = "(.*)"', toml, re.M)
        return Base(folder, toml, {name: (folder / name).read_text().splitlines(keepends=True) for name in names})

    def needed(self, name):
        """Places of the columns that campaign.toml asks for, in the log `name`."""
        header = self.logs[name][0].strip().split(",")
        wanted = re.findall(r'^\w+ = \{ *name = "([^"]*)"', self.toml, re.M)
        return [header.index(column) for column in wanted]


@dataclasses.dataclass
class Case:
    """One damaged file and what must come of it."""

    kind: str
    file: str
    content: bytes
    expected: str


LOG_KINDS, TOML_KINDS = {}, {}


def log_kind(expected):
    """A kind of damage to a log: takes the random source, its lines and its needed columns, gives lines or bytes."""
    return lambda function: LOG_KINDS.setdefault("log: " + function.__name__, (function, expected)) and function


def toml_kind(expected):
    """A kind of damage to campaign.toml: takes the random source and its lines, gives lines or bytes."""
    return lambda function: TOML_KINDS.setdefault("toml: " + function.__name__, (function, expected)) and function


# ---- logs


def inner_row(rng, lines, margin=2):
    return rng.randrange(1 + margin, len(lines) - margin)


def change_field(rng, lines, columns, text):
    row, column = inner_row(rng, lines), rng.choice(columns)
    fields = lines[row].rstrip("\n").split(",")
    fields[column] = text
    return lines[:row] + [",".join(fields) + "\n"] + lines[row + 1 :]


@log_kind(REFUSED)
def text_in_number(rng, lines, columns):
    return change_field(rng, lines, columns, rng.choice(["abc", "1.2.3", "--1", "0x1f", "1e", "12:30", "true", "1 2"]))


@log_kind(REFUSED)
def no_finite_number(rng, lines, columns):
    return change_field(rng, lines, columns, rng.choice(["nan", "NaN", "inf", "-inf", "Infinity", "1e999", "", "  "]))


@log_kind(REFUSED)
def rows_dropped(rng, lines, _):
    count = rng.randint(3, 60)
    row = rng.randrange(3, len(lines) - count - 3)
    return lines[:row] + lines[row + count :]


@log_kind(ACCEPTED)
def one_row_dropped(rng, lines, _):
    row = inner_row(rng, lines)
    return lines[:row] + lines[row + 1 :]


@log_kind(REFUSED)
def row_doubled(rng, lines, _):
    row = inner_row(rng, lines)
    return lines[:row] + [lines[row]] + lines[row:]


@log_kind(REFUSED)
def rows_swapped(rng, lines, _):
    a, b = rng.sample(range(1, len(lines)), 2)
    swapped = list(lines)
    swapped[a], swapped[b] = lines[b], lines[a]
    return swapped


@log_kind(REFUSED)
def field_more_or_less(rng, lines, _):
    row = inner_row(rng, lines)
    fields = lines[row].rstrip("\n").split(",")
    fields = fields[:-1] if rng.random() < 0.5 else fields + ["0"]
    return lines[:row] + [",".join(fields) + "\n"] + lines[row + 1 :]


@log_kind(REFUSED)
def column_renamed(rng, lines, columns):
    header = lines[0].strip().split(",")
    header[rng.choice(columns)] += rng.choice(["_", "2", " x"])
    return [",".join(header) + "\n"] + lines[1:]


@log_kind(REFUSED)
def column_twice(rng, lines, columns):
    name = lines[0].strip().split(",")[rng.choice(columns)]
    return [lines[0].rstrip("\n") + f",{name}\n"] + [line.rstrip("\n") + ",1\n" for line in lines[1:]]


@log_kind(REFUSED)
def header_missing(_, lines, __):
    return lines[1:]


@log_kind(REFUSED)
def other_separator(rng, lines, _):
    return [line.replace(",", rng.choice([";", "\t"])) for line in lines]


@log_kind(REFUSED)
def sensor_dead(_, lines, columns):
    fields = [line.rstrip("\n").split(",") for line in lines]
    return [lines[0]] + [",".join(row[: columns[2]] + ["0.5"] + row[columns[2] + 1 :]) + "\n" for row in fields[1:]]


@log_kind(REFUSED)
def few_rows(rng, lines, _):
    return lines[: rng.randint(0, 15)]


@log_kind(REFUSED)
def quote_opened(rng, lines, _):
    row = inner_row(rng, lines)
    return lines[:row] + ['"' + lines[row]] + lines[row + 1 :]


@log_kind(ACCEPTED)
def other_form(rng, lines, _):
    forms = [
        lambda: [line.replace("\n", "\r\n") for line in lines],
        lambda: ["\ufeff"] + lines,
        lambda: [line.replace(",", " , ") for line in lines],
        lambda: [lines[0]] + [line + "\n" * (rng.random() < 0.01) for line in lines[1:]],
        lambda: [line.rstrip("\n") + ",note\n" for line in lines],
        lambda: lines[:-1] + [lines[-1].rstrip("\n")],
    ]
    return rng.choice(forms)()


@log_kind(EITHER)
def cut_short(rng, lines, _):
    text = "".join(lines).encode()
    return text[: rng.randrange(len(text))]


@log_kind(EITHER)
def bytes_changed(rng, lines, _):
    return change_bytes(rng, "".join(lines).encode())


def change_bytes(rng, content):
    content = bytearray(content)
    for _ in range(rng.choice([1, 1, 1, 2, 5, 50])):
        place, action = rng.randrange(len(content)), rng.random()
        if action < 0.6:
            content[place] = rng.choice([rng.randrange(256), rng.choice(b'0123456789.,-+eE"\n\r\0=[]{}#')])
        elif action < 0.8:
            content.insert(place, rng.randrange(256))
        elif len(content) > 1:
            del content[place]
    return bytes(content)


# ---- campaign.toml

REQUIRED = """format winch_radius_m pulley_radius_m backlash_m gravity_nm torque_sign lowpass_hz lowpass_order
    time position torque file protocol speed_rad_s""".split()
NONSENSE = {
    "format": ['"campaign/2"', '"model/1"', "1"],
    "kind": ['"revolut"', '"linear"', "1"],
    "winch_radius_m": ["0", "-0.012", "nan", "inf", '"0.012"', "true"],
    "pulley_radius_m": ["0.0", "-1", "-inf", "[0.04]", "{}"],
    "backlash_m": ["-0.0008", "nan", '"none"'],
    "gravity_nm": ["nan", "inf", '"0.7"', "1979-05-27"],
    "inertia_kg_m2": ["-1.0", "nan", "false"],
    "torque_sign": ["0", "2", "-0.5", '"-1"', "nan"],
    "lowpass_hz": ["0", "-5.0", "1e6", "1e-6", "inf", '"5 Hz"'],
    "lowpass_order": ["0", "13", "-4", "4.5", "1000000000000", '"4"'],
    "protocol": ['"unifrom"', '""', "7", '"Uniform"'],
    "speed_rad_s": ["0", "-0.1", "nan", '"fast"'],
    "repeat": ["0", "-1", "1.5", "99999999999"],
    "file": ['"../x.csv"', '"/etc/passwd"', '"absent.csv"', '""', '"."', "3"],
}


def keyed_lines(lines, keys=None):
    found = [(index, match[1]) for index, line in enumerate(lines) if (match := re.match(r"(\w+) *=", line))]
    return [(index, key) for index, key in found if keys is None or key in keys]


def misspelt(rng, word):
    place = rng.randrange(len(word))
    return rng.choice([word[:place] + "x" + word[place:], word[:place] + "Q" + word[place + 1 :], word + "_"])


@toml_kind(REFUSED)
def key_misspelt(rng, lines):
    index, key = rng.choice(keyed_lines(lines))
    return lines[:index] + [misspelt(rng, key) + lines[index][len(key) :]] + lines[index + 1 :]


@toml_kind(REFUSED)
def section_misspelt(rng, lines):
    index = rng.choice([index for index, line in enumerate(lines) if line.startswith("[")])
    line = re.sub(r"\w+", lambda word: misspelt(rng, word[0]), lines[index])
    return lines[:index] + [line] + lines[index + 1 :]


@toml_kind(REFUSED)
def key_missing(rng, lines):
    index, _ = rng.choice(keyed_lines(lines, REQUIRED))
    return lines[:index] + lines[index + 1 :]


@toml_kind(REFUSED)
def key_doubled(rng, lines):
    index, _ = rng.choice(keyed_lines(lines))
    return lines[:index] + [lines[index]] + lines[index:]


@toml_kind(REFUSED)
def key_unknown(rng, lines):
    index, _ = rng.choice(keyed_lines(lines))
    return lines[:index] + [rng.choice(['comment = "x"\n', "gain = 1.0\n", "a.b.c = 1\n"])] + lines[index:]


@toml_kind(REFUSED)
def value_nonsense(rng, lines):
    index, key = rng.choice(keyed_lines(lines, NONSENSE))
    return lines[:index] + [f"{key} = {rng.choice(NONSENSE[key])}\n"] + lines[index + 1 :]


@toml_kind(REFUSED)
def unit_unknown(rng, lines):
    index = rng.choice([index for index, line in enumerate(lines) if "unit = " in line])
    unit = rng.choice(["", "fortnight", "furlong", "N m s", "kg", "1", "lbf", "degC"])
    return lines[:index] + [re.sub(r'unit = "[^"]*"', f'unit = "{unit}"', lines[index])] + lines[index + 1 :]


@toml_kind(REFUSED)
def trial_twice(rng, lines):
    starts = [index for index, line in enumerate(lines) if line.startswith("[[trials]]")]
    start = rng.choice(starts)
    end = next((index for index in starts if index > start), len(lines))
    return lines + ["\n"] + lines[start:end]


@toml_kind(EITHER)
def unit_other(rng, lines):
    index = rng.choice([index for index, line in enumerate(lines) if "unit = " in line])
    unit = rng.choice(["s", "ms", "us", "rad", "deg", "N m", "mN m"])
    return lines[:index] + [re.sub(r'unit = "[^"]*"', f'unit = "{unit}"', lines[index])] + lines[index + 1 :]


@toml_kind(EITHER)
def number_other(rng, lines):
    texts = ("format", "kind", "file", "protocol")
    index, key = rng.choice(keyed_lines(lines, [key for key in NONSENSE if key not in texts]))
    number = rng.choice([rng.uniform(0, 2), 10 ** rng.uniform(-9, 9), rng.randint(1, 12), 1e300, 5e-324])
    return lines[:index] + [f"{key} = {number}\n"] + lines[index + 1 :]


@toml_kind(EITHER)
def line_moved(rng, lines):
    lines = list(lines)
    line = lines.pop(rng.randrange(len(lines)))
    lines.insert(rng.randrange(len(lines)), line)
    return lines


@toml_kind(EITHER)
def toml_cut_short(rng, lines):
    text = "".join(lines).encode()
    return text[: rng.randrange(len(text))]


@toml_kind(EITHER)
def toml_bytes_changed(rng, lines):
    return change_bytes(rng, "".join(lines).encode())


# ---- running


def make_case(base, seed, index):
    rng = random.Random(f"{seed}/{index}")
    if rng.random() < 0.5:
        kind, (damage, expected) = rng.choice(list(TOML_KINDS.items()))
        file, content = "campaign.toml", damage(rng, base.toml.splitlines(keepends=True))
    else:
        kind, (damage, expected) = rng.choice(list(LOG_KINDS.items()))
        file = rng.choice(list(base.logs))
        content = damage(rng, base.logs[file], base.needed(file))
    content = content if isinstance(content, bytes) else "".join(content).encode()
    return Case(kind, file, content, expected), rng.random() < IDENTIFY_SHARE


def lay_out(base, case, folder):
    for name in ["campaign.toml", *base.logs]:
        if name != case.file:
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            os.link(base.folder / name, folder / name)
    (folder / case.file).write_bytes(case.content)


def run(binary, *arguments):
    try:
        done = subprocess.run([binary, *arguments], capture_output=True, timeout=TIMEOUT_S)
    except subprocess.TimeoutExpired:
        return None, "", f"no answer within {TIMEOUT_S} s"
    return done.returncode, done.stdout.decode(errors="replace"), done.stderr.decode(errors="replace")


def judge(case, status, stdout, stderr, is_json):
    """What is wrong with this answer, if anything."""
    if status == 101 or "panicked" in stderr:
        return "panic"
    if status not in (0, 2):
        return f"exit status {status}"
    if status == 2 and os.path.basename(case.file) not in stdout + stderr and "campaign.toml" not in stdout + stderr:
        return "the file at fault is not named"
    if status == 0 and case.expected == REFUSED:
        return "damage passed over"
    if status == 2 and case.expected == ACCEPTED:
        return "refused without need"
    if is_json:
        try:
            json.loads(stdout)
        except ValueError:
            return "standard output is no JSON"
    return None


def try_case(base, binary, seed, index, keep):
    """Runs one case; gives its kind, what was expected, the exit status and the violations."""
    case, identifies = make_case(base, seed, index)
    folder = pathlib.Path(tempfile.mkdtemp(prefix="tautline-fuzz-"))
    try:
        (folder / "campaign").mkdir()
        lay_out(base, case, folder / "campaign")
        commands = [("validate", str(folder / "campaign"), "--json")]
        if identifies:
            commands.append(("identify", str(folder / "campaign"), "-o", str(folder / "out"), "--quiet"))
        answers = [run(binary, *command) for command in commands]
        violations = []
        for command, (status, stdout, stderr) in zip(commands, answers):
            fault = judge(case, status, stdout, stderr, command[0] == "validate")
            if fault:
                name = f"case {index}, {case.kind}, {case.file}, {command[0]}"
                violations.append(f"{name}: {fault}\n    {stderr.strip()[:400]}")
        if len(answers) == 2 and answers[0][0] != answers[1][0]:
            which = "identify took what validate refused" if answers[0][0] == 2 else "identify refused what validate took"
            violations.append(f"case {index}, {case.kind}: {which}\n    {answers[1][2].strip()[:400]}")
        return case.kind, case.expected, answers[0][0], violations
    finally:
        if keep:
            print("kept in", folder)
        else:
            shutil.rmtree(folder)


def small_campaign(binary, campaign, work):
    """A folder with a small CSV campaign: the one given if it is such, else a simulated one."""
    file = campaign / "campaign.toml"
    names = re.findall(r'^file = "(.*)"', file.read_text(), re.M) if file.is_file() else []
    if names and all(name.endswith(".csv") for name in names):
        if sum((campaign / name).read_bytes().count(b"\n") for name in names) <= ROWS_MAX:
            folder = work / "base"
            shutil.copytree(campaign, folder)
            return folder
    output = work / "base"
    command = SIMULATE.format(campaign=campaign, output=output).split()
    subprocess.run([binary, *command], check=True)
    return output


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--binary", default="target/release/tautline")
    parser.add_argument("--campaign", default="data/elbow", type=pathlib.Path)
    parser.add_argument("--number", default=10_000, type=int)
    parser.add_argument("--seed", default=1, type=int)
    parser.add_argument("--case", type=int)
    parser.add_argument("--jobs", default=os.cpu_count(), type=int)
    given = parser.parse_args()
    binary = os.path.abspath(given.binary)
    with tempfile.TemporaryDirectory(prefix="tautline-fuzz-") as work:
        base = Base.read(small_campaign(binary, given.campaign, pathlib.Path(work)))
        status, _, stderr = run(binary, "validate", str(base.folder), "--json")
        if status != 0:
            sys.exit(f"the undamaged campaign is refused: {stderr}")
        cases = range(given.number) if given.case is None else [given.case]
        one = lambda index: try_case(base, binary, given.seed, index, given.case is not None)
        with concurrent.futures.ThreadPoolExecutor(given.jobs) as pool:
            results = list(pool.map(one, cases))
    sys.exit(report(results))


def report(results):
    table = collections.defaultdict(collections.Counter)
    for kind, expected, status, violations in results:
        table[kind, expected].update(runs=1, accepted=status == 0, refused=status == 2, violations=len(violations))
    print(f"{'damage':28} {'expected':9} {'runs':>6} {'accepted':>9} {'refused':>8} {'violations':>11}")
    for (kind, expected), row in sorted(table.items()):
        print(f"{kind:28} {expected:9} {row['runs']:6} {row['accepted']:9} {row['refused']:8} {row['violations']:11}")
    violations = [violation for result in results for violation in result[3]]
    print(f"{len(results)} cases, {len(violations)} violations")
    for violation in violations[:20]:
        print(violation)
    return 1 if violations else 0


if __name__ == "__main__":
    main()
