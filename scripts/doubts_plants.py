#!/usr/bin/env python3
"""The doubts of `tautline validate` on joints that tautline did not simulate: mistakes named, right campaigns doubted.

usage: scripts/doubts_plants.py [--campaigns 60] [--seed 1] [--rate-hz 100] [--noise 0.01] [--position-noise 0] [--free 0.25]
                                [--binary target/release/tautline] [--verbose]

Cables, gears and direct drives in turn, integrated here: friction that grows with the load, falls with speed, and builds up over a way
after each reversal. A share of them (--free) moves freely, the others in sweeps. Each campaign is checked as it is declared rightly,
then with one mistake of scripts/doubts.py. Noise is a share of the torque that gravity makes; that of the position is in degrees.
Ends with status 1 when fewer than 90 % are named or more than 3 % of the right ones are doubted. Needs NumPy.
"""
import argparse
import collections
import json
import pathlib
import random
import subprocess
import sys
import tempfile

import numpy as np

from doubts import MISTAKES, times


class Joint:
    """`r1`, `r2`: radii; gravity in N m; dry friction in N and the load's share of it, up and down."""

    def __init__(self, rng, drive):
        self.drive = drive
        self.r2 = {"cable": rng.uniform(0.02, 0.08), "gear": rng.uniform(5, 100), "direct": 1.0}[drive]
        self.r1 = self.r2 * rng.uniform(0.2, 0.6) if drive == "cable" else 1.0
        self.gravity = np.exp(rng.uniform(np.log(0.3), np.log(15)))
        self.inertia = self.gravity / 9.81 * 0.15
        share, dry = rng.uniform(0, 0.3), self.gravity / self.r2 * rng.uniform(0.05, 0.5)
        self.dry, self.share = (dry, dry * rng.uniform(0.5, 1.2)), (share, share * rng.uniform(0.8, 1.1))
        self.viscous, self.stribeck = dry * rng.uniform(0.05, 0.5), dry * rng.uniform(0, 0.4)
        self.slow, self.way = rng.uniform(0.03, 0.2), rng.uniform(0.005, 0.04)

    def torque(self, t, q, v):
        load = self.r1 / self.r2 * (self.gravity * np.sin(q) + self.inertia * np.gradient(v, t))
        level = self.stribeck * np.exp(-np.abs(v) / self.slow) + self.viscous * np.abs(v)
        up = (load + self.r1 * (self.dry[0] + level)) / (1 - self.share[0])
        down = (load - self.r1 * (self.dry[1] + level)) / (1 + self.share[1])
        state, states = 1.0, []
        for step in np.diff(q, prepend=q[0]):
            state += ((step > 0) - state) * (1 - np.exp(-3 * abs(step) / self.way))
            states.append(state)
        return np.array(states) * up + (1 - np.array(states)) * down

    def declared(self):
        keys = {"cable": f"winch_radius_m = {self.r1!r}\npulley_radius_m = {self.r2!r}\nbacklash_m = {self.way / 3 * self.r2!r}",
                "gear": f"drive = \"gear\"\ngear_ratio = {self.r2!r}\nbacklash_rad = 0.0",
                "direct": "drive = \"direct\"\nbacklash_rad = 0.0"}[self.drive]
        return f"[joint]\nname = \"joint\"\n{keys}\n[dynamics]\ngravity_nm = {float(self.gravity)!r}\ninertia_kg_m2 = {float(self.inertia)!r}\n"

    def mistakes(self):
        """Those of scripts/doubts.py that can be made on this drive."""
        by_drive = {"cable": MISTAKES["radius"], "gear": [times("gear_ratio", 2.0), times("gear_ratio", 0.1)], "direct": None}
        return {kind: variants for kind, variants in (MISTAKES | {"radius": by_drive[self.drive]}).items() if variants}


def sweep(speed, low, high, rate):
    """Twice there and back at constant speed, between rests."""
    ramp = np.linspace(0, speed, max(int(0.25 * rate), 1), endpoint=False)
    one = np.concatenate([ramp, np.full(int(((high - low) / speed - 0.25) * rate), speed), ramp[::-1]])
    rest = np.zeros(int(0.3 * rate))
    v = np.concatenate([rest] + 2 * [one, rest, -one, rest])
    return low + np.concatenate([[0], np.cumsum(v[:-1])]) / rate, v


