"""The UR10e's recordings, and its arm as a chain of six links: masses and inertias by least squares on recordings without payload, as a URDF.

The log's columns are time, then six angles, six speeds and six currents.
"""
import functools
from typing import NamedTuple

import numpy as np

from chain import regressor
from common import direction, low, needed

HALF = np.pi / 2
JOINTS = [((0, 0, 0.181), (0, 0, 0), (0, 0, 1)), ((0, 0.176, 0), (0, HALF, 0), (0, 1, 0)), ((0, -0.137, 0.613), (0, 0, 0), (0, 1, 0)),
          ((0, 0, 0.571), (0, HALF, 0), (0, 1, 0)), ((0, 0.135, 0), (0, 0, 0), (0, 0, 1)), ((0, 0, 0.12), (0, 0, 0), (0, 1, 0))]  # the download's URDF
RATE_HZ, LOWPASS_HZ = 100.0, 4.0
STILL_RAD_S = 0.02
NAMES = ["shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3"]
NOMINAL = [(7.778, (0, 0, 0)), (12.93, (0, 0, 0.3065)), (3.87, (0, 0, 0.2855)), (1.96, (0, 0.135, 0)), (1.96, (0, 0, 0.12)), (0.202, (0, 0.092, 0))]  # kg, m
MASS_KG, MOMENT_KG_M, INERTIA_KG_M2 = 0.5, 0.3, 0.05  # how far a link's parameters may be from nominal, one standard deviation
LEAST_KG_M2 = 1e-3
MOTOR_KG_M2, FRICTION_NM = 5.0, 30.0
EVERY = 25  # readings that count as one: half a period of the low-pass


class Seen(NamedTuple):
    """A joint whose torque is looked at."""

    at: int
    label: str
    gain_nm_a: float  # the authors' drive gain
    noise_nm: float  # of a low-passed reading, with what no rigid arm explains


SHOULDER = Seen(1, "shoulder lift", 10.6956, 2.0)
ELBOW, WRIST = Seen(2, "elbow", 8.4566, 1.0), Seen(3, "wrist_1", 9.0029, 0.5)


class Record(NamedTuple):
    """Six joints over time, at an even rate: low-passed angles, speeds and accelerations, currents in A as read."""

    t: np.ndarray
    q: np.ndarray
    v: np.ndarray
    a: np.ndarray
    current: np.ndarray


def logged(path):
    """Time, angles, speeds and currents of the six joints, at an even rate, as read."""
    rows = np.genfromtxt(needed(path), delimiter=",")
    t = rows[:, 0] - rows[0, 0]
    keep = np.concatenate([[True], np.diff(t) > 1e-4])
    even = np.arange(0, t[-1], 1 / RATE_HZ)
    six = lambda first: np.column_stack([np.interp(even, t[keep], rows[keep, k]) for k in range(first, first + 6)])
    return even, six(1), six(7), six(13)


@functools.cache
def read(path):
    t, q, v, current = logged(path)
    q, v = low(q, 2.5 * LOWPASS_HZ, RATE_HZ), low(v, 2.5 * LOWPASS_HZ, RATE_HZ)
    return Record(t, q, v, np.gradient(v, axis=0) * RATE_HZ, current)


def torque(record, seen):
    return seen.gain_nm_a * record.current[:, seen.at]


def columns(record, at):
    speed = record.v[:, at]
    friction = np.column_stack([direction(speed, STILL_RAD_S), speed, np.ones_like(speed), record.a[:, at]])
    return np.column_stack([regressor(JOINTS, record.q, record.v, record.a, at), friction])


def nominal(at):
    """Ten parameters of each link from the joint on: thin rods and lumps at their centres of mass, with 20 cm^2 of gyration."""
    values = []
    for mass, centre in NOMINAL[at:]:
        c = np.array(centre)
        about = 0.002 * mass * np.eye(3) + steiner(mass, mass * c)
        values += [mass, *(mass * c), about[0, 0], about[1, 1], about[2, 2], about[0, 1], about[0, 2], about[1, 2]]
    return np.array(values)


