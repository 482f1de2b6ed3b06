#!/usr/bin/env python3
"""Cases from a UR10e with a payload of known mass: the shoulder's torque from its motor current, all six joints moving.

usage: scripts/real/ur10e.py FOLDER_OF_DOWNLOAD OUTPUT      (TAUTLINE names the binary)

FOLDER_OF_DOWNLOAD is a clone of github.com/shamilmamedov/dynamic_calibration (no licence found: nothing of it is bundled). Torque is
current times the authors' drive gain (UR10E_parameters.txt). The arm is a chain of six links whose masses are found by least
squares on recordings without payload, drawn to the nominal ones; it goes into the campaign as a URDF, and tautline identifies the friction.
"""
import numpy as np

from chain import regressor
from common import Joint, arguments, cannot_be_told_from, case, direction, identified, left_by, low, needed

HALF = np.pi / 2
JOINTS = [((0, 0, 0.181), (0, 0, 0), (0, 0, 1)), ((0, 0.176, 0), (0, HALF, 0), (0, 1, 0)), ((0, -0.137, 0.613), (0, 0, 0), (0, 1, 0)),
          ((0, 0, 0.571), (0, HALF, 0), (0, 1, 0)), ((0, 0.135, 0), (0, 0, 0), (0, 0, 1)), ((0, 0, 0.12), (0, 0, 0), (0, 1, 0))]  # the download's URDF
SHOULDER = 1
GAIN_NM_A = 10.6956  # drive gain of joint 2, the authors'
RATE_HZ, LOWPASS_HZ = 100.0, 4.0
STILL_RAD_S = 0.02
NAMES = ["shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3"]
NOMINAL = [(7.778, (0, 0, 0)), (12.93, (0, 0, 0.3065)), (3.87, (0, 0, 0.2855)), (1.96, (0, 0.135, 0)), (1.96, (0, 0, 0.12)), (0.202, (0, 0.092, 0))]  # kg, m
MASS_KG, MOMENT_KG_M, INERTIA_KG_M2 = 0.5, 0.3, 0.05  # how far a link's parameters may be from nominal, one standard deviation
LEAST_KG_M2 = 1e-3
MOTOR_KG_M2, FRICTION_NM = 5.0, 30.0
NOISE_NM = 2.0  # of a low-passed reading, with what no rigid arm explains
EVERY = 25  # readings that count as one: half a period of the low-pass
UNLOADED = ["ur-20_01_31-unload", "ur-20_02_05-20sec_8harm", "ur-20_02_12-50sec_12harm", "ur-20_02_19_14harm50sec"]
CASES = [("2.805", 2.805, "ur-20_02_19_14harm50secLoad", "ur-20_01_31-load"), ("2.6", 2.6, "ur-20_01_13-load_2600", None)]
SOURCE = {"source": "github.com/shamilmamedov/dynamic_calibration (Mamedov, Mikhel, Front. Robot. AI 2020)", "licence": "none found: read from a download"}


def read(path):
    """Time, angles, speeds, accelerations of six joints, current of the shoulder, at an even rate, low-passed."""
    rows = np.genfromtxt(needed(path), delimiter=",")
    t = rows[:, 0] - rows[0, 0]
    keep = np.concatenate([[True], np.diff(t) > 1e-4])
    even = np.arange(0, t[-1], 1 / RATE_HZ)
    resampled = np.column_stack([np.interp(even, t[keep], rows[keep, k]) for k in [*range(1, 7), *range(7, 13), 13 + SHOULDER]])
    q, v = low(resampled[:, :6], 2.5 * LOWPASS_HZ, RATE_HZ), low(resampled[:, 6:12], 2.5 * LOWPASS_HZ, RATE_HZ)
    return even, q, v, np.gradient(v, axis=0) * RATE_HZ, GAIN_NM_A * resampled[:, 12]


def columns(record):
    t, q, v, a, y = record
    speed = v[:, SHOULDER]
    friction = np.column_stack([direction(speed, STILL_RAD_S), speed, np.ones_like(t), a[:, SHOULDER]])
    return np.column_stack([regressor(JOINTS, q, v, a, SHOULDER), friction])


def nominal():
    """Ten parameters of each link from the shoulder on: thin rods and lumps at their centres of mass, with 20 cm^2 of gyration."""
    values = []
    for mass, centre in NOMINAL[SHOULDER:]:
        c = np.array(centre)
        about = 0.002 * mass * np.eye(3) + steiner(mass, mass * c)
        values += [mass, *(mass * c), about[0, 0], about[1, 1], about[2, 2], about[0, 1], about[0, 2], about[1, 2]]
    return np.array(values)


def fit(records):
    """Parameters of the links, friction and motor: least squares on low-passed columns, drawn to the download's nominal ones."""
    x = np.vstack([low(columns(r), LOWPASS_HZ, RATE_HZ)[::EVERY] for r in records])
    y = np.concatenate([low(r[4], LOWPASS_HZ, RATE_HZ)[::EVERY] for r in records])
    links = len(JOINTS) - SHOULDER
    sd = np.array(([MASS_KG] + [MOMENT_KG_M] * 3 + [INERTIA_KG_M2] * 6) * links + [FRICTION_NM] * 3 + [MOTOR_KG_M2])
    start = np.concatenate([nominal(), np.zeros(4)])
    precision = x.T @ x / NOISE_NM**2 + np.diag(sd**-2.0)
    return start + np.linalg.solve(precision, x.T @ (y - x @ start) / NOISE_NM**2)


