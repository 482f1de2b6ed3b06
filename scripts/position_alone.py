#!/usr/bin/env python3
"""Single effects under a position controller: how often `tautline diagnose` names them with the torque, and from command and position alone.

usage: scripts/position_alone.py [--cases 51] [--seed 1] [--binary target/release/tautline] [--only EFFECT] [--verbose] [--json FILE]

A joint of its own, integrated here step by step: a servo with a stiff position controller of 1 kHz that reads a 14 bit encoder and
differentiates through a low-pass of 3 ms, dry friction that holds it at rest, a torque disturbance that makes the floor. The logs, at 200 Hz,
are handed over twice: with a torque sensor, and as command and position with the declared controller, whose gains share an error of
up to 2 % (the motor's torque constant; the gains themselves are numbers of the controller). Each case has one cause, of 1.5 to 8 floors (what
two runs of the joint without the cause differ by, of one motion) net of what the base takes up within 5 %. `named` counts verdicts whose
causes hold it, alone or with what the data cannot tell from it (`ambiguous`). Declared gains that are wrong, and a gear that takes another
share of its torque, scale all torques alike: there the verdict must be `ambiguous` between the two. Ends with status 1 below --need.
Needs NumPy and SciPy; about 15 s of processor time a case.
"""
import argparse
import json
import math
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
from scipy.signal import butter, sosfiltfilt

RATE_HZ, CONTROL_HZ, STEP_HZ = 200, 1000, 2000
LOWPASS_HZ, ORDER = 5.0, 4
COUNT_RAD = 2 * math.pi / 2**14
STRENGTH = (1.5, 8.0)  # floors, net
DURATION_S = 24.0
FILTER_S = 0.003  # of the velocity that the controller damps
MU = 0.1  # of the base: share of its torque that the gear takes
SAME = {  # what a verdict may name for a cause
    "reversal_transition": {"reversal_transition", "presliding"}, "presliding": {"presliding", "reversal_transition"},
    "stribeck": {"stribeck", "stribeck_level"}, "load_dependent_friction": {"load_dependent_friction", "load_coefficient"},
    "inertia": {"inertia"},
}