def fit(records, seen):
    """Parameters of the links, friction and motor: least squares on low-passed columns, drawn to the download's nominal ones."""
    x = np.vstack([low(columns(r, seen.at), LOWPASS_HZ, RATE_HZ)[::EVERY] for r in records])
    y = np.concatenate([low(torque(r, seen), LOWPASS_HZ, RATE_HZ)[::EVERY] for r in records])
    links = len(JOINTS) - seen.at
    sd = np.array(([MASS_KG] + [MOMENT_KG_M] * 3 + [INERTIA_KG_M2] * 6) * links + [FRICTION_NM] * 3 + [MOTOR_KG_M2])
    start = np.concatenate([nominal(seen.at), np.zeros(4)])
    precision = x.T @ x / seen.noise_nm**2 + np.diag(sd**-2.0)
    return start + np.linalg.solve(precision, x.T @ (y - x @ start) / seen.noise_nm**2)


def steiner(mass, moment):
    """Inertia about a link's origin of its mass, as if it were all at its centre."""
    c = moment / mass
    return mass * (c @ c * np.eye(3) - np.outer(c, c))


def tensor(six):
    return np.array([[six[0], six[3], six[4]], [six[3], six[1], six[5]], [six[4], six[5], six[2]]])


def physical(parameters, at):
    """The same with no principal moment of inertia below `LEAST_KG_M2`: what the recordings say of the wrist's is little."""
    out = parameters.copy()
    for k in range(len(JOINTS) - at):
        p = out[10 * k : 10 * k + 10]
        moments, axes = np.linalg.eigh(tensor(p[4:]) - steiner(p[0], p[1:4]))
        t = (axes * np.maximum(moments, LEAST_KG_M2)) @ axes.T + steiner(p[0], p[1:4])
        p[4:] = t[0, 0], t[1, 1], t[2, 2], t[0, 1], t[0, 2], t[1, 2]
    return out


def urdf(parameters, at):
    """The arm with what was found; the motor's inertia at the joint turns with the link that it moves."""
    lines = ['<?xml version="1.0"?>', '<robot name="ur10e">', '  <link name="base"/>']
    found = iter(parameters[: 10 * (len(JOINTS) - at)].reshape(-1, 10))
    for k, ((xyz, rpy, axis), name) in enumerate(zip(JOINTS, NAMES)):
        words = lambda v: " ".join(f"{float(x):.9g}" for x in v)
        parent = NAMES[k - 1] + "_link" if k else "base"
        lines += [f'  <joint name="{name}" type="revolute">', f'    <parent link="{parent}"/>', f'    <child link="{name}_link"/>',
                  f'    <origin xyz="{words(xyz)}" rpy="{words(rpy)}"/>', f'    <axis xyz="{words(axis)}"/>',
                  '    <limit lower="-7" upper="7" effort="330" velocity="4"/>', "  </joint>"]
        if k < at:
            lines.append(f'  <link name="{name}_link"/>')
            continue
        m, *rest = next(found)
        c = np.array(rest[:3]) / m
        about = tensor(rest[3:]) - steiner(m, np.array(rest[:3]))
        if k == at:
            about[1, 1] += parameters[-1]
        t = {n: about[r, s] for n, r, s in (("ixx", 0, 0), ("ixy", 0, 1), ("ixz", 0, 2), ("iyy", 1, 1), ("iyz", 1, 2), ("izz", 2, 2))}
        lines += [f'  <link name="{name}_link"><inertial>', f'    <mass value="{m:.9g}"/>', f'    <origin xyz="{words(c)}" rpy="0 0 0"/>',
                  "    <inertia " + " ".join(f'{n}="{v:.9g}"' for n, v in t.items()) + "/>", "  </inertial></link>"]
    return "\n".join([*lines, "</robot>"]) + "\n"


def missed(record, parameters, seen):
    """What the arm without payload does not explain of a recording, low-passed."""
    return low(torque(record, seen) - columns(record, seen.at) @ parameters, LOWPASS_HZ, RATE_HZ)


def flange(record, at):
    """Torque by the mass (kg) and the first moments (kg m) of what the last link carries."""
    return regressor(JOINTS, record.q, record.v, record.a, at)[:, -10:-6]
