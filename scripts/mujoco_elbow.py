#!/usr/bin/env python3
"""A gap in motion between MuJoCo and a joint that has more than its simulation.

One arm of one joint under a position controller is built twice in MuJoCo: as its simulation, for which a model.json is
written by hand from the MJCF's own numbers, and as the reality, which has one thing more (--effect). Both play the same
commands. `tautline diagnose REAL --model MODEL --simulated SIM` is told neither what nor how much; the answer stands in
answer.json, which it does not read. The script holds the verdict against it, and asks that the difference in motion is
located and mostly explained.

    pip install mujoco
    python3 scripts/mujoco_elbow.py --effect spring wall -o /tmp/mujoco --binary target/release/tautline
"""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import mujoco
import numpy as np

# Winch and pulley of the bundled elbow, m; the arm, kg, m, kg m^2; friction at the joint, N m, N m s/rad.
R1, R2 = 0.012, 0.040
MASS, LENGTH, OWN_INERTIA, GRAVITY = 0.6, 0.1175, 0.0037, 9.81
COULOMB, VISCOUS = 0.12, 0.04
# Controller at the winch, N m/rad and N m s/rad: 40 and 1.3 at the joint.
STIFFNESS, DAMPING = 40.0 * (R1 / R2) ** 2, 1.3 * (R1 / R2) ** 2
STEP_S, RATE_HZ, LOWPASS_HZ, NOISE_NM = 0.0005, 200, 5.0, 0.02

# What the reality has more: the joint's attributes, where its mass hangs, what stands in its way, the air about it; with the
# share by which a seed may change it, and the verdicts that name it.
EFFECTS = {
    "none": (lambda s: {}, {()}),
    "spring": (lambda s: {"joint": f'stiffness="{0.25 * s}" springref="30"'}, {("elastic_spring",)}),
    "mass_offset": (lambda s: {"com": (-0.02 * s, 0.0)}, {("gravity_phase",)}),
    "stop": (lambda s: {"joint": f'limited="true" range="-180 {66 / s ** 0.1:.1f}" solreflimit="-150 -1" solimplimit="0.5 0.5 0.001"'}, {("end_stop",)}),
    "wall": (lambda s: {"wall": 66 / s**0.1}, {("end_stop",)}),
    "inertia": (lambda s: {"joint": f'armature="{0.012 * s}"'}, {("inertia",)}),
    "grease": (lambda s: {"damping": VISCOUS + 0.15 * s}, {("viscous",)}),
    "air": (lambda s: {"density": 1500 * s}, {("quadratic_viscous",)}),
}


def arm(joint="", com=(0.0, 0.0), wall=None, damping=VISCOUS, density=0.0):
    """The MJCF: an arm that hangs at 0, lifted by a winch whose angle is r2/r1 times the joint's."""
    at = f"{com[0]} 0 {com[1] - LENGTH}"
    obstacle = ""
    if wall is not None:
        # A soft block that the arm's tip meets from `wall` degrees on. MuJoCo's contact takes
        # half of what pushes into it and restores slowly.
        angle, reach, radius, half = np.radians(wall), 0.22, 0.012, 0.06
        tip = np.array([-np.sin(angle), -np.cos(angle)]) * reach
        way = np.array([-np.cos(angle), np.sin(angle)])
        x, z = tip + way * (radius + half)
        obstacle = (
            f'<geom type="box" size="{half} 0.05 0.05" pos="{x} 0 {z}" euler="0 {np.degrees(angle)} 0" '
            'solref="-150 -1" solimp="0.5 0.5 0.001" friction="0.0001"/>'
        )
    return f"""
<mujoco>
  <compiler angle="degree" autolimits="false"/>
  <option timestep="{STEP_S}" gravity="0 0 -{GRAVITY}" density="{density}" integrator="implicitfast"/>
  <worldbody>
    {obstacle}
    <body>
      <joint name="elbow" type="hinge" axis="0 1 0" damping="{damping}" frictionloss="{COULOMB}"
             solreffriction="0.002 1" solimpfriction="0.99 0.999 0.001" {joint}/>
      <inertial pos="{at}" mass="{MASS}" diaginertia="{OWN_INERTIA} {OWN_INERTIA} {OWN_INERTIA / 4}"/>
      <geom type="capsule" fromto="0 0 -0.05 0 0 -0.22" size="0.012" mass="0"/>
    </body>
  </worldbody>
  <actuator>
    <position name="winch" joint="elbow" gear="{R2 / R1}" kp="{STIFFNESS}" kv="{DAMPING}"/>
  </actuator>
</mujoco>"""


