#!/usr/bin/env python3
"""Compares what `tautline diagnose` says of blind cases with the answers.

usage: scripts/blind/score.py --cases DIR --answers DIR2 [--binary PATH] [--results DIR3] [--json FILE] [--verbose]
                              [--need effect=0.95,effect@0.5=0.8,none=0.98] [--most ece=0.05,wrong_when_sure=0.1]

Without --results it runs the binary on every case, one after the other; with it, it reads DIR3/<case>/diagnosis.json.
--need holds the least shares of right verdicts, of a kind among causes of 1.5 floors net or more (all cases of none), of kind@floors
among causes from that strength up; --most holds the largest expected calibration error, and of verdicts said with 0.9 or more the
largest share of wrong ones. Exit status 1 where one is missed. With --pool FILE,... the rows of earlier --json files are scored along.
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

KINDS = ("effect", "stale", "none", "unknown", "pair", "triple", "tie")
CLEAR = 1.5  # floors, net: what any good judge should see
CLOSE = 0.03  # of shrink
SURE = 0.9  # a verdict said with this confidence or more
BINS = (0.0, 0.3, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.99, 1.0000001)  # of confidence, for the reliability diagram
STRENGTHS = (0.0, 0.5, 1.0, 1.5, 3.0, 6.0, float("inf"))  # floors net
TIMEOUT_S = 600.0


def run(binary, case, out, options=()):
    """Runs one diagnosis: (diagnosis or None, what went wrong, seconds)."""
    started = time.perf_counter()
    command = [binary, "diagnose", case / "campaign", "--model", case / "model.json", "-o", out, "--quiet", *options]
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
    """Net strength in floors: of the weakest one of several."""
    if answer["kind"] in ("pair", "triple"):
        return min(answer["net_of_each_over_floor"])
    return answer["net_over_floor"]


def judge(answer, diagnosis, trouble, seconds):
    """One row: the truth, the verdict and how they compare."""
    row = {
        "case": answer["case"], "kind": answer["kind"], "effects": answer["effects"], "variants": answer["variants"], "strength": strength(answer),
        "indistinguishable": answer["indistinguishable"], "seconds": seconds, "trouble": trouble, "right": False, "verdict": "failed", "named": [],
        "clear": None, "distinct": None, "where": None, "where_right": None, "shrink_true": answer.get("shrink_true_form"), "shrink": None, "held": None, "confidence": None,
    }
    if diagnosis is None:
        return row
    verdict = diagnosis["verdict"]
    effects = verdict.get("effects") or []
    clear = {d["outcome"] for d in diagnosis.get("decisions", []) if d["rule"] == "clear"}
    row["clear"] = max(clear, default=None)  # "not clear" where either decision is
    row["distinct"] = all(d["outcome"] == "distinct" for d in diagnosis.get("decisions", []) if d["rule"] == "distinct")
    row.update(verdict=verdict["kind"], named=effects, confidence=verdict.get("confidence"), right=bool(right(answer, verdict["kind"], effects)))
    where = diagnosis.get("where") or []
    row["where"] = where[0]["region"] if where else None
    if answer.get("where"):
        row["where_right"] = row["where"] in answer["where"]
    if row["right"] and row["shrink_true"] is not None and verdict.get("shrink") is not None:
        row["shrink"] = verdict["shrink"]
        if verdict.get("shrink_low") is not None and verdict.get("shrink_high") is not None:
            row["held"] = verdict["shrink_low"] <= row["shrink_true"] <= verdict["shrink_high"]
    return row


def share(rows, key="right"):
    """Share of rows for which `key` holds; None without rows."""
    seen = [bool(r[key]) for r in rows if r[key] is not None]
    return sum(seen) / len(seen) if seen else None


def several_named(rows):
    """Of cases with several causes: how many had all named, all but one, ..."""
    found = collections.Counter(len(r["effects"]) - len(set(r["named"]) & set(r["effects"])) for r in rows)
    most = max((len(r["effects"]) for r in rows), default=0)
    return [found[k] for k in range(most + 1)]


def calibration(rows):
    """Expected calibration error, the reliability diagram's points, and how often a sure verdict was wrong."""
    said = [r for r in rows if r["confidence"] is not None]
    points, error = [], 0.0
    for low, high in zip(BINS[:-1], BINS[1:]):
        group = [r for r in said if low <= r["confidence"] < high]
        if group:
            mean, hit = float(np.mean([r["confidence"] for r in group])), share(group)
            points.append({"from": low, "to": min(1.0, high), "verdicts": len(group), "said": mean, "right": hit})
            error += len(group) / len(said) * abs(mean - hit)
    sure = [r for r in said if r["confidence"] >= SURE]
    brier = float(np.mean([(r["confidence"] - r["right"]) ** 2 for r in said])) if said else None
    return {
        "verdicts": len(said), "ece": error if said else None, "brier": brier, "sure": len(sure),
        "wrong_when_sure": 1 - share(sure) if sure else None, "points": points,
    }


