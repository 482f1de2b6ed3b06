#!/usr/bin/env python3
"""Compares what `tautline diagnose` says of blind cases with the answers.

usage: scripts/blind/score.py --cases DIR --answers DIR2 [--binary PATH] [--results DIR3] [--json FILE] [--verbose] [--need effect=0.95,none=0.98]

Without --results it runs the binary on every case, one after the other; with it, it reads DIR3/<case>/diagnosis.json.
--need holds the shares of right verdicts among causes of 1.5 floors net or more (all cases of none); exit status 1 below any of them.
"""
import argparse
import collections
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

import numpy as np
from scipy.optimize import minimize

KINDS = ("effect", "stale", "none", "unknown", "pair", "tie")
CLEAR = 1.5  # floors, net: what any good judge should see
CLOSE = 0.03  # of shrink
TIMEOUT_S = 600.0


def run(binary, case, out):
    """Runs one diagnosis: (diagnosis or None, what went wrong, seconds)."""
    started = time.perf_counter()
    command = [binary, "diagnose", case / "campaign", "--model", case / "model.json", "-o", out, "--quiet"]
    try:
        done = subprocess.run([str(c) for c in command], capture_output=True, text=True, timeout=TIMEOUT_S)
    except subprocess.TimeoutExpired:
        return None, f"no end within {TIMEOUT_S:.0f} s", TIMEOUT_S
    seconds = time.perf_counter() - started
    if done.returncode:
        return None, f"exit status {done.returncode}: {(done.stderr.strip().splitlines() or ['no word'])[0][:200]}", seconds
    diagnosis, trouble = read(out)
    return diagnosis, trouble, seconds


def read(folder):
    """The diagnosis of one case, or why there is none."""
    try:
        diagnosis = json.loads((folder / "diagnosis.json").read_text())
        diagnosis["verdict"]["kind"], diagnosis["verdict"].get("effects", [])
        return diagnosis, None
    except (OSError, ValueError, KeyError, TypeError) as error:
        return None, f"no diagnosis: {error!r}"[:200]


def right(answer, kind, effects):
    """Whether a verdict is one of the accepted ones, or `ambiguous` between the truth and nothing but what cannot be told from it."""
    for good in answer["accepted"]:
        if kind == good["kind"] and (kind in ("none", "unknown") or set(effects) == set(good["effects"])):
            return True
    if kind != "ambiguous" or answer["kind"] not in ("effect", "stale", "tie"):
        return False
    needed = set(answer["effects"]) if answer["kind"] != "tie" else set(answer["accepted"][0]["effects"])
    others = set(effects) - needed
    return needed <= set(effects) and others <= set(answer["indistinguishable"]) and (others or answer["kind"] == "tie")


def strength(answer):
    """Net strength in floors: of the weaker one for a pair."""
    if answer["kind"] == "pair":
        return min(answer["net_of_each_over_floor"])
    return answer["net_over_floor"]


def judge(answer, diagnosis, trouble, seconds):
    """One row: the truth, the verdict and how they compare."""
    row = {
        "case": answer["case"], "kind": answer["kind"], "effects": answer["effects"], "variants": answer["variants"], "strength": strength(answer),
        "indistinguishable": answer["indistinguishable"], "seconds": seconds, "trouble": trouble, "right": False, "verdict": "failed", "named": [],
        "where": None, "where_right": None, "shrink_true": answer["shrink_true_form"], "shrink": None, "held": None, "confidence": None,
    }
    if diagnosis is None:
        return row
    verdict = diagnosis["verdict"]
    effects = verdict.get("effects") or []
    row.update(verdict=verdict["kind"], named=effects, confidence=verdict.get("confidence"), right=bool(right(answer, verdict["kind"], effects)))
    where = diagnosis.get("where") or []
    row["where"] = where[0]["region"] if where else None
    if answer["where"]:
        row["where_right"] = row["where"] in answer["where"]
    if row["right"] and answer["shrink_true_form"] is not None and verdict.get("shrink") is not None:
        row["shrink"] = verdict["shrink"]
        if verdict.get("shrink_low") is not None and verdict.get("shrink_high") is not None:
            row["held"] = verdict["shrink_low"] <= answer["shrink_true_form"] <= verdict["shrink_high"]
    return row


def share(rows, key="right"):
    """Share of rows for which `key` holds; None without rows."""
    seen = [bool(r[key]) for r in rows if r[key] is not None]
    return sum(seen) / len(seen) if seen else None


