"""Plays commands in MuJoCo and records them as a campaign of tautline: copy it, and change `command` and the names.

usage: record.py ROBOT.xml JOINT OUTPUT [--joint-class FILE] [--position-alone]

The ten lines from `for repeat` on are all there is to it; --joint-class replaces the file that ROBOT.xml includes (another joint's
friction), --position-alone leaves the torque out and declares the servo instead. Needs mujoco, numpy and the module tautline.
"""
import argparse
import pathlib

import mujoco
import numpy as np
import tautline

arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
arguments.add_argument("robot", type=pathlib.Path)
arguments.add_argument("joint")
arguments.add_argument("output")
arguments.add_argument("--joint-class", type=pathlib.Path)
arguments.add_argument("--position-alone", action="store_true")
a = arguments.parse_args()

xml = a.robot.read_text()
files = {"joint.xml": (a.joint_class or a.robot.with_name("joint.xml")).read_bytes()}
model = mujoco.MjModel.from_xml_string(xml, files)
joint = model.joint(a.joint)
RATE_HZ, SECONDS = 100, 20


def command(motion, t):
    """Where the joint is told to be, rad."""
    if motion == "slow":
        return 0.7 - 0.7 * np.cos(2 * np.pi * 0.1 * t)
    return 0.7 - 0.4 * np.cos(2 * np.pi * 0.25 * t) - 0.3 * np.cos(2 * np.pi * 0.05 * t)


trials = []
for repeat in (1, 2):
    for motion in ("slow", "mixed"):
        data, noise = mujoco.MjData(model), np.random.default_rng(len(trials))
        t, q, y = np.arange(0, SECONDS, 1 / RATE_HZ), [], []
        for now in t:
            while data.time < now:
                data.ctrl[0] = command(motion, data.time)
                mujoco.mj_step(model, data)
            q.append(data.qpos[joint.qposadr[0]])
            y.append(data.qfrc_actuator[joint.dofadr[0]] + noise.normal(0, 0.01))
        torque = {"command_rad": command(motion, t)} if a.position_alone else {"torque_nm": y}
        trials.append({"time_s": t, "position_rad": q, **torque, "protocol": "free", "trajectory": motion, "repeat": repeat})

# What is known of the joint: gravity at 90 deg and inertia as MuJoCo has them; a servo's kp and kv are its stiffness and damping.
body = model.body(joint.bodyid[0])
arm = body.ipos[2]
gravity = float(body.mass[0] * 9.81 * abs(arm))
inertia = float(body.inertia[1] + body.mass[0] * arm**2)
servo = {"stiffness_nm_rad": float(model.actuator_gainprm[0, 0]), "damping_nm_s_rad": float(-model.actuator_biasprm[0, 2])}
tautline.Campaign.from_arrays(
    trials, joint={"name": a.joint, "drive": "direct"}, dynamics={"gravity_nm": gravity, "inertia_kg_m2": inertia}, torque_sign=1,
    controller=servo if a.position_alone else None, folder=a.output)
