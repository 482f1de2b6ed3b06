#!/usr/bin/env python3
"""What `batch` finds in the lives of simulated joints: false alarms, the delay of detection, coverage of forecasts.

usage: scripts/histories.py [--fleets 60] [--first 0] [--seed 1] [--binary target/release/tautline] [--jobs N] [--need FALSE FOUND LOW HIGH]

A fleet is four joints over two years, a session each month, 30 +- 8 days apart: one to which nothing happens, one that drifts
(friction, 0.5 to 3 % a month), one with a jump at an unknown time, six sessions or more after the first (friction of one direction by 8 to 40 %, or A by 3 to
10 %),
one that is retensioned twice (friction by -30 to 40 %, or by nothing). In every second fleet friction follows a recorded
temperature of the seasons, by 0.2 to 1 % per K. What a session finds is drawn, not recorded: A, B(v) and the parameters scatter by the intervals that
`identify` gives them for one simulated campaign, and from session to session friction by 0.5 to 2 %, A by 0.1 to 0.4 %. They go
where `batch` keeps its results, and `batch` is run with all until then after every third session, and after each of the three that follow a jump.

Told: the share of joints to which nothing happened of which any of these runs, over two years, tells that something did; after how many sessions a jump
is told, at the right place within one session; how often the interval of a forecast holds the true time.
--need: exits with 1 beyond these shares. (Standard library only.)
"""
import argparse
import collections
import concurrent.futures
import copy
import datetime
import json
import math
import os
import pathlib
import random
import subprocess
import sys
import tempfile

TRUTH = pathlib.Path("data/elbow/truth/model.json")
SESSIONS, FIRST, EVERY = 24, 6, 3
DAY_0 = datetime.date(2024, 1, 10)
HALF_WIDTH = 1.96
LIMIT_SPEED_RAD_S = 0.1


def reference(binary):
    """The model that `identify` makes of one simulated campaign, with its intervals."""
    with tempfile.TemporaryDirectory() as scratch:
        subprocess.run([binary, "simulate", "--model", TRUTH, "-o", f"{scratch}/c", "--rate-hz", "100", "--speeds", "10", "--repeats", "2",
                        "--cosines", "1", "--quiet"], check=True)
        subprocess.run([binary, "identify", f"{scratch}/c", "-o", f"{scratch}/o", "--quiet"], check=True, stdout=subprocess.DEVNULL)
        return json.load(open(f"{scratch}/o/model.json"))


def life(rng, kind, days, degc, warmth):
    """The true relative friction of each session by direction, A's, and what happened."""
    friction = {d: [1 - warmth * (t - 20) for t in degc] for d in ("up", "down")}
    a = {d: [1.0] * len(days) for d in ("up", "down")}
    told = {"kind": kind, "retensioned": []}
    if kind == "drift":
        told["per_day"] = math.exp(rng.uniform(math.log(0.005), math.log(0.03))) / 30
        for d in friction:
            friction[d] = [f + told["per_day"] * t for f, t in zip(friction[d], days)]
    elif kind == "jump":
        told["at"], told["direction"] = rng.randrange(FIRST, SESSIONS - 3), rng.choice(("up", "down"))
        of, low, high = rng.choice(((friction, 0.08, 0.4), (friction, 0.08, 0.4), (a, 0.03, 0.1)))
        told["of"], told["by"] = "A" if of is a else "B", rng.choice((-1, 1)) * rng.uniform(low, high)
        series = of[told["direction"]]
        of[told["direction"]] = [x * (1 + told["by"] * (i >= told["at"])) for i, x in enumerate(series)]
    elif kind == "retensioned":
        for at in (rng.randrange(6, 11), rng.randrange(13, 19)):
            by = rng.choice((0.0, rng.uniform(-0.3, -0.05), rng.uniform(0.05, 0.4)))
            told["retensioned"].append((at, by))
            for d in friction:
                friction[d] = [x * (1 + by * (i >= at)) for i, x in enumerate(friction[d])]
    return friction, a, told


