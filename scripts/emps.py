#!/usr/bin/env python3
"""Turns a download of the EMPS benchmark into a campaign: a ball-screw slide, prismatic, one reference repeated four times.

usage: scripts/emps.py DATA_EMPS.mat OUT      (needs numpy and scipy)
then:  tautline identify OUT -o emps-identified --estimate-backlash
       tautline diagnose OUT --model OUT/model.json -o emps-diagnosed      (scripts/emps_diagnose.py: on held-out cycles)

OUT/model.json is the authors' model with symmetric friction.

DATA_EMPS.mat is in EMPS.zip of the nonlinear benchmarks' site (A. Janot, M. Gautier, M. Brunot, "Data Set and Reference
Models of EMPS"). Its terms do not let this project bundle it: bring your own copy. The force is the motor's, computed by the
authors' gain from the commanded voltage. The record is cut into its 6.240 s cycles in the middle of a plateau, so that no cut
falls on a reversal; the first 0.210 s, from rest, are left out. Signs and rate stay as recorded.
"""
import json
import pathlib
import sys

import numpy as np
from scipy.io import loadmat

CYCLE_S = 6.240
START_S = 0.210
CAMPAIGN = """# EMPS, a ball-screw slide (Janot, Gautier, Brunot). inertia_kg_m2 holds the moving mass in kg.
# backlash_m is a placeholder: none is published.
format = "campaign/1"

[joint]
name = "emps_slide"
kind = "prismatic"
winch_radius_m = 1.0
pulley_radius_m = 1.0
backlash_m = 0.0001

[dynamics]
gravity_nm = 0.0
inertia_kg_m2 = 95.1089

[signal]
torque_sign = 1
lowpass_hz = 100.0
lowpass_order = 4

[columns]
time = { name = "time_s", unit = "s" }
position = { name = "position_m", unit = "m" }
torque = { name = "force_n", unit = "N" }
"""
TRIAL = """
[[trials]]
file = "cycle_{0}.csv"
protocol = "free"
trajectory = "reference"
repeat = {0}
"""
MASS_KG, VISCOUS_N_S_M, COULOMB_N, OFFSET_N = 95.1089, 203.5034, 20.3935, -3.1648  # published, with symmetric friction


def published_model():
    def branch(sign):
        shape = {"mu_c": 0.0, "b_c": 0.0, "c_c": 100.0 * sign, "b_j": 0.0, "c_j": 10.0 * sign}
        return shape | {"a_j": sign * COULOMB_N + OFFSET_N, "d": VISCOUS_N_S_M}

    return {
        "format": "model/1",
        "joint": {"name": "emps_slide", "winch_radius_m": 1.0, "pulley_radius_m": 1.0, "backlash_m": 0.0001},
        "dynamics": {"gravity_nm": 0.0, "inertia_kg_m2": MASS_KG},
        "friction": {"up": branch(1), "down": branch(-1)},
        "combination": {"kind": "sign"},
        "effects": [],
    }


def read(mat):
    """Time in s, position in m, force in N."""
    data = loadmat(mat)
    missing = [name for name in ("t", "qm", "vir", "gtau") if name not in data]
    if missing:
        sys.exit(f"{mat}: lacks {', '.join(missing)}; expected the EMPS benchmark's DATA_EMPS.mat")
    time, position, volts = (np.ravel(data[name]).astype(float) for name in ("t", "qm", "vir"))
    return time, position, volts * float(np.ravel(data["gtau"])[0])


def write(mat, out):
    """The campaign, and how many cycles it has."""
    time, position, force = read(mat)
    out.mkdir(parents=True)
    toml = CAMPAIGN
    cycles = int(np.ceil((time[-1] - START_S) / CYCLE_S))
    for k in range(cycles):
        inside = (time >= START_S + k * CYCLE_S - 1e-9) & (time < START_S + (k + 1) * CYCLE_S - 1e-9)
        rows = np.column_stack([time[inside], position[inside], force[inside]])
        np.savetxt(out / f"cycle_{k + 1}.csv", rows, "%.3f,%.8f,%.4f", header="time_s,position_m,force_n", comments="")
        toml += TRIAL.format(k + 1)
    (out / "campaign.toml").write_text(toml)
    (out / "model.json").write_text(json.dumps(published_model(), indent=2))
    return cycles


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    print(f"{sys.argv[2]}: {write(sys.argv[1], pathlib.Path(sys.argv[2]))} cycles")


if __name__ == "__main__":
    main()
