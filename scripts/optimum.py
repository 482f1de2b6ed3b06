#!/usr/bin/env python3
"""Whether the fit of B(v) finds the global optimum: against an exhaustive search in SciPy over random joints.

usage: scripts/optimum.py [--truths 1000] [--binary target/release/tautline]      (needs numpy, scipy)

Each truth is a joint like the paper's with noise of 0.2 to 1 mN m on B at 20 speeds, its points in random order, handed to
`tautline fit friction` as a table. The exhaustive search solves the linear part on a 200 x 200 grid of both rates over the
same limits and polishes its ten best cells with SciPy. Ends with status 1 when in more than 1 % of truths tautline's cost is
over 1 % above it.
"""
import argparse
import concurrent.futures
import json
import os
import subprocess
import sys
import tempfile

import numpy as np
from scipy.optimize import least_squares

R1, R2, GRAVITY = 0.012, 0.04, 0.6916
CAMPAIGN = f"""format = "campaign/1"
[joint]
name = "random"
winch_radius_m = {R1}
pulley_radius_m = {R2}
backlash_m = 0.0008
[dynamics]
gravity_nm = {GRAVITY}
inertia_kg_m2 = 0.0
[signal]
torque_sign = -1
lowpass_hz = 5.0
lowpass_order = 4
[columns]
time = {{ name = "t", unit = "s" }}
position = {{ name = "q", unit = "rad" }}
torque = {{ name = "y", unit = "N m" }}
[[trials]]
file = "none.csv"
protocol = "uniform"
speed_rad_s = 0.1
"""
SPEEDS = np.geomspace(0.02, 0.4, 20)
LIMITS = (0.2 / SPEEDS.max(), 5.0 / SPEEDS.min())


def project(log_rates, b):
    """Residual of the best linear part for given rates."""
    rates = np.exp(log_rates)
    columns = np.column_stack([np.ones_like(SPEEDS), SPEEDS, *(np.exp(-r * SPEEDS) for r in rates)])
    solution, *_ = np.linalg.lstsq(columns, b, rcond=None)
    return columns @ solution - b


def exhaustive(b, cells=200):
    logs = np.linspace(*np.log(LIMITS), cells)
    basis = np.exp(-np.exp(logs)[:, None] * SPEEDS)
    q, _ = np.linalg.qr(np.column_stack([np.ones_like(SPEEDS), SPEEDS]))
    clear = lambda x: x - (x @ q) @ q.T
    y, e = clear(b[None])[0], clear(basis)
    ee, ey = e @ e.T, e @ y
    i, j = np.triu_indices(cells, 1)
    determinant = ee[i, i] * ee[j, j] - ee[i, j] ** 2
    with np.errstate(divide="ignore", invalid="ignore"):
        gain = (ey[i] ** 2 * ee[j, j] - 2 * ey[i] * ey[j] * ee[i, j] + ey[j] ** 2 * ee[i, i]) / determinant
    gain[determinant < 1e-12 * ee[i, i] * ee[j, j]] = -np.inf
    costs = []
    for k in np.argsort(-gain)[:10]:
        start = np.array([logs[i[k]], logs[j[k]]])
        found = least_squares(project, start, args=(b,), bounds=np.log(LIMITS), xtol=1e-12, ftol=1e-12)
        costs.append(2 * found.cost)
    return min(costs)


def one(binary, seed):
    """tautline's cost over the exhaustive search's, less one."""
    random = np.random.default_rng(seed)
    a_nm = R1 / R2 * GRAVITY / (1 - 0.4)
    table, points = ["file,repeat,direction,speed_rad_s,samples,a_nm,b_nm,r_squared,rmse_nm"], {}
    for direction, sign in (("up", 1), ("down", -1)):
        rates = [random.uniform(10, 60), random.uniform(0.8, 12)]
        truth = random.uniform(0.3, 1) + random.uniform(0.005, 0.05) * SPEEDS
        truth = truth + sum(random.uniform(0.02, 0.2) * np.exp(-r * SPEEDS) for r in rates)
        points[direction] = sign * truth + random.normal(size=20) * random.uniform(2e-4, 1e-3)
        table += [f"none.csv,1,{direction},{float(u)!r},1000,{a_nm!r},{float(b)!r},0.9,0.02" for u, b in zip(SPEEDS, points[direction])]
    header, rows = table[0], table[1:]
    random.shuffle(rows)
    with tempfile.TemporaryDirectory() as scratch:
        open(f"{scratch}/campaign.toml", "w").write(CAMPAIGN)
        open(f"{scratch}/none.csv", "w").write("t,q,y\n")
        open(f"{scratch}/trials.csv", "w").write("\n".join([header, *rows]) + "\n")
        command = [binary, "fit", "friction", scratch, "--trials", f"{scratch}/trials.csv", "-o", f"{scratch}/o", "--json"]
        model = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)
    worse = []
    for direction, sign in (("up", 1), ("down", -1)):
        f, v = model["friction"][direction], sign * SPEEDS
        ours = R1 / (1 - f["mu_c"]) * (f["a_j"] + f["b_c"] * np.exp(-f["c_c"] * R2 * v) + f["b_j"] * np.exp(-f["c_j"] * v) + f["d"] * v)
        if abs(f["c_c"] * R2) < abs(f["c_j"]) or f["c_c"] * sign < 0 or f["c_j"] * sign < 0:
            sys.exit(f"seed {seed}: rates break the convention: {f}")
        worse.append(float(np.sum((ours - points[direction]) ** 2) / exhaustive(points[direction]) - 1))
    return worse


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--truths", type=int, default=1000)
    arguments.add_argument("--binary", default="target/release/tautline")
    a = arguments.parse_args()
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        worse = np.array([x for pair in pool.map(lambda s: one(a.binary, s), range((a.truths + 1) // 2)) for x in pair])
    good = float(np.mean(worse <= 0.01))
    print(f"{len(worse)} truths: cost within 1 % of the exhaustive search in {100 * good:.2f} %; "
          f"median {100 * np.median(worse):.3f} % above, worst {100 * worse.max():.3f} %")
    sys.exit(good < 0.99)


if __name__ == "__main__":
    main()
