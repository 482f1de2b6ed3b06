#!/usr/bin/env python3
"""A servo of which only command and position were recorded: held-out error of what tautline identifies, beside the published models.

usage: scripts/real/bam.py CLONE [--binary target/release/tautline] [--held-out 400] [--keep FOLDER]

    git clone https://github.com/Rhoban/bam        (Apache-2.0; a bare clone will do)

Sixteen logs of a Dynamixel XL330 with a pendulum (0.49 kg at 0.1 m) stood in the repository at the commit below: four commands under
four gains of its position controller, 6 s each, with the models that their authors identified from them (m1, m2, m6). The servo's
law is theirs: the duty cycle is proportional to the error, the torque kt/R (V - kt dq/dt). The logs of each gain in turn are held
out of `tautline identify` and of `diagnose`, which adds to the model what the others lack; the published models may have seen
them. `lift_and_drop`, which switches the motor off, is left out.
Error: RMSE of the voltage that a model asks for along the recorded motion against the voltage that the controller gave, both low-passed,
while the joint moves (at rest dry friction holds it under many voltages). A torque would depend on each model's own kt and R, a
voltage does not. Ends with status 1 where tautline's is above the best published one. Needs NumPy and SciPy.
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

COMMIT = "af2260462471ff45ac18af159b1327ea51d8db15"
LOGS, PARAMETERS = "bam/data.bak/processed", "params/xl330"
RATE_HZ, LOWPASS_HZ, ORDER = 200.0, 8.0, 4
VIN, ERROR_GAIN = 7.4, (4096 / (2 * math.pi)) / (256 * 885)  # of the servo: volts, duty cycle per kp and rad
G = 9.80665
MOVING_RAD_S = 0.15
LAW = "m6"  # whose kt and R make the torque


def shown(clone, path):
    return subprocess.run(["git", "-C", str(clone), "show", f"{COMMIT}:{path}"], capture_output=True, text=True, check=True).stdout


def logs(clone):
    """Each log with time, command and position."""
    listed = subprocess.run(["git", "-C", str(clone), "ls-tree", "--name-only", COMMIT, f"{LOGS}/"], capture_output=True, text=True, check=True)
    for path in listed.stdout.split():
        log = json.loads(shown(clone, path))
        entries = log.pop("entries")
        if log["trajectory"] != "lift_and_drop":
            yield log, np.array([[e["timestamp"], e["goal_position"], e["position"]] for e in entries])


def law(parameters, kp):
    """The controller as campaign.toml has it."""
    gain = parameters["kt"] / parameters["R"]
    return {"stiffness_nm_rad": gain * VIN * ERROR_GAIN * kp, "damping_nm_s_rad": gain * parameters["kt"], "torque_limit_nm": gain * VIN}


def campaign(folder, recorded, parameters):
    """`recorded` as a campaign of command and position; each trial has its own gain."""
    folder.mkdir()
    own = law(parameters, recorded[0][0]["kp"])
    one = recorded[0][0]
    inertia = one["mass"] * one["length"] ** 2 + parameters["armature"]
    lines = ['format = "campaign/1"', "[joint]", 'name = "xl330"', 'drive = "direct"', "[dynamics]", f"gravity_nm = {one['mass'] * G * one['length']!r}",
             f"inertia_kg_m2 = {inertia!r}", "[signal]", "torque_sign = 1", f"lowpass_hz = {LOWPASS_HZ}", f"lowpass_order = {ORDER}", "[controller]"]
    lines += [f"{key} = {value!r}" for key, value in own.items()]
    lines += ["[columns]", 'time = { name = "t", unit = "s" }', f'position = {{ name = "q", unit = "rad", offset = {parameters["q_offset"]!r} }}',
              f'command = {{ name = "goal", unit = "rad", offset = {parameters["q_offset"]!r} }}']
    for log, values in recorded:
        name = f"{log['trajectory']}_{log['kp']}"
        here = ", ".join(f"{key} = {value!r}" for key, value in law(parameters, log["kp"]).items())
        lines += ["[[trials]]", f'file = "{name}.csv"', 'protocol = "free"', f'trajectory = "{name}"', f"controller = {{ {here} }}"]
        np.savetxt(folder / f"{name}.csv", values, "%.6f,%.9f,%.9f", header="t,goal,q", comments="")
    (folder / "campaign.toml").write_text("\n".join(lines) + "\n")


def friction(p, motor, external, v):
    """What a published model takes of the motion, N m (Duclusaud et al., ICRA 2025: Coulomb, Stribeck, load by direction)."""
    level = p["friction_base"] + 0 * v
    if "dtheta_stribeck" in p:
        slow = np.exp(-np.abs(v / p["dtheta_stribeck"]) ** p["alpha"])
        level = level + slow * p["friction_stribeck"]
    if "load_friction_motor" in p:
        level = level + np.abs(external * p["load_friction_external"] - motor * p["load_friction_motor"])
        level = level + slow * np.abs(external * p["load_friction_external_stribeck"] - motor * p["load_friction_motor_stribeck"])
        against = np.sign(external) != np.sign(motor)
        of_motor = p["load_friction_external_quad"] * external**2 * (np.abs(external) < np.abs(motor))
        of_external = p["load_friction_motor_quad"] * motor**2 * (np.abs(external) > np.abs(motor))
        level = level + slow * (of_motor + of_external) * against
    return level + p["friction_viscous"] * np.abs(v)


def published(p, log, q, v, a):
    """The drive torque that a published model asks for along the motion: its balance solved for the motor's torque."""
    inertia, external = log["mass"] * log["length"] ** 2 + p["armature"], -log["mass"] * G * log["length"] * np.sin(q + p["q_offset"])
    asked = inertia * a - external
    motor = asked.copy()
    for _ in range(60):
        motor = 0.5 * motor + 0.5 * (asked + np.sign(v) * friction(p, motor, external, v))
    return motor


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("clone", type=pathlib.Path)
    parser.add_argument("--binary", type=pathlib.Path, default=pathlib.Path("target/release/tautline"))
    parser.add_argument("--held-out", type=int, nargs="+", default=[100, 200, 400, 800], help="gains, each held out in turn")
    parser.add_argument("--keep", type=pathlib.Path)
    a = parser.parse_args()
    known = {m: json.loads(shown(a.clone, f"{PARAMETERS}/{m}.json")) for m in ("m1", "m2", "m6")}
    all_logs = list(logs(a.clone))
    sos = butter(ORDER, LOWPASS_HZ, fs=RATE_HZ, output="sos")
    squares = {name: [] for name in [*known, "tautline"]}
    with tempfile.TemporaryDirectory() as scratch:
        root = a.keep or pathlib.Path(scratch)
        root.mkdir(exist_ok=True)
        for kp in a.held_out:
            seen, unseen = [r for r in all_logs if r[0]["kp"] != kp], [r for r in all_logs if r[0]["kp"] == kp]
            campaign(root / f"seen_{kp}", seen, known[LAW])
            campaign(root / f"unseen_{kp}", unseen, known[LAW])
            run = lambda *words: subprocess.run([str(a.binary), *map(str, words), "--quiet"], check=True)
            run("identify", root / f"seen_{kp}", "-o", root / f"model_{kp}")
            run("diagnose", root / f"seen_{kp}", "--model", root / f"model_{kp}" / "model.json", "-o", root / f"found_{kp}")
            run("predict", root / f"unseen_{kp}", "--model", root / f"found_{kp}" / "model.json", "-o", root / f"predicted_{kp}")
            for log, values in unseen:
                table = np.genfromtxt(root / f"predicted_{kp}" / f"{log['trajectory']}_{kp}.csv", delimiter=",", names=True)
                t, goal, q = (np.interp(table["time_s"], values[:, 0], values[:, at]) for at in range(3))
                smooth = sosfiltfilt(butter(2, 20, fs=RATE_HZ, output="sos"), q)
                v = np.gradient(smooth, 1 / RATE_HZ)
                acceleration = np.gradient(v, 1 / RATE_HZ)
                given = np.clip(VIN * ERROR_GAIN * kp * (goal - q), -VIN, VIN)
                is_judged = (np.abs(v) > MOVING_RAD_S) & np.isfinite(table["predicted_nm"])
                is_judged[:20] = is_judged[-20:] = False
                volts = lambda p, torque: np.clip(torque * p["R"] / p["kt"] + p["kt"] * v, -VIN, VIN)
                asked = {name: volts(p, published(p, log, q, v, acceleration)) for name, p in known.items()}
                ours = np.where(np.isfinite(table["predicted_nm"]), table["predicted_nm"], table["torque_nm"])
                asked["tautline"] = volts(known[LAW], ours)
                for name, of in asked.items():
                    squares[name].append(((sosfiltfilt(sos, of) - sosfiltfilt(sos, given))[is_judged]) ** 2)
                told = ", ".join(f"{name} {math.sqrt(np.mean(of[-1])):.3f}" for name, of in squares.items())
                print(f"kp {kp:4} held out, {log['trajectory']:16} RMSE (V): {told}; {is_judged.sum()} samples in motion", flush=True)
    rmse = {name: math.sqrt(np.mean(np.concatenate(of))) for name, of in squares.items()}
    print("all: " + ", ".join(f"{name} {value:.3f} V" for name, value in rmse.items()))
    sys.exit(0 if rmse["tautline"] <= min(rmse[m] for m in known) else 1)


if __name__ == "__main__":
    main()