def steiner(mass, moment):
    """Inertia about a link's origin of its mass, as if it were all at its centre."""
    c = moment / mass
    return mass * (c @ c * np.eye(3) - np.outer(c, c))


def tensor(six):
    return np.array([[six[0], six[3], six[4]], [six[3], six[1], six[5]], [six[4], six[5], six[2]]])


def physical(parameters):
    """The same with no principal moment of inertia below `LEAST_KG_M2`: what the recordings say of the wrist's is little."""
    out = parameters.copy()
    for k in range(len(JOINTS) - SHOULDER):
        p = out[10 * k : 10 * k + 10]
        moments, axes = np.linalg.eigh(tensor(p[4:]) - steiner(p[0], p[1:4]))
        t = (axes * np.maximum(moments, LEAST_KG_M2)) @ axes.T + steiner(p[0], p[1:4])
        p[4:] = t[0, 0], t[1, 1], t[2, 2], t[0, 1], t[0, 2], t[1, 2]
    return out


def urdf(parameters):
    """The arm with what was found; the motor's inertia at the shoulder turns with the upper arm."""
    lines = ['<?xml version="1.0"?>', '<robot name="ur10e">', '  <link name="base"/>']
    found = iter(parameters[: 10 * (len(JOINTS) - SHOULDER)].reshape(-1, 10))
    for k, ((xyz, rpy, axis), name) in enumerate(zip(JOINTS, NAMES)):
        words = lambda v: " ".join(f"{float(x):.9g}" for x in v)
        parent = NAMES[k - 1] + "_link" if k else "base"
        lines += [f'  <joint name="{name}" type="revolute">', f'    <parent link="{parent}"/>', f'    <child link="{name}_link"/>',
                  f'    <origin xyz="{words(xyz)}" rpy="{words(rpy)}"/>', f'    <axis xyz="{words(axis)}"/>',
                  '    <limit lower="-7" upper="7" effort="330" velocity="4"/>', "  </joint>"]
        if k < SHOULDER:
            lines.append(f'  <link name="{name}_link"/>')
            continue
        m, *rest = next(found)
        c = np.array(rest[:3]) / m
        about = tensor(rest[3:]) - steiner(m, np.array(rest[:3]))
        if k == SHOULDER:
            about[1, 1] += parameters[-1]
        t = {n: about[r, s] for n, r, s in (("ixx", 0, 0), ("ixy", 0, 1), ("ixz", 0, 2), ("iyy", 1, 1), ("iyz", 1, 2), ("izz", 2, 2))}
        lines += [f'  <link name="{name}_link"><inertial>', f'    <mass value="{m:.9g}"/>', f'    <origin xyz="{words(c)}" rpy="0 0 0"/>',
                  "    <inertia " + " ".join(f'{n}="{v:.9g}"' for n, v in t.items()) + "/>", "  </inertial></link>"]
    return "\n".join([*lines, "</robot>"]) + "\n"


def table(record):
    """Time, the shoulder's angle, its torque, the other joints' angles."""
    t, q, v, a, y = record
    return np.column_stack([t, q[:, SHOULDER], y, np.delete(q, SHOULDER, axis=1)])


def main():
    download, out = arguments(__doc__)
    data = download / "dataset_ur10e" / "identification_data"
    unloaded = [read(data / f"{n}.csv") for n in UNLOADED]
    parameters = physical(fit(unloaded))
    joint = Joint(NAMES[SHOULDER], lowpass_hz=LOWPASS_HZ, urdf=urdf(parameters), others=[n for k, n in enumerate(NAMES) if k != SHOULDER],
                  notes="UR10e shoulder lift; torque is motor current times the drive gain.")
    recordings = lambda names: [(f"run_{i}", f"run_{i}", table(read(data / f"{n}.csv"))) for i, n in enumerate(names, 1)]
    model = identified(joint, recordings(UNLOADED))
    unloaded_left = float(np.sqrt(np.mean(np.concatenate([missed(r, parameters) for r in unloaded]) ** 2)))
    for name, kg, shown, unseen in CASES:
        record = read(data / f"{shown}.csv")
        extra = missed(record, parameters)
        flange = regressor(JOINTS, *record[1:4], SHOULDER)[:, -10]
        kilograms = float(flange @ extra / (flange @ flange))
        torque = low(record[4], LOWPASS_HZ, RATE_HZ)
        spring = [record[1][:, SHOULDER], np.ones_like(torque)]
        left = {"gravity": left_by(extra, [flange]), "sensor_gain": left_by(extra, [torque]), "elastic_spring": left_by(extra, spring)}
        case(out / f"ur10e_payload_{name}", joint, model, recordings([shown]), recordings([unseen]) if unseen else [], SOURCE | {
            "device": "UR10e, shoulder lift", "kind": "intervention", "done": f"payload of {kg} kg",
            "accepted": ["gravity", "inertia"],
            "cannot_be_told_from": cannot_be_told_from(left, ["gravity"]),
            "why": "a mass at the flange of a chain of six links",
            "figures": {"mass_kg": kg, "mass_by_regression_kg": kilograms, "gap_rms_nm": rms(extra), "left_by_regression_nm": left,
                        "left_without_payload_nm": unloaded_left}})


def missed(record, parameters):
    """What the arm without payload does not explain of a recording, low-passed."""
    return low(record[4] - columns(record) @ parameters, LOWPASS_HZ, RATE_HZ)


def rms(x):
    return float(np.sqrt(np.mean(np.square(x))))


if __name__ == "__main__":
    main()
