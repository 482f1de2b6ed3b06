"""The model that tautline itself identifies of the joint as it was: a second campaign of the same motions, without the effect."""
import json
import pathlib
import subprocess
import tempfile

import numpy as np

from write import write_case

TIMEOUT_S = 120


def identify(binary, case, rng):
    """The base that it found, the model as written, relative half-widths of what it declares; None where it declines."""
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        write_case(case, scratch, rng)
        words = [binary, "identify", scratch / "campaign", "-o", scratch / "out", "--form", "one", "--zero", "declared", "--quiet"]
        try:
            done = subprocess.run([str(w) for w in words], capture_output=True, text=True, timeout=TIMEOUT_S)
        except subprocess.TimeoutExpired:
            return None
        if done.returncode != 0:
            return None
        written = json.loads((scratch / "out" / "model.json").read_text())
    base = understood(case.base, written)
    return None if base is None else (base, written, half_widths(base, written))


def understood(truth, written):
    """A model file as a base of ours; None where its form is none of ours (two exponentials at once)."""
    changes, joint = {}, written["joint"]
    for direction, p in written["friction"].items():
        if p["b_c"] and p["b_j"]:
            return None
        changes |= {f"friction.{direction}.{k}": p[k] for k in ("mu_c", "a_j", "d")}
        changes[f"friction.{direction}.b_j"] = p["b_c"] or p["b_j"]
        changes[f"friction.{direction}.c_j"] = p["c_c"] * joint["pulley_radius_m"] if p["b_c"] else p["c_j"]
    base = truth.changed(changes)
    base.backlash_m = joint["backlash_m"]
    combination = written["combination"]
    base.curve = {"arctan": ("arctan", combination.get("p")), "power": ("power", combination.get("n"))}.get(combination["kind"], (combination["kind"],))
    return base


def half_widths(base, written):
    """By name, what a declared interval allows to each side, as a share of the value."""
    declared, values, allowed = written.get("confidence", {}), base.values(), {}
    for name, value in values.items():
        entry = declared.get(name) or declared.get(name.replace("b_j", "b_c").replace("c_j", "c_c")) or {}
        if value and entry.get("low") is not None and entry.get("high") is not None:
            allowed[name] = float(np.clip((entry["high"] - entry["low"]) / 2 / abs(value), 0.0, 1.0))
    return allowed
