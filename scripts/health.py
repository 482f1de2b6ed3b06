#!/usr/bin/env python3
"""What a damaged recording does to a model, and whether it is told: simulated campaigns with one fault each, and healthy ones.

usage: scripts/health.py [--faulty 500] [--healthy 500] [--seed 1] [--binary target/release/tautline] [--need 0.98 0.01]
                         [--without BINARY] [--only FAULT] [--verbose]

Each faulty campaign is a healthy one whose logs were changed: glitches, a stuck or clipped channel, drop-outs, coarse steps, a
drift in each trial, copies; sizes are drawn from "spoils a digit" to "obvious". Told: `identify` refuses it or warns in words that
belong to the fault. A fault is harmful when the 95 % interval of a parameter that is still called pinned misses the truth by more
than its own half width, and the interval of the same campaign without the fault did not miss it as far. With `--without`, a
binary that lacks these checks tells how many of the faults are harmful to it. Healthy campaigns
differ in noise, rate, encoder, speed, kind of joint, contacts, effects; a warning of a signal's health there is a false alarm.
Ends with status 1 when fewer harmful faults than the first of `--need` are told, or more false alarms than the second are
raised. (Standard library only.)
"""
import argparse
import collections
import concurrent.futures
import json
import math
import os
import pathlib
import random
import re
import shutil
import subprocess
import sys
import tempfile

TRUTH = pathlib.Path("data/elbow/truth/model.json")
# What `tautline` says of a signal's health, by kind.
WORDS = {
    "glitch": "glitches of up to",
    "dropout": "drops out to",
    "stuck": "stays at one reading",
    "clipped": "the sensor clips",
    "bounds": "which no joint or sensor shows",
    "quantised": "far larger than its noise",
    "drift": "drifts within the trials",
    "copies": "holds the same recording as",
}
OTHER_ERRORS = ("comes after", "a gap of")


def run(binary, *arguments):
    return subprocess.run([binary, *map(str, arguments)], capture_output=True, text=True)