def found_nine_in_ten(rows):
    """The net strength at which a logistic curve through right and wrong passes 0.9, in floors."""
    if len(rows) < 20 or len({r["right"] for r in rows}) < 2:
        return None
    x, y = np.log([r["strength"] for r in rows]), np.array([r["right"] for r in rows], float)

    def cost(p):
        z = p[0] + p[1] * x
        return np.sum(np.logaddexp(0, z) - y * z) + 0.01 * p[1] ** 2

    offset, slope = minimize(cost, [0.0, 1.0]).x
    return float(np.exp((np.log(9) - offset) / slope)) if slope > 0 else None


def smallest_held(rows):
    """The smallest net strength from which on at least 9 in 10 were right."""
    best, hits = None, 0
    for n, row in enumerate(sorted(rows, key=lambda r: -r["strength"]), 1):
        hits += row["right"]
        if hits >= 0.9 * n:
            best = row["strength"]
    return best


def summary(rows):
    """Every figure of the table."""
    kinds = {k: [r for r in rows if r["kind"] == k] for k in KINDS}
    single = kinds["effect"] + kinds["stale"]
    shrunk = [r for r in rows if r["shrink"] is not None]
    off = np.array([abs(r["shrink"] - r["shrink_true"]) for r in shrunk])
    pairs = [len(set(r["named"]) & set(r["effects"])) for r in kinds["pair"]]
    clear = lambda group: [r for r in group if r["kind"] == "none" or r["strength"] >= CLEAR]
    alone = lambda group: [r for r in clear(group) if not r["indistinguishable"] or r["kind"] == "tie"]
    by_cause = collections.defaultdict(list)
    for r in single:
        by_cause[r["kind"] + " " + r["effects"][0]].append(r)
    return {
        "cases": len(rows),
        "kinds": {
            k: {
                "cases": len(g), "right": share(g), "clear": len(clear(g)), "right_clear": share(clear(g)),
                "alone": len(alone(g)), "right_alone": share(alone(g)),
            }
            for k, g in kinds.items() if g
        },
        "ambiguous_with_truth": sum(r["verdict"] == "ambiguous" and not r["right"] and bool(set(r["named"]) & set(r["effects"])) for r in rows),
        "false_alarms": sum(not r["right"] for r in kinds["none"]),
        "pairs": {"both": pairs.count(2), "one": pairs.count(1), "none": pairs.count(0)},
        "stale_named": share([{"right": set(r["effects"]) <= set(r["named"])} for r in kinds["stale"]]),
        "where_first": share(rows, "where_right"),
        "shrink": {
            "cases": len(shrunk), "median_off": float(np.median(off)) if len(off) else None,
            "within": float(np.mean(off <= CLOSE)) if len(off) else None,
            "interval_holds": share(shrunk, "held"),
        },
        "found_nine_in_ten_floors": found_nine_in_ten(single),
        "by_cause": {
            name: {"cases": len(g), "right": sum(r["right"] for r in g), "nine_in_ten_from_floors": smallest_held(g)}
            for name, g in sorted(by_cause.items())
        },
        "confusion": confusion(rows),
        "failed": [r["case"] for r in rows if r["verdict"] == "failed"],
        "seconds": {"median": float(np.median([r["seconds"] for r in rows])), "most": max(r["seconds"] for r in rows)},
    }


def confusion(rows):
    """truth -> {wrong verdict: cases}."""
    wrong = collections.defaultdict(collections.Counter)
    for r in rows:
        if not r["right"]:
            truth = r["kind"] if r["kind"] in ("none", "unknown") else f"{r['kind']} {'+'.join(sorted(r['effects']))}"
            wrong[truth][" ".join([r["verdict"], "+".join(sorted(r["named"]))]).strip()] += 1
    return {truth: dict(verdicts) for truth, verdicts in sorted(wrong.items())}


def percent(x):
    return "  -  " if x is None else f"{100 * x:5.1f}"


def number(x, form="{:.3f}"):
    return "-" if x is None else form.format(x)


