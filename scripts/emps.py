#!/usr/bin/env python3
"""Turns a download of the EMPS benchmark into a campaign: a ball-screw slide, prismatic, one reference repeated four times.

usage: scripts/emps.py DATA_EMPS.mat OUT      (needs numpy and scipy)
then:  tautline identify OUT -o emps-identified --estimate-backlash

DATA_EMPS.mat is in EMPS.zip of the nonlinear benchmarks' site (A. Janot, M. Gautier, M. Brunot, "Data Set and Reference
Models of EMPS"). Its terms do not let this project bundle it: bring your own copy. The force is the motor's, computed by the
authors' gain from the commanded voltage. The record is cut into its 6.240 s cycles in the middle of a plateau, so that no cut
falls on a reversal; the first 0.210 s, from rest, are left out. Signs and rate stay as recorded.
"""
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


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    data = loadmat(sys.argv[1])
    missing = [name for name in ("t", "qm", "vir", "gtau") if name not in data]
    if missing:
        sys.exit(f"{sys.argv[1]}: lacks {', '.join(missing)}; expected the EMPS benchmark's DATA_EMPS.mat")
    time, position, volts = (np.ravel(data[name]).astype(float) for name in ("t", "qm", "vir"))
    force = volts * float(np.ravel(data["gtau"])[0])
    out = pathlib.Path(sys.argv[2])
    out.mkdir(parents=True)
    toml = CAMPAIGN
    cycles = int(np.ceil((time[-1] - START_S) / CYCLE_S))
    for k in range(cycles):
        inside = (time >= START_S + k * CYCLE_S - 1e-9) & (time < START_S + (k + 1) * CYCLE_S - 1e-9)
        rows = np.column_stack([time[inside], position[inside], force[inside]])
        np.savetxt(out / f"cycle_{k + 1}.csv", rows, "%.3f,%.8f,%.4f", header="time_s,position_m,force_n", comments="")
        toml += TRIAL.format(k + 1)
    (out / "campaign.toml").write_text(toml)
    print(f"{out}: {cycles} cycles")


if __name__ == "__main__":
    main()