def free(rng, low, high, rate):
    t = np.arange(int(40 * rate)) / rate
    waves = rng.dirichlet(5 * [3.0])[:, None] * np.sin(2 * np.pi * rng.uniform(0.08, 0.6, 5)[:, None] * t + rng.uniform(0, 6, 5)[:, None])
    q = waves.sum(axis=0)
    q = (low + high) / 2 + (high - low) / 2 * q / np.abs(q).max()
    return q, np.gradient(q, t)


def record(folder, joint, rng, a, is_free):
    """Writes the campaign, declared rightly; returns its text."""
    low = rng.uniform(-0.6, 0.3)
    high = low + rng.uniform(1.0, 1.8)
    speeds = 3 * [None] if is_free else np.geomspace(0.06, 0.9, rng.integers(4, 7))
    text = "format = \"campaign/1\"\n" + joint.declared() + "[signal]\ntorque_sign = -1\nlowpass_hz = 5.0\nlowpass_order = 4\n[columns]\n"
    text += "time = { name = \"t\", unit = \"s\" }\nposition = { name = \"q\", unit = \"deg\" }\ntorque = { name = \"y\", unit = \"N m\" }\n"
    for i, speed in enumerate(speeds):
        q, v = free(rng, low, high, a.rate_hz) if is_free else sweep(speed, low, high, a.rate_hz)
        t = np.arange(len(q)) / a.rate_hz
        y = -joint.torque(t, q, v) + rng.normal(0, a.noise * joint.r1 / joint.r2 * joint.gravity, len(q))
        read = np.degrees(q) + rng.normal(0, a.position_noise, len(q))
        np.savetxt(folder / f"{i}.csv", np.column_stack([t, read, y]), fmt="%.7f", delimiter=",", header="t,q,y", comments="")
        motion = f"protocol = \"free\"\ntrajectory = \"motion {i}\"" if is_free else f"protocol = \"uniform\"\nspeed_rad_s = {float(speed)!r}"
        text += f"[[trials]]\nfile = \"{i}.csv\"\n{motion}\n"
    return text


def doubts(binary, folder, text):
    (folder / "campaign.toml").write_text(text)
    done = subprocess.run([binary, "validate", str(folder), "--json"], capture_output=True, text=True)
    return json.loads(done.stdout)["doubts"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--campaigns", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--rate-hz", type=float, default=100.0)
    parser.add_argument("--noise", type=float, default=0.01)
    parser.add_argument("--position-noise", type=float, default=0.0)
    parser.add_argument("--free", type=float, default=0.25)
    parser.add_argument("--binary", default="target/release/tautline")
    parser.add_argument("--verbose", action="store_true")
    a = parser.parse_args()
    tally, false = collections.defaultdict(lambda: [0, 0, 0]), 0
    for number in range(a.campaigns):
        rng, choice = np.random.default_rng([a.seed, number]), random.Random(1000 * a.seed + number)
        joint, is_free = Joint(rng, ["cable", "gear", "direct"][number % 3]), choice.random() < a.free
        with tempfile.TemporaryDirectory() as scratch:
            folder = pathlib.Path(scratch)
            text = record(folder, joint, rng, a, is_free)
            of_right = doubts(a.binary, folder, text)
            kind = choice.choice(list(joint.mistakes()))
            variant = choice.randrange(len(joint.mistakes()[kind]))
            found = [doubt["causes"] for doubt in doubts(a.binary, folder, joint.mistakes()[kind][variant](text))]
        false += bool(of_right)
        where = f"{number} {joint.drive} {'free' if is_free else 'sweeps'}"
        if of_right and a.verbose:
            print(f"{where}: doubted though right: {[(doubt['causes'], doubt['what'][:160]) for doubt in of_right]}", flush=True)
        is_named = any(kind in causes for causes in found)
        if not is_named and a.verbose:
            print(f"{where}: {kind} {variant} missed: {found}", flush=True)
        counts = tally[kind]
        counts[0], counts[1], counts[2] = counts[0] + 1, counts[1] + is_named, counts[2] + (bool(found) and found[0][0] == kind)
    for kind, (count, named, first) in sorted(tally.items()):
        print(f"{kind:8} {named:3} of {count:3} named, {first:3} first")
    named = sum(counts[1] for counts in tally.values())
    print(f"named {named} of {a.campaigns}; right campaigns doubted: {false} of {a.campaigns}")
    sys.exit(0 if named >= 0.9 * a.campaigns and false <= 0.03 * a.campaigns else 1)


if __name__ == "__main__":
    main()