class Log:
    """A CSV log: columns of numbers; the first is time, the second position, the third torque."""

    def __init__(self, path):
        self.path = path
        lines = path.read_text().splitlines()
        self.header = lines[0]
        self.rows = [[float(cell) for cell in line.split(",")] for line in lines[1:]]

    def write(self, path=None):
        lines = (",".join([f"{row[0]:.5f}", *(f"{cell:.6f}" for cell in row[1:])]) for row in self.rows)
        (path or self.path).write_text("\n".join([self.header, *lines]) + "\n")

    def moving(self):
        """First and last row of each stretch in which the joint moves."""
        reach = max(2, len(self.rows) // 200)
        inside, stretches = None, []
        for i in range(reach, len(self.rows) - reach, 1):
            moves = abs(self.rows[i + reach][1] - self.rows[i - reach][1]) > 0.2
            if moves and inside is None:
                inside = i
            if not moves and inside is not None:
                stretches.append((inside, i))
                inside = None
        if inside is not None:
            stretches.append((inside, len(self.rows) - reach))
        return [s for s in stretches if s[1] - s[0] > 40]


def logs(folder, sweeps=False):
    return [Log(path) for path in sorted(folder.glob("sweep_*.csv" if sweeps else "*.csv"))]


def size(rng, low, high):
    """Drawn evenly in the logarithm."""
    return math.exp(rng.uniform(math.log(low), math.log(high)))


def glitch_torque(folder, rng):
    count, height = rng.choice([1, 1, 3, 10]), size(rng, 0.1, 1e6)
    chosen = logs(folder, True)
    for _ in range(count):
        log = rng.choice(chosen)
        log.rows[rng.randrange(5, len(log.rows) - 5)][2] += rng.choice([-1, 1]) * height
    for log in chosen:
        log.write()
    return f"{count} x {height:.3g} N m"


def glitch_position(folder, rng):
    count, height = rng.choice([1, 1, 3, 10]), size(rng, 0.5, 1000)
    chosen = logs(folder, True)
    for _ in range(count):
        log = rng.choice(chosen)
        log.rows[rng.randrange(5, len(log.rows) - 5)][1] += rng.choice([-1, 1]) * height
    for log in chosen:
        log.write()
    return f"{count} x {height:.3g} deg"


def glitch_time(folder, rng):
    log = rng.choice(logs(folder, True))
    at, shift = rng.randrange(5, len(log.rows) - 5), size(rng, 0.5, 1e4) * (log.rows[1][0] - log.rows[0][0])
    log.rows[at][0] += rng.choice([-1, 1]) * shift
    log.write()
    return f"{shift:.3g} s"


def stuck(folder, rng, column=2):
    share = size(rng, 0.03, 0.4)
    for log in logs(folder, True):
        for first, last in log.moving():
            length = int((last - first) * share)
            start = rng.randrange(first, last - length)
            for i in range(start, start + length):
                log.rows[i][column] = log.rows[start][column]
        log.write()
    return f"{100 * share:.0f} % of each leg"


def stuck_position(folder, rng):
    return stuck(folder, rng, 1)


def dropout(folder, rng):
    share, constant = size(rng, 0.002, 0.2), rng.choice([0.0, 0.0, -0.05, 5.0])
    for log in logs(folder):
        for row in log.rows:
            if rng.random() < share:
                row[2] = constant
        log.write()
    return f"{100 * share:.1f} % at {constant}"


def held(folder, rng):
    share, length = size(rng, 0.01, 0.2), rng.choice([3, 10, 30])
    for log in logs(folder):
        i = 1
        while i < len(log.rows):
            if rng.random() < share / length:
                for k in range(i, min(i + length, len(log.rows))):
                    log.rows[k][2] = log.rows[i - 1][2]
                i += length
            i += 1
        log.write()
    return f"{100 * share:.1f} % in runs of {length}"


def quantised(folder, rng):
    step = size(rng, 0.03, 0.4)
    for log in logs(folder):
        for row in log.rows:
            row[2] = step * round(row[2] / step)
        log.write()
    return f"{step:.3f} N m"


def drift(folder, rng):
    rate = rng.choice([-1, 1]) * size(rng, 1e-4, 1e-2)
    for log in logs(folder):
        for row in log.rows:
            row[2] += rate * (row[0] - log.rows[0][0])
        log.write()
    return f"{1e3 * rate:.2f} mN m/s"


def clipped(folder, rng):
    share = rng.uniform(0.4, 0.95)
    most = max(abs(row[2]) for log in logs(folder) for row in log.rows) * share
    for log in logs(folder):
        for row in log.rows:
            row[2] = max(-most, min(most, row[2]))
        log.write()
    return f"at {most:.3f} N m"


def copies(folder, rng):
    times, way = rng.choice([2, 5, 10]), rng.choice(["exact", "shifted", "cut", "stretched"])
    toml = (folder / "campaign.toml").read_text()
    head, *entries = re.split(r"(?=\[\[trials\]\])", toml)
    more = []
    for entry in entries:
        if 'protocol = "uniform"' not in entry:
            continue
        name = re.search(r'file = "(.*)"', entry)[1]
        repeat = int(re.search(r"repeat = (\d+)", entry)[1])
        for k in range(1, times):
            copy = name.replace(".csv", f"_copy{k}.csv")
            log = Log(folder / name)
            if way == "shifted":
                log.rows = [[row[0] + 1000.0 * k, *row[1:]] for row in log.rows]
            if way == "cut":
                log.rows = log.rows[rng.randrange(1, max(2, len(log.rows) // 50)):]
            if way == "stretched":
                log.rows = [[row[0] * (1 + 1e-4 * k), *row[1:]] for row in log.rows]
            shutil.copy(folder / name, folder / copy) if way == "exact" else log.write(folder / copy)
            more.append(entry.replace(name, copy).replace(f"repeat = {repeat}", f"repeat = {100 * k + repeat}"))
    (folder / "campaign.toml").write_text(head + "".join(entries) + "\n" + "".join(more))
    return f"{times} times, {way}"


FAULTS = [glitch_torque, glitch_position, glitch_time, stuck, stuck_position, dropout, held, quantised, drift, clipped, copies]

# Healthy campaigns: what `simulate` is told; the rest is drawn.
KINDS = {
    "plain": [],
    "noisy": ["--noise-nm", 0.08],
    "quiet": ["--noise-nm", 0.001],
    "noise-free": ["--noise-nm", 0, "--encoder-counts", 0],
    "coarse encoder": ["--encoder-counts", 4096],
    "very coarse encoder": ["--encoder-counts", 1024],
    "exact encoder": ["--encoder-counts", 0],
    "fast": ["--fastest-rad-s", 1.5],
    "tracking error": ["--tracking-error-rad", 0.003],
    "closed loop": ["--closed-loop"],
    "touched": ["--interactions", 1],
    "prismatic": [],
    "torque ripple": ["--effect", "torque_ripple:periods_per_rad=5,sin_1_nm=0.01"],
    "friction ripple": ["--effect", "friction_ripple:periods_per_rad=5,sin_1_nm=0.01"],
    "spring": ["--effect", "elastic_spring:stiffness_nm_rad=0.03"],
    "end stop": ["--effect", "end_stop:side=1,stiffness_nm=0.3,position_rad=1.6,exponent=1.5"],
    "bias": ["--effect", "sensor_bias:bias_nm=0.05"],
    "presliding": ["--effect", "presliding:travel_rad=0.01,exponent=1"],
}


def prismatic_model(folder):
    model = json.loads(TRUTH.read_text())
    model["joint"].update(kind="prismatic", winch_radius_m=1.0, pulley_radius_m=1.0)
    path = folder / "prismatic.json"
    path.write_text(json.dumps(model))
    return path


def simulate(binary, folder, kind, rng, seed):
    """A healthy campaign, or nothing where the simulator cannot make it."""
    rate = rng.choice([50, 100, 100, 200]) if kind not in ("closed loop", "fast") else 250
    plan = ["--rate-hz", rate, "--speeds", rng.choice([3, 4, 5]), "--repeats", rng.choice([2, 3]), "--cosines", 0,
            "--slowest-rad-s", rng.choice([0.08, 0.15]), "--seed", seed]
    model = TRUTH
    extra = list(KINDS[kind])
    if kind == "prismatic":
        model = prismatic_model(folder.parent)
        plan = ["--rate-hz", rate, "--speeds", 0, "--cosines", 1, "--seed", seed]
    if kind == "touched":
        plan[plan.index("--rate-hz") + 1] = 100
    done = run(binary, "simulate", "--model", model, "-o", folder, "--quiet", *plan, *extra)
    return done.returncode == 0, done.stderr.strip()


def identify(binary, folder):
    """Pinned parameters with their intervals, and what was said."""
    with tempfile.TemporaryDirectory() as scratch:
        done = run(binary, "identify", folder, "-o", f"{scratch}/o", "--json")
        if done.returncode != 0:
            return None, done.stderr
        model = json.loads((pathlib.Path(scratch) / "o" / "model.json").read_text())
    said = "\n".join(json.loads(done.stdout)["warnings"]) + done.stderr
    pinned = {}
    for name, known in model["confidence"].items():
        if known["status"] == "pinned" and name.startswith("friction"):
            pinned[name] = (known["low"], known["high"])
    return pinned, said


def told(said):
    return {kind for kind, words in WORDS.items() if words in said}


def misses(pinned, truth):
    """How far each pinned interval misses the truth, in its half widths; 0 where it holds it."""
    off = {}
    for name, (low, high) in (pinned or {}).items():
        _, direction, parameter = name.split(".")
        value = truth["friction"][direction][parameter]
        off[name] = max(low - value, value - high, 0.0) / (0.5 * (high - low))
    return off


def harm(before, after):
    """How much farther than before the worst pinned interval misses the truth, in its half widths."""
    return max((far - before.get(name, 0.0) for name, far in after.items()), default=0.0)


def faulty(binary, without, seed, only, truth):
    rng = random.Random(f"faulty {seed}")
    faults = [fault for fault in FAULTS if not only or fault.__name__ in only]
    fault = faults[seed % len(faults)]
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch) / "c"
        made, why = simulate(binary, folder, rng.choice(["plain", "plain", "plain", "quiet", "coarse encoder"]), rng, seed)
        assert made, why
        before = misses(identify(binary, folder)[0], truth)
        how = fault(folder, rng)
        pinned, said = identify(binary, folder)
        unchecked = harm(before, misses(identify(without, folder)[0], truth)) if without else 0.0
    worst = harm(before, misses(pinned, truth))
    known = bool(told(said)) or (pinned is None and any(word in said for word in OTHER_ERRORS))
    return fault.__name__, how, pinned is None, known, worst > 1.0, worst, said, unchecked > 1.0


def healthy(binary, seed):
    rng = random.Random(f"healthy {seed}")
    kind = list(KINDS)[seed % len(KINDS)]
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch) / "c"
        made, why = simulate(binary, folder, kind, rng, seed)
        assert made, f"{kind}: {why}"
        _, said = identify(binary, folder)
    return kind, told(said), said


def table(title, rows):
    widths = [max(len(str(row[i])) for row in rows) for i in range(len(rows[0]))]
    print(title)
    for row in rows:
        print("  " + "  ".join(str(cell).ljust(width) for cell, width in zip(row, widths)))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--faulty", type=int, default=500)
    parser.add_argument("--healthy", type=int, default=500)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--binary", default="target/release/tautline")
    parser.add_argument("--need", type=float, nargs=2, default=(0.98, 0.01), metavar=("TOLD", "FALSE"))
    parser.add_argument("--without", help="a binary without these checks, to count what they prevent")
    parser.add_argument("--only", nargs="*", help="faults to make")
    parser.add_argument("--workers", type=int, default=os.cpu_count())
    parser.add_argument("--verbose", action="store_true")
    a = parser.parse_args()
    truth = json.loads(TRUTH.read_text())
    base = 100_000 * a.seed
    with concurrent.futures.ThreadPoolExecutor(a.workers) as pool:
        bad = list(pool.map(lambda k: faulty(a.binary, a.without, base + k, a.only, truth), range(a.faulty)))
        good = list(pool.map(lambda k: healthy(a.binary, base + k), range(a.healthy)))
    rows = [("fault", "campaigns", "refused", "told", "harmful unchecked", "of them met", "harmful", "harmful, not told")]
    by = collections.defaultdict(list)
    for one in bad:
        by[one[0]].append(one)
    for name, ones in by.items():
        harmful = [one for one in ones if one[4]]
        unchecked = [one for one in ones if one[7]]
        met = sum(one[3] or not one[4] for one in unchecked)
        rows.append((name, len(ones), sum(o[2] for o in ones), sum(o[3] for o in ones), len(unchecked), met, len(harmful),
                     sum(not o[3] for o in harmful)))
        for one in ones:
            if (one[4] and not one[3]) or a.verbose:
                print(f"{'  MISSED' if one[4] and not one[3] else '  '} {name}: {one[1]}: refused {one[2]}, told {one[3]}, off by {one[5]:.1f} half widths")
                if a.verbose and not one[3]:
                    print("      " + one[6][:600].replace("\n", "\n      "))
    # A harmful fault is met where it is told, or where nothing wrong is called pinned any more.
    missed = [one for one in bad if one[4] and not one[3]]
    harmful = [one for one in bad if one[7] or one[4]] if a.without else [one for one in bad if one[3] or one[4]]
    share = 1 - len(missed) / max(1, len(harmful))
    table(f"{len(bad)} campaigns with one fault", rows)
    of = "harmful with or without the checks" if a.without else "told or harmful"
    print(f"  {of}: {len(harmful)}; passed as good: {len(missed)}; told or demoted: {100 * share:.1f} %")
    rows = [("kind", "campaigns", "false alarms", "of")]
    kinds = collections.defaultdict(list)
    for kind, found, said in good:
        kinds[kind].append(found)
        if found:
            print(f"  FALSE {kind}: {found}: " + " | ".join(line[-300:] for line in said.splitlines() if told(line))[:600])
    for kind, found in kinds.items():
        rows.append((kind, len(found), sum(bool(f) for f in found), ", ".join(sorted(set().union(*found)))))
    false = sum(bool(found) for _, found, _ in good)
    table(f"{len(good)} healthy campaigns", rows)
    rate = false / max(1, len(good))
    print(f"  false alarms: {false} of {len(good)}, {100 * rate:.1f} %")
    sys.exit(share < a.need[0] or rate > a.need[1])


if __name__ == "__main__":
    main()