def session(rng, base, name, friction, a, scatter, scatter_a):
    """What one session finds."""
    model = copy.deepcopy(base)
    model["joint"]["name"] = name
    errors = [rng.gauss(0, 1 / HALF_WIDTH) for _ in model["functions"]["up"]["shared"]]
    for d in ("up", "down"):
        scale = friction[d] * (1 + rng.gauss(0, scatter))
        of = model["functions"][d]
        gain = a[d] * (1 + rng.gauss(0, scatter_a))
        adds = lambda to: sum(error * shared[to] for error, shared in zip(errors, of["shared"]))
        of["a_nm"] = of["a_nm"] * gain + adds("a_nm")
        common = adds("b_nm")
        for level in of["b"]:
            level["b_nm"] = level["b_nm"] * scale + common + rng.gauss(0, level["half_width_nm"] / HALF_WIDTH)
        for term, value in model["friction"][d].items():
            known = model["confidence"].get(f"friction.{d}.{term}")
            if known and None not in (known["low"], known["high"]):
                half = (known["high"] - known["low"]) / 2
                true = value * (scale if term in ("a_j", "b_c", "b_j", "d") else 1.0)
                # A parameter that is hardly known keeps its sign, as in a fit with bounds.
                value = next(x for x in iter(lambda: true + rng.gauss(0, half / HALF_WIDTH), None) if x * true > 0)
                known["low"], known["high"] = value - half, value + half
                model["friction"][d][term] = value
    return model


def batch(binary, listed, out, drawn=True):
    done = subprocess.run([binary, "batch", listed, "-o", out, "--json", "--threads", "1"], capture_output=True, text=True)
    if done.returncode == 2:
        sys.exit(done.stderr)
    found = json.loads(done.stdout)
    if drawn and found["failed"]:
        sys.exit(f"a drawn session cannot be read: {found['failed'][0]}")
    return found


def written(joints, days, degc, sessions, limits):
    """The list of a fleet's first `sessions`."""
    date = lambda i: DAY_0 + datetime.timedelta(days=round(days[i]))
    lines = ['format = "batch/1"']
    for name, (_, _, told) in joints.items():
        for i in range(sessions):
            lines += ["[[campaigns]]", f'path = "{name}/{i:02}"', f'joint = "{name}"', f"date = {date(i)}"]
            if degc:
                lines.append(f"conditions = {{ temperature_degc = {degc[i]:.2f} }}")
        for at, _ in told["retensioned"]:
            if at < sessions:
                lines += ["[[retensioned]]", f'joint = "{name}"', f"date = {date(at)}"]
    for name, most in limits.items():
        lines += ["[[limits]]", f'joint = "{name}"', 'what = "friction_nm"', f"speed_rad_s = {LIMIT_SPEED_RAD_S}", f"at_most = {most!r}"]
    return "\n".join(lines) + "\n"


def fleet(a, base, number):
    """Counts of one fleet."""
    rng = random.Random(1000 * a.seed + number)
    days = [30.0 * i + rng.uniform(-8, 8) for i in range(SESSIONS)]
    warmth = math.exp(rng.uniform(math.log(0.002), math.log(0.01))) if number % 2 else 0.0
    degc = [20 + 6 * math.sin(2 * math.pi * (t - 100) / 365) + rng.gauss(0, 2) for t in days]
    scatter, scatter_a = rng.uniform(0.005, 0.02), rng.uniform(0.001, 0.004)
    joints = {kind: life(rng, kind, days, degc, warmth) for kind in ("none", "drift", "jump", "retensioned")}
    level = {d: friction_at(base, d) for d in ("up", "down")}
    reached = {d: rng.uniform(1.1, 1.6) for d in ("drift",)}
    limits = {"drift": reached["drift"] * max(abs(x) for x in level.values())}
    counts = collections.Counter()
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        listed, out = scratch / "fleet.toml", scratch / "out"
        listed.write_text(written(joints, days, degc, SESSIONS, {}))
        batch(a.binary, listed, out, drawn=False)
        for file in sorted((out / "campaigns").glob("*.json")):
            record = json.loads(file.read_text())
            name, i = record["name"].split("/")
            friction, of_a, _ = joints[name]
            at = {d: (friction[d][int(i)], of_a[d][int(i)]) for d in friction}
            model = session(rng, base, name, {d: x[0] for d, x in at.items()}, {d: x[1] for d, x in at.items()}, scatter, scatter_a)
            file.write_text(json.dumps(record | {"failure": None, "route": "sweeps", "model": model, "trials": 1, "rows": 1}))
        alarmed, found = False, None
        at = joints["jump"][2]["at"]
        for sessions in sorted({*range(FIRST, SESSIONS + 1, EVERY), *range(at + 1, at + 4)}):
            listed.write_text(written(joints, days, degc if warmth else None, sessions, limits))
            of = {joint["joint"]: joint for joint in batch(a.binary, listed, out)["joints"]}
            happened = lambda name: [(q["name"], h) for q in of[name]["quantities"] for h in q["happened"] if h["kind"] != "temperature"]
            if happened("none") and a.verbose:
                print("false", number, sessions, [(n, h["kind"]) for n, h in happened("none")], file=sys.stderr)
            alarmed |= bool(happened("none"))
            told = joints["jump"][2]
            since = sessions - told["at"]
            right = [h for n, h in happened("jump") if n.startswith(told["of"]) and n.endswith(told["direction"]) and h["kind"] in ("jump", "episode")
                     and abs(int(h["after"].split("/")[1]) - told["at"]) <= 1]
            if found is None and since > 0 and right:
                found = since
            # The forecast is for the sessions' mean temperature.
            cold = warmth * (sum(degc[:sessions]) / sessions - 20)
            forecasts(counts, of["drift"], joints["drift"][2], days, sessions, level, limits["drift"], cold)
        counts["joints without"], counts["false"] = 1, alarmed
        counts["jumps"], counts["in time"], counts["found"] = 1, found is not None and found <= 2, found is not None
        counts["delay", found] = 1
        if a.verbose:
            print(number, told, "found after", found, file=sys.stderr)
        last = [h for _, h in happened("drift")]
        counts["drifts"], counts["drifts told"] = 1, any(h["kind"] == "drift" for h in last)
        counts["drifts with jumps"] = any(h["kind"] != "drift" for h in last)
        for at, by in joints["retensioned"][2]["retensioned"]:
            event = next(e for e in of["retensioned"]["retensionings"] if e["after"].endswith(f"/{at:02}"))
            counts["retensioned", by != 0] += 1
            counts["retensioned told", by != 0] += bool(event["changes"])
    return counts