def commands():
    """Trials: name, what campaign.toml says, the commanded angle over time, rad."""
    trials = []
    for speed in (0.1, 0.2, 0.4):
        for repeat in (1, 2):
            angle = sweep(speed, 0.1, 1.35, 2 if speed < 0.15 else 3)
            trials.append((f"sweep_{speed}_{repeat}", f'protocol = "uniform"\nspeed_rad_s = {speed}\nrepeat = {repeat}', angle))
    t = np.arange(0, 30, 1 / RATE_HZ)
    for repeat in (1, 2):
        waves = 0.72 - 0.35 * np.cos(1.3 * t) - 0.18 * np.cos(3.1 * t) - 0.09 * np.cos(6.1 * t)
        trials.append((f"cosine_{repeat}", f'protocol = "cosine"\nrepeat = {repeat}', waves))
    t = np.arange(0, 25, 1 / RATE_HZ)
    for repeat in (1, 2):
        waves = 0.72 + 0.45 * np.sin(0.9 * t) + 0.12 * np.sin(4.3 * t + 1)
        trials.append((f"mixed_{repeat}", f'protocol = "free"\ntrajectory = "mixed"\nrepeat = {repeat}', waves))
    return trials


def sweep(speed, low, high, cycles):
    """Back and forth at one speed, with rests of half a second at the ends and corners rounded over a tenth of one."""
    rest = [np.full(RATE_HZ // 2, low), np.full(RATE_HZ // 2, high)]
    ramp = np.arange(low, high, speed / RATE_HZ)
    angle = np.concatenate(cycles * [rest[0], ramp, rest[1], ramp[::-1]] + [rest[0]])
    kernel = np.hanning(RATE_HZ // 10 + 2)[1:-1]
    padded = np.pad(angle, len(kernel), mode="edge")
    return np.convolve(padded, kernel / kernel.sum(), mode="same")[len(kernel) : -len(kernel)]


def play(xml, angle, noise):
    """Plays the command; time, s, position, rad, and the winch's torque as its sensor reads it, N m."""
    model = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(model)
    data.qpos[0] = angle[0]
    steps = round(1 / (RATE_HZ * STEP_S))
    velocity = np.gradient(angle, 1 / RATE_HZ)
    position, torque = np.empty(len(angle)), np.empty(len(angle))
    gear = R2 / R1

    def wanted(i, share):
        """The command as the actuator takes it: its own damping acts on the speed, so the wanted speed is added to the angle."""
        j = min(i + 1, len(angle) - 1)
        mixed = [(1 - share) * x[i] + share * x[j] for x in (angle, velocity)]
        return gear * (mixed[0] + DAMPING / STIFFNESS * mixed[1])

    for _ in range(round(1.0 / STEP_S)):
        data.ctrl[0] = wanted(0, 0.0)
        mujoco.mj_step(model, data)
    for i in range(len(angle)):
        for part in range(steps):
            data.ctrl[0] = wanted(i, part / steps)
            mujoco.mj_step1(model, data)
            mujoco.mj_step2(model, data)
            if part == 0:
                torque[i] = data.actuator_force[0]
                position[i] = before if i else angle[0]
        before = data.qpos[0]
    return np.arange(len(angle)) / RATE_HZ, position, torque + noise.normal(0, NOISE_NM, len(angle))


def record(folder, xml, seed):
    """Plays all commands and writes them as a campaign."""
    folder.mkdir(parents=True)
    noise = np.random.default_rng(seed)
    lines = [HEADER]
    for name, entry, angle in commands():
        time, position, torque = play(xml, angle, noise)
        table = np.column_stack([time, np.degrees(position), torque])
        np.savetxt(folder / f"{name}.csv", table, "%.6f,%.8f,%.7f", header="time_s,position_deg,torque_nm", comments="")
        lines.append(f'[[trials]]\nfile = "{name}.csv"\n{entry}\n')
    (folder / "campaign.toml").write_text("\n".join(lines))


HEADER = f"""format = "campaign/1"

[joint]
name = "elbow"
winch_radius_m = {R1}
pulley_radius_m = {R2}
backlash_m = 0.0

[dynamics]
gravity_nm = {MASS * GRAVITY * LENGTH}
inertia_kg_m2 = {OWN_INERTIA + MASS * LENGTH**2}

[signal]
torque_sign = 1
lowpass_hz = {LOWPASS_HZ}
lowpass_order = 4

[columns]
time = {{ name = "time_s", unit = "s" }}
position = {{ name = "position_deg", unit = "deg" }}
torque = {{ name = "torque_nm", unit = "N m" }}
"""


def simulators_model():
    """The simulation as a model: frictionloss and damping at the joint are forces r1/r2 as large at the winch, over r1."""
    up = dict(mu_c=0, a_j=COULOMB / R2, b_c=0, c_c=0, b_j=0, c_j=0, d=VISCOUS / R2)
    return {
        "format": "model/1",
        "joint": {"name": "elbow", "winch_radius_m": R1, "pulley_radius_m": R2, "backlash_m": 0.0},
        "dynamics": {"gravity_nm": MASS * GRAVITY * LENGTH, "inertia_kg_m2": OWN_INERTIA + MASS * LENGTH**2},
        "friction": {"up": up, "down": {**up, "a_j": -up["a_j"]}},
        "combination": {"kind": "sign"},
        "effects": [],
    }


def tautline(binary, *arguments):
    done = subprocess.run([binary, *map(str, arguments)], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"tautline {arguments[0]} failed:\n{done.stderr}")
    return done.stdout


def judge(found, effect):
    """What is wrong with the diagnosis; nothing if it names the effect, locates the gap in motion and explains it."""
    verdict, motion = found["verdict"], found["motion"]
    named, accepted = tuple(verdict["effects"]), EFFECTS[effect][1]
    wrong = []
    if motion["simulator"]["kind"] != "none":
        wrong.append(f"the model is not the simulator's: {motion['simulator']}")
    if effect == "none":
        if verdict["kind"] != "none" or motion["is_there"]:
            wrong.append(f"nothing was withheld, yet {verdict['kind']} {named}, motion {motion['rmse_rad']} rad")
        return wrong
    if not any(set(names) <= set(named) for names in accepted):
        wrong.append(f"the verdict names {named or verdict['kind']}")
    if not (motion["is_there"] and motion["where"]):
        wrong.append("the gap in motion is not located")
    if not (motion["follows"] and motion["follows"]["share"] > 0.5):
        wrong.append(f"the gap in motion is not explained: {motion['follows']}")
    return wrong


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--effect", nargs="+", choices=EFFECTS, default=["spring", "wall"], help="what the reality has more")
    parser.add_argument("--seed", type=int, default=1, help="of noise and of the effect's size")
    parser.add_argument("-o", "--output", type=Path, help="folder to keep the campaigns in")
    parser.add_argument("--binary", default="target/release/tautline")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        folder = options.output or Path(scratch)
        sys.exit(run(folder, options))


def run(folder, options):
    record(folder / "sim", arm(), options.seed)
    model = folder / "model.json"
    model.write_text(json.dumps(simulators_model(), indent=2))
    tautline(options.binary, "evaluate", folder / "sim", "--model", model, "-o", folder / "evaluated", "--quiet")
    trials = json.loads((folder / "evaluated" / "evaluation.json").read_text())["trials"]
    rmse = max(trial["stable"]["rmse_nm"] for trial in trials)
    print(f"the model on the simulator's own log: RMSE up to {1e3 * rmse:.2f} mN m away from reversals")
    print(f"{'withheld':<12} {'verdict':<28} {'shrink':>6} {'motion':>11} {'follows':>8} {'rad/N m':>8}  where")
    failures = 0
    for effect in options.effect:
        strength = np.random.default_rng(options.seed).uniform(0.8, 1.25)
        real, out = folder / f"real_{effect}", folder / f"diagnosed_{effect}"
        record(real, arm(**EFFECTS[effect][0](strength)), options.seed + 1000)
        answer = {"effect": effect, "strength": strength, "mjcf": arm(**EFFECTS[effect][0](strength))}
        (folder / f"answer_{effect}.json").write_text(json.dumps(answer, indent=2))
        tautline(options.binary, "diagnose", real, "--model", model, "--simulated", folder / "sim", "-o", out, "--quiet")
        found = json.loads((out / "diagnosis.json").read_text())
        verdict, motion, follows = found["verdict"], found["motion"], found["motion"]["follows"] or {}
        where = motion["where"][0] if motion["where"] else {"share_of_gap": 0, "detail": "nowhere"}
        print(
            f"{effect:<12} {', '.join(verdict['effects']) or verdict['kind']:<28} {verdict['shrink'] or 0:>6.2f} "
            f"{1e3 * motion['rmse_rad']:>6.2f} mrad {100 * follows.get('share', 0):>6.0f} % "
            f"{follows.get('rad_per_nm', 0):>8.3f}  {100 * where['share_of_gap']:.0f} % by {where['detail']}"
        )
        wrong = judge(found, effect)
        failures += bool(wrong)
        for line in wrong:
            print(f"  WRONG: {line}")
    return 1 if failures else 0


if __name__ == "__main__":
    main()