def table(s):
    """The figures as text."""
    lines = [f"{s['cases']} cases", "", f"kind      cases  right %   net >= {CLEAR} floors  right %   and nothing like it  right %"]
    lines += [
        f"{k:8} {v['cases']:6}    {percent(v['right'])}   {v['clear']:17}    {percent(v['right_clear'])}"
        f"   {v['alone']:19}    {percent(v['right_alone'])}"
        for k, v in s["kinds"].items()
    ]
    p, h = s["pairs"], s["shrink"]
    lines += [
        "",
        f"not called none where nothing is wrong   {s['false_alarms']} of {s['kinds'].get('none', {}).get('cases', 0)}",
        f"ambiguous, the truth among others: wrong {s['ambiguous_with_truth']}",
        f"pairs: both named, one, none             {p['both']}, {p['one']}, {p['none']}",
        f"stale parameter among those named        {percent(s['stale_named'])} %",
        f"first place right                        {percent(s['where_first'])} %",
        f"shrink against the true form's           median off {number(h['median_off'])}, within {CLOSE}: {percent(h['within'])} % of {h['cases']}",
        f"its 95 % interval holds the true form's  {percent(h['interval_holds'])} %",
        f"found 9 times in 10 from (logistic)      {number(s['found_nine_in_ten_floors'], '{:.2f}')} floors net",
        f"seconds a case                           median {s['seconds']['median']:.2f}, most {s['seconds']['most']:.2f}",
        "",
        "cause                            right of cases   9 in 10 right from (floors net)",
    ]
    lines += [f"{n:32} {c['right']:5} of {c['cases']:3}      {number(c['nine_in_ten_from_floors'], '{:.2f}')}" for n, c in s["by_cause"].items()]
    if s["confusion"]:
        lines += ["", "wrong: truth -> verdict"]
        for truth, verdicts in s["confusion"].items():
            lines.append(f"{truth:40} -> {', '.join(f'{v} x{n}' if n > 1 else v for v, n in verdicts.items())}")
    if s["failed"]:
        lines += ["", f"failed: {', '.join(s['failed'])}"]
    return "\n".join(lines)


def told(row):
    """One wrong case in a line."""
    truth = f"{row['kind']} {'+'.join(row['effects'])} ({', '.join(row['variants'])})" if row["variants"] else row["kind"]
    verdict = row["trouble"] or " ".join([row["verdict"], "+".join(row["named"])])
    same = f"; like it: {', '.join(row['indistinguishable'])}" if row["indistinguishable"] else ""
    return f"{row['case']}  {truth}, {row['strength']:.2f} floors net -> {verdict}; first place {row['where']}{same}"


def missed(kinds, need):
    """The kinds that stay below what is needed, told."""
    short = []
    for entry in need.split(","):
        kind, least = entry.split("=")
        got = kinds.get(kind, {}).get("right_clear")
        if got is not None and got < float(least):
            short.append(f"{kind}: {got:.3f} right, {least} needed")
    return short


def diagnoses(args, names):
    """Per case: diagnosis or None, what went wrong, seconds."""
    if args.results:
        for name in names:
            yield (*read(args.results / name), 0.0)
        return
    scratch = pathlib.Path(tempfile.mkdtemp())
    try:
        for name in names:
            yield run(args.binary, args.cases / name, scratch / name)
            shutil.rmtree(scratch / name, ignore_errors=True)
    finally:
        shutil.rmtree(scratch, ignore_errors=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cases", type=pathlib.Path, required=True)
    parser.add_argument("--answers", type=pathlib.Path, required=True)
    parser.add_argument("--binary", default="target/release/tautline")
    parser.add_argument("--results", type=pathlib.Path)
    parser.add_argument("--json", type=pathlib.Path)
    parser.add_argument("--verbose", action="store_true")
    parser.add_argument("--need", help="least shares of right verdicts, kind=share,...")
    args = parser.parse_args()
    answers = [json.loads(p.read_text()) for p in sorted(args.answers.glob("*.json"))]
    if not answers:
        sys.exit(f"no answers in {args.answers}")
    found = diagnoses(args, [a["case"] for a in answers])
    rows = [judge(answer, *found_one) for answer, found_one in zip(answers, found)]
    figures = summary(rows)
    if args.json:
        args.json.write_text(json.dumps({"summary": figures, "rows": rows}, indent=2, default=float) + "\n")
    if args.verbose:
        print("\n".join(told(r) for r in rows if not r["right"]), end="\n\n")
    print(table(figures), flush=True)
    short = missed(figures["kinds"], args.need) if args.need else []
    if short:
        sys.exit("below what is needed: " + "; ".join(short))


if __name__ == "__main__":
    main()