def by_verdict(rows):
    """What was said: how often, how often rightly, and what was true instead. `diagnose` weights its probabilities by such counts."""
    said = collections.defaultdict(list)
    for r in rows:
        standing = f", {r['clear']}, {'distinct' if r['distinct'] else 'replaceable'}" if r["clear"] else ""
        said[r["verdict"] + standing].append(r)

    def counts(group):
        wrong = collections.Counter(r["kind"] for r in group if not r["right"])
        right = sum(r["right"] for r in group)
        truths = {"none": wrong["none"], "outside": wrong["unknown"]}
        return {"cases": len(group), "right": right, **truths, "other": len(group) - right - sum(truths.values())}

    return {verdict: counts(group) for verdict, group in sorted(said.items())}


def by_strength(rows):
    """Share of right verdicts by net strength, for each kind that has one."""
    table = {}
    for kind in KINDS:
        group = [r for r in rows if r["kind"] == kind and kind != "none"]
        if group:
            table[kind] = [
                {"from": low, "to": high, "cases": len(g), "right": share(g)}
                for low, high in zip(STRENGTHS[:-1], STRENGTHS[1:]) for g in [[r for r in group if low <= r["strength"] < high]]
            ]
    return table


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
        "pairs_missing": several_named(kinds["pair"]),
        "triples_missing": several_named(kinds["triple"]),
        "by_strength": by_strength(rows),
        "calibration": calibration(rows),
        "by_verdict": by_verdict(rows),
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


def told_counts(counts):
    return ", ".join(map(str, counts)) if sum(counts) else "-"