def commands(rng):
    """Positions at the integration's rate, a row for each trial, and the name of each motion: sweeps and sums of sines, twice each."""
    t = np.arange(int(DURATION_S * STEP_HZ)) / STEP_HZ
    rows, names = [], []
    for speed in (0.15, 0.4, 0.9):
        far = min(1.0, 0.45 * speed * (DURATION_S - 2.0) / 2)
        period = 4 * far / speed
        saw = far * (4 * np.abs(((np.maximum(t - 1.0, 0) / period + 0.75) % 1) - 0.5) - 1)
        kernel = np.hanning(int(0.2 * STEP_HZ))
        rows.append(np.convolve(np.pad(saw, len(kernel) // 2, mode="edge"), kernel / kernel.sum(), "same")[len(kernel) // 2 :][: len(t)])
        names.append(f"sweep_{speed}")
    for number in range(2):
        hz = rng.uniform([0.08, 0.2, 0.5], [0.15, 0.4, 0.9])
        size = np.array([0.6, 0.3, 0.1])[:, None] * np.sin(2 * np.pi * hz[:, None] * t + rng.uniform(0, 6, 3)[:, None])
        fade = np.clip(t / 2.0, 0, 1) * np.clip((t[-1] - t) / 2.0, 0, 1)
        rows.append(size.sum(axis=0) * fade)
        names.append(f"sines_{number + 1}")
    return np.array(rows + rows), names * 2


class Joint:
    """Gravity, inertia, friction by direction, and one thing more, of size `x`."""

    def __init__(self, rng, effect, command):
        self.gravity, self.inertia = rng.uniform(0.8, 3.0), rng.uniform(0.01, 0.04)
        self.coulomb = self.gravity * rng.uniform(0.06, 0.15, 2)  # up, down
        self.viscous = self.coulomb * rng.uniform(0.1, 0.5, 2)
        self.stiffness = self.gravity * rng.uniform(25, 60)
        self.damping = 1.2 * math.sqrt(self.stiffness * self.inertia)
        self.effect, self.x = effect, 0.0
        low, high = command.min(), command.max()
        self.phase, self.waves = rng.uniform(0, 2 * np.pi), rng.uniform(2.0, 5.0) * 2 * np.pi / (high - low)
        self.slow, self.side = rng.uniform(0.05, 0.15), rng.uniform(0.6, 1.4)
        self.tau_s, self.stop = rng.uniform(30, 90), high - rng.uniform(0.15, 0.35) * (high - low)
        self.middle = rng.uniform(-0.3, 0.3)
        self.pushes = [(rng.integers(len(command)), rng.uniform(3, 19), rng.uniform(0.5, 1.5), rng.choice([-1, 1])) for _ in range(4)]

    def friction(self, q, v, up, clock):
        """Level of dry and viscous friction where the motion is `up` or not, N m."""
        side = np.where(up, 0, 1)
        coulomb, viscous, x = self.coulomb[side], self.viscous[side], self.x
        if self.effect == "coulomb":
            coulomb = coulomb * (1 + x)
        if self.effect == "viscous":
            viscous = viscous * (1 + x)
        level = coulomb + viscous * np.abs(v)
        if self.effect == "stribeck":
            level = level + x * np.where(up, 1, self.side) / (1 + (v / self.slow) ** 2)
        if self.effect == "quadratic_viscous":
            level = level + x * np.abs(v) ** 2.2
        if self.effect == "load_dependent_friction":
            level = level + x * np.hypot(self.gravity * np.sin(q), 0.1 * self.gravity)
        if self.effect == "friction_ripple":
            wave = np.sin(self.waves * q + self.phase)
            level = level + x * (wave + 0.25 * np.sin(2 * self.waves * q))
        if self.effect == "warm_up":
            level = level * (1 + x * np.exp(-clock / self.tau_s))
        return level / (1 - self.mu())

    def load(self, q, t, trial):
        """Torque that does not depend on the direction, N m."""
        x, gravity = self.x, self.gravity * np.sin(q)
        extra = {
            "gravity": lambda: x * gravity,
            "gravity_phase": lambda: x * np.cos(q),
            "elastic_spring": lambda: x * (q - self.middle),
            "torque_ripple": lambda: x * (np.sin(self.waves * q + self.phase) + 0.3 * np.sin(2 * self.waves * q)),
            "end_stop": lambda: x * np.maximum(0, q - self.stop) ** 1.5,
            "contact": lambda: x * sum((trial == n) * side * (np.abs(t - at) < wide / 2) for n, at, wide, side in self.pushes),
        }.get(self.effect, lambda: 0.0)()
        return (gravity + extra) / (1 - self.mu())

    def mu(self):
        """Share of its torque that the gear takes."""
        return MU + (self.x if self.effect == "load_share" else 0.0)

    def declared_gain(self):
        """By how much more than the controller's gains are those that the campaign declares."""
        return 1 + (self.x if self.effect == "controller_gain" else 0.0)

    def mass(self):
        return self.inertia * (1 + (self.x if self.effect == "inertia" else 0)) / (1 - self.mu())

    def follow(self, command, disturbance, rng):
        """Logs of all trials side by side: position as the encoder reads it and torque of the motor, at RATE_HZ."""
        trials, steps = command.shape
        h, mass, per_control = 1 / STEP_HZ, self.mass(), STEP_HZ // CONTROL_HZ
        trial = np.arange(trials)
        began = trial * DURATION_S
        q, v = command[:, 0].copy(), np.zeros(trials)
        share, up, speed = np.ones(trials), np.ones(trials, bool), np.zeros(trials)
        read = np.round(q / COUNT_RAD) * COUNT_RAD
        torque, positions, torques = np.zeros(trials), [], []
        gradual = self.effect in ("presliding", "reversal_transition") and self.x > 0
        keep = 1 - math.exp(-1 / (FILTER_S * CONTROL_HZ))
        for i in range(steps):
            if i % per_control == 0:
                now = np.round(q / COUNT_RAD) * COUNT_RAD
                speed += keep * ((now - read) * CONTROL_HZ - speed)
                read = now
                torque = self.stiffness * (command[:, i] - read) - self.damping * speed
                if i % (STEP_HZ // RATE_HZ) == 0:
                    positions.append(read)
                    torques.append(torque)
            drive = torque - self.load(q, i * h, trial) + disturbance[:, i]
            if gradual:
                level = self.friction(q, v, up, began + i * h)
                other = self.friction(q, v, ~up, began + i * h)
                high, low = np.where(up, level, other), np.where(up, other, level)
                v = v + h / mass * (drive - ((share + 1) / 2 * high - (1 - share) / 2 * low))
                moved = 2 * h * v / self.x
                share = np.clip(share + (moved if self.effect == "reversal_transition" else moved * (1 - np.sign(v) * share)), -1, 1)
                up = v > 0
            else:
                free = v + h / mass * drive
                up = free > 0
                v = np.sign(free) * np.maximum(0, np.abs(free) - h / mass * self.friction(q, v, up, began + i * h))
            q = q + h * v
        return np.array(positions).T, np.array(torques).T

    def net(self, q, torque, healthy_torque, sos):
        """RMS of what the effect adds beyond what the base takes up within 5 %, N m; by the torque both ways on nearly one motion."""
        v = np.gradient(q, 1 / RATE_HZ, axis=1)
        v = sosfiltfilt(butter(2, 20, fs=RATE_HZ, output="sos"), v, axis=1)
        a = np.gradient(v, 1 / RATE_HZ, axis=1)
        columns = [self.gravity * np.sin(q), self.inertia * a] + [
            part * (v > 1e-3 if side == 0 else v < -1e-3) * (1 if side == 0 else -1)
            for side in (0, 1) for part in (self.coulomb[side], self.viscous[side] * np.abs(v))]
        judged = lambda x: sosfiltfilt(sos, x, axis=1).ravel()[::8]
        gap = judged(self.declared_gain() * torque - healthy_torque)
        design = np.column_stack([judged(c) for c in columns]) / (1 - MU)
        floor = 1e-2 * np.sqrt(np.mean(judged(torque) ** 2))
        lhs = design.T @ design / floor**2 + np.eye(design.shape[1]) * len(gap) / 50 / 0.025**2
        found = np.clip(np.linalg.solve(lhs, design.T @ gap / floor**2), -0.05, 0.05)
        return float(np.sqrt(np.mean((gap - design @ found) ** 2)))


SIZES = {  # first guess at x, and the most that is still physical
    "stribeck": (0.05, 3.0), "quadratic_viscous": (0.1, 5.0), "load_dependent_friction": (0.05, 0.6), "friction_ripple": (0.03, 0.5),
    "warm_up": (0.5, 3.0), "gravity_phase": (0.05, 1.0), "elastic_spring": (0.1, 2.0), "torque_ripple": (0.03, 0.5), "end_stop": (1.0, 60.0),
    "contact": (0.1, 3.0), "inertia": (0.8, 6.0), "presliding": (0.1, 0.5), "reversal_transition": (0.1, 0.5), "coulomb": (0.3, 1.5), "viscous": (0.8, 4.0),
    "gravity": (0.15, 0.8),
}
TOGETHER = {"controller_gain": (0.1, 0.5), "load_share": (0.1, 0.3)}  # a scale of all torques: no data tell one from the other
RIVALS = {"sensor_gain", "load_coefficient"}  # which a verdict must then name as `ambiguous`
EXTRA = {"stribeck", "quadratic_viscous", "friction_ripple", "gravity_phase", "elastic_spring", "torque_ripple", "contact"}  # x in N m: by gravity


def model_of(joint, rng):
    """The joint without the effect, as a model that is 1 % off."""
    off = lambda: 1 + rng.normal(0, 0.005)
    friction = {name: {"mu_c": MU * off(), "a_j": sense * joint.coulomb[side] * off(), "b_c": 0.0, "c_c": sense * 10.0, "b_j": 0.0, "c_j": sense * 10.0,
                       "d": joint.viscous[side] * off()} for side, (name, sense) in enumerate((("up", 1), ("down", -1)))}
    return {"format": "model/1", "joint": {"name": "servo", "drive": "direct", "winch_radius_m": 1.0, "pulley_radius_m": 1.0, "backlash_m": 0.0},
            "dynamics": {"gravity_nm": joint.gravity * off(), "inertia_kg_m2": joint.inertia * off()}, "friction": friction,
            "combination": {"kind": "sign"}, "effects": []}


def write(folder, joint, names, command, position, torque, law):
    """The campaign; the torque, or the controller's `law`."""
    folder.mkdir()
    text = ["format = \"campaign/1\"", "[joint]", "name = \"servo\"", "drive = \"direct\"", "[dynamics]", f"gravity_nm = {joint.gravity!r}",
            f"inertia_kg_m2 = {joint.inertia!r}", "[signal]", "torque_sign = 1", f"lowpass_hz = {LOWPASS_HZ}", f"lowpass_order = {ORDER}"]
    if law:
        text += ["[controller]"] + [f"{key} = {value!r}" for key, value in law.items()]
    text += ["[columns]", "time = { name = \"t\", unit = \"s\" }", "position = { name = \"q\", unit = \"rad\" }"]
    last = "command" if torque is None else "torque"
    text += [f"{last} = {{ name = \"{last}\", unit = \"{'rad' if torque is None else 'N m'}\" }}"]
    for i, name in enumerate(names):
        file, repeat = f"{name}_{i // (len(names) // 2) + 1}.csv", i // (len(names) // 2) + 1
        text += ["[[trials]]", f"file = \"{file}\"", "protocol = \"free\"", f"trajectory = \"{name}\"", f"repeat = {repeat}"]
        values = command[i, :: STEP_HZ // RATE_HZ] if torque is None else torque[i]
        rows = (f"{i * DURATION_S + k / RATE_HZ:.3f},{p:.6f},{y:.6f}" for k, (p, y) in enumerate(zip(position[i], values)))
        (folder / file).write_text(f"t,q,{last}\n" + "\n".join(rows) + "\n")
    (folder / "campaign.toml").write_text("\n".join(text) + "\n")


def made(effect, rng):
    """A joint with the effect at its strength, what is logged, and what it amounts to in floors."""
    command, names = commands(rng)
    joint = Joint(rng, effect, command)
    sos = butter(ORDER, LOWPASS_HZ, fs=RATE_HZ, output="sos")
    noise = joint.gravity * math.exp(rng.uniform(math.log(0.003), math.log(0.01)))
    held = rng.normal(0, 1, (len(command), command.shape[1] // 10)).repeat(10, axis=1)
    held *= noise / np.sqrt(np.mean(sosfiltfilt(sos, held[:, ::10], axis=1) ** 2))
    _, healthy = joint.follow(command, held, rng)
    once, again = np.split(sosfiltfilt(sos, healthy, axis=1), 2)
    floor = float(np.sqrt(np.mean((once - again) ** 2) / 2))
    guess, most = (SIZES | TOGETHER)[effect]
    unit = joint.gravity if effect in EXTRA else 1.0
    wanted = math.exp(rng.uniform(*map(math.log, STRENGTH)))
    x, got = guess * unit, 0.0
    if effect in TOGETHER:  # what exceeds the 5 % that the base takes up
        scale = 1.05 + wanted * floor / np.sqrt(np.mean(sosfiltfilt(sos, healthy, axis=1) ** 2))
        x = scale - 1 if effect == "controller_gain" else (1 - MU) * (1 - 1 / scale)
    for _ in range(4):
        joint.x = min(x, most * unit)
        position, torque = joint.follow(command, held, rng)
        got = joint.net(position, torque, healthy, sos) / floor
        if abs(math.log(max(got, 1e-6) / wanted)) < 0.25 or joint.x == most * unit and got < wanted:
            break
        x = joint.x * min(8.0, max(0.1, wanted / max(got, 1e-6)))
    return joint, command, names, position, torque, floor, got


def named(effect, verdict):
    if effect in TOGETHER:
        return verdict["kind"] == "ambiguous" and RIVALS <= set(verdict["effects"])
    return bool(SAME.get(effect, {effect}) & set(verdict["effects"])) and verdict["kind"] not in ("several", "unknown")


def diagnose(binary, campaign, model, out):
    words = [binary, "diagnose", campaign, "--model", model, "-o", out, "--quiet"]
    done = subprocess.run([str(w) for w in words], capture_output=True, text=True)
    if done.returncode:
        return {"kind": "failed", "effects": [], "confidence": 0.0, "why": done.stderr[:300]}
    return json.loads((out / "diagnosis.json").read_text())["verdict"]


def case(binary, number, effect, seed):
    rng = np.random.default_rng([seed, number])
    joint, command, names, position, torque, floor, strength = made(effect, rng)
    sensed = torque + rng.normal(0, 0.3, torque.shape) * floor * math.sqrt(RATE_HZ / 2 / LOWPASS_HZ)
    off = float((1 + rng.uniform(-0.02, 0.02)) * joint.declared_gain())
    law = {"stiffness_nm_rad": joint.stiffness * off, "damping_nm_s_rad": joint.damping * off, "speed_filter_s": FILTER_S}
    row = {"case": number, "effect": effect, "floors": strength, "found": {}}
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        (scratch / "model.json").write_text(json.dumps(model_of(joint, rng)))
        for form, y, told in (("torque", sensed, None), ("alone", None, law))[effect == "controller_gain" :]:
            write(scratch / form, joint, names, command, position, y, told)
            verdict = diagnose(binary, scratch / form, scratch / "model.json", scratch / f"{form}_out")
            row["found"][form] = {"kind": verdict["kind"], "effects": verdict["effects"], "confidence": verdict.get("confidence"), "named": named(effect, verdict)}
            if "why" in verdict:
                row["found"][form]["why"] = verdict["why"]
    return row


def right(found, form):
    return sum(of.get(form, {}).get("named", False) for of in found)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--cases", type=int, default=3 * (len(SIZES) + len(TOGETHER)))
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--binary", type=pathlib.Path, default=pathlib.Path("target/release/tautline"))
    parser.add_argument("--only", choices=sorted(SIZES | TOGETHER))
    parser.add_argument("--need", type=float, default=0.8, help="least share named from command and position alone")
    parser.add_argument("--json", type=pathlib.Path)
    parser.add_argument("--verbose", action="store_true")
    a = parser.parse_args()
    effects = [a.only] if a.only else sorted(SIZES) + sorted(TOGETHER)
    rows = []
    for number in range(a.cases):
        row = case(a.binary.resolve(), number, effects[number % len(effects)], a.seed)
        rows.append(row)
        if a.verbose:
            told = [f"{form}: {found['kind']} {' '.join(found['effects'])}{found.get('why', '')}" for form, found in row["found"].items()]
            print(f"{number:3} {row['effect']:24} {row['floors']:5.2f} floors  {'; '.join(told)}", flush=True)
    counted = [row for row in rows if row["floors"] >= 0.9 * STRENGTH[0]]
    for effect in effects:
        of = [row["found"] for row in counted if row["effect"] == effect]
        if of:
            print(f"{effect:24} of {len(of)}: {right(of, 'torque')} with torque, {right(of, 'alone')} alone")
    single = [row["found"] for row in counted if row["effect"] in SIZES]
    together = [row["found"] for row in counted if row["effect"] in TOGETHER]
    alone = right(single, "alone")
    print(f"at {STRENGTH[0]} floors and more named: {right(single, 'torque')} of {len(single)} with torque, {alone} from command and position alone")
    print(f"`ambiguous` where a gain cannot be told from friction: {right(together, 'alone')} of {len(together)} from command and position alone")
    if a.json:
        a.json.write_text(json.dumps(rows, indent=1))
    sys.exit(0 if alone >= a.need * len(single) and right(together, "alone") >= a.need * len(together) else 1)


if __name__ == "__main__":
    main()