def friction_at(base, direction):
    """B at the speed of the limit, straight over the logarithm of speed between those identified."""
    levels = base["functions"][direction]["b"]
    for low, high in zip(levels, levels[1:]):
        if low["speed_rad_s"] <= LIMIT_SPEED_RAD_S <= high["speed_rad_s"]:
            share = math.log(LIMIT_SPEED_RAD_S / low["speed_rad_s"]) / math.log(high["speed_rad_s"] / low["speed_rad_s"])
            return low["b_nm"] + share * (high["b_nm"] - low["b_nm"])
    raise ValueError("the limit's speed is outside those identified")


def forecasts(counts, joint, told, days, sessions, level, most, cold):
    date = lambda day: (DAY_0 + datetime.timedelta(days=day)).isoformat()
    for limit in joint["limits"]:
        direction = limit["name"].split()[-1]
        due = (most / abs(level[direction]) - 1 + cold) / told["per_day"]
        if due < days[sessions - 1]:
            continue
        kind = "refused" if "unknown" in limit else "reached" if limit["reached"] else "given"
        counts["forecasts " + kind] += 1
        if kind == "given":
            counts["forecasts held"] += limit["low"] <= date(due) <= limit["high"]


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--fleets", type=int, default=60)
    arguments.add_argument("--first", type=int, default=0)
    arguments.add_argument("--seed", type=int, default=1)
    arguments.add_argument("--binary", default="target/release/tautline")
    arguments.add_argument("--jobs", type=int, default=os.cpu_count())
    arguments.add_argument("--need", type=float, nargs=4)
    arguments.add_argument("--verbose", action="store_true")
    a = arguments.parse_args()
    base, counts = reference(a.binary), collections.Counter()
    with concurrent.futures.ThreadPoolExecutor(a.jobs) as pool:
        for of in pool.map(lambda number: fleet(a, base, number), range(a.first, a.fleets)):
            counts.update(of)
            if a.verbose:
                print({key: count for key, count in counts.items() if isinstance(key, str)}, file=sys.stderr)
    share = lambda part, whole: counts[part] / counts[whole] if counts[whole] else math.nan
    false, found = share("false", "joints without"), share("in time", "jumps")
    held = share("forecasts held", "forecasts given")
    print(f"nothing happened, and ever told in two years that something did: {counts['false']} of {counts['joints without']} joints, {100 * false:.0f} %")
    print(f"jumps: {counts['jumps']}, told within two sessions {counts['in time']} ({100 * found:.0f} %), ever {counts['found']}; sessions until told: "
          + ", ".join(f"{delay}: {counts[key]}" for key in sorted((k for k in counts if k[0] == "delay"), key=str) for delay in [key[1]]))
    print(f"drifts: {counts['drifts']}, told {counts['drifts told']}, with a jump that was not {counts['drifts with jumps']}")
    for real, words in ((True, "changed friction"), (False, "changed nothing")):
        print(f"retensionings that {words}: {counts['retensioned', real]}, told to have changed something {counts['retensioned told', real]}")
    print(f"forecasts: {counts['forecasts given']} given, {counts['forecasts refused']} refused; the interval holds the true time in {100 * held:.1f} %"
          f"; told as reached too early {counts['forecasts reached']}")
    if a.need:
        sys.exit(not (false <= a.need[0] and found >= a.need[1] and a.need[2] <= held <= a.need[3]))


if __name__ == "__main__":
    main()