def table(s):
    """The figures as text."""
    lines = [f"{s['cases']} cases", "", f"kind      cases  right %   net >= {CLEAR} floors  right %   and nothing like it  right %"]
    lines += [
        f"{k:8} {v['cases']:6}    {percent(v['right'])}   {v['clear']:17}    {percent(v['right_clear'])}"
        f"   {v['alone']:19}    {percent(v['right_alone'])}"
        for k, v in s["kinds"].items()
    ]
    h, c = s["shrink"], s["calibration"]
    lines += [
        "",
        f"not called none where nothing is wrong   {s['false_alarms']} of {s['kinds'].get('none', {}).get('cases', 0)}",
        f"ambiguous, the truth among others: wrong {s['ambiguous_with_truth']}",
        f"pairs: both named, one, none             {told_counts(s['pairs_missing'])}",
        f"triples: all named, two, one, none       {told_counts(s['triples_missing'])}",
        f"stale parameter among those named        {percent(s['stale_named'])} %",
        f"first place right                        {percent(s['where_first'])} %",
        f"shrink against the true form's           median off {number(h['median_off'])}, within {CLOSE}: {percent(h['within'])} % of {h['cases']}",
        f"its 95 % interval holds the true form's  {percent(h['interval_holds'])} %",
        f"found 9 times in 10 from (logistic)      {number(s['found_nine_in_ten_floors'], '{:.2f}')} floors net",
        f"seconds a case                           median {s['seconds']['median']:.2f}, most {s['seconds']['most']:.2f}",
        f"expected calibration error               {number(c['ece'])} over {c['verdicts']} verdicts, Brier score {number(c['brier'])}",
        f"said with {SURE} or more                   {c['sure']}, wrong among them {percent(c['wrong_when_sure'])} %",
        "",
        "confidence said    verdicts   mean said   right %",
    ]
    lines += [
        f"{p['from']:.2f} to {p['to']:.2f}      {p['verdicts']:9}       {p['said']:.3f}     {percent(p['right'])}  {'#' * round(20 * p['right'])}"
        for p in c["points"]
    ]
    lines += ["", "verdict said                     right of verdicts   wrong: nothing missing, outside the library, other causes"]
    lines += [
        f"{verdict:32} {v['right']:5} of {v['cases']:3}               {v['none']:5} {v['outside']:5} {v['other']:5}"
        for verdict, v in s["by_verdict"].items()
    ]
    lines += ["", "floors net   " + "".join(f"{low:>9g} up" for low in STRENGTHS[:-1]) + "   (right of cases)"]
    lines += [
        f"{kind:10}   " + "".join(f"{round((b['right'] or 0) * b['cases'])} of {b['cases']}".rjust(12) if b["cases"] else "-".rjust(12) for b in bins)
        for kind, bins in s["by_strength"].items()
    ]
    lines += [
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


def missed(rows, figures, need, most):
    """What stays below what is needed, or above what is allowed, told."""
    short = []
    for entry in need.split(",") if need else []:
        name, least = entry.split("=")
        kind, _, floors = name.partition("@")
        group = [r for r in rows if r["kind"] == kind and (kind == "none" or r["strength"] >= float(floors or CLEAR))]
        got = share(group)
        if got is not None and got < float(least):
            short.append(f"{name}: {got:.3f} right, {least} needed")
    for entry in most.split(",") if most else []:
        name, limit = entry.split("=")
        got = figures["calibration"][name]
        if got is not None and got > float(limit):
            short.append(f"{name}: {got:.3f}, at most {limit} allowed")
    return short


def commit():
    """Of the checkout that this script lies in; '+' where something is changed in it."""
    folder = pathlib.Path(__file__).parent
    git = lambda *words: subprocess.run(["git", "-C", folder, *words], capture_output=True, text=True)
    head = git("rev-parse", "--short=12", "HEAD")
    return head.stdout.strip() + ("+" if git("status", "--porcelain", "-uno").stdout.strip() else "") if head.returncode == 0 else "unknown"


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
    parser.add_argument("--need", help="least shares of right verdicts, kind=share or kind@floors=share,...")
    parser.add_argument("--most", help="largest values of ece and wrong_when_sure, name=value,...")
    parser.add_argument("--pool", help="JSON files of earlier runs, to be scored together with this one")
    args = parser.parse_args()
    answers = [json.loads(p.read_text()) for p in sorted(args.answers.glob("*.json"))]
    if not answers:
        sys.exit(f"no answers in {args.answers}")
    found = diagnoses(args, [a["case"] for a in answers])
    rows = [judge(answer, *found_one) for answer, found_one in zip(answers, found)]
    for earlier in args.pool.split(",") if args.pool else []:
        rows += json.loads(pathlib.Path(earlier).read_text())["rows"]
    figures = summary(rows)
    if args.json:
        args.json.write_text(json.dumps({"summary": figures, "rows": rows}, indent=2, default=float) + "\n")
    if args.verbose:
        print("\n".join(told(r) for r in rows if not r["right"]), end="\n\n")
    print(f"code {commit()}\n{table(figures)}", flush=True)
    short = missed(rows, figures, args.need, args.most)
    if short:
        sys.exit("below what is needed: " + "; ".join(short))


if __name__ == "__main__":
    main()
