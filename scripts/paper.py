#!/usr/bin/env python3
"""The paper's experiment, simulated from its Tables II and III, beside the paper's own figures: a table in Markdown.

usage: scripts/paper.py [--binary target/release/tautline] [--seed 1] [--keep FOLDER] [--rate-hz 1000]      (needs numpy)

The joint is data/paper/model.json (radii normalised, as inferred there); the whole protocol: 20 speeds x 3, three cosine
cascades, three with the shoulder moving (data/arm), a person's touches at rest and in motion. Noise is of the size that the
paper reports: of the 0.0275 N m RMSE that its fits leave of the raw signal, about 0.022 stay behind the 5 Hz low-pass, so most of
it is slow. It is made here as a first-order process whose correlation time, 0.12 s, gives A the scatter that the paper
reports, plus white noise for the rest. What the paper's joint does beyond its model in other ways is not simulated.
"""
import argparse
import json
import pathlib
import subprocess
import tempfile

import numpy as np

SLOW_NM, WHITE_NM, CORRELATION_S = 0.0228, 0.0143, 0.12


def run(binary, *arguments):
    """One command of tautline; its JSON."""
    done = subprocess.run([binary, *map(str, arguments), "--json"], check=True, capture_output=True, text=True)
    return json.loads(done.stdout)


def add_slow_noise(folder, random, rate_hz):
    """Adds the slow part of the noise to the torque of every log, in place."""
    keep = np.exp(-1 / (CORRELATION_S * rate_hz))
    for file in sorted(folder.glob("*.csv")):
        lines = file.read_text().splitlines()
        place = lines[0].split(",").index("torque_nm")
        rows = [line.split(",") for line in lines[1:]]
        drive = random.normal(0, SLOW_NM * np.sqrt(1 - keep**2), len(rows))
        noise, level = np.empty(len(rows)), random.normal(0, SLOW_NM)
        for i, step in enumerate(drive):
            level = keep * level + step
            noise[i] = level
        for row, y in zip(rows, noise):
            row[place] = f"{float(row[place]) + y:.6f}"
        file.write_text("\n".join([lines[0], *map(",".join, rows)]) + "\n")


def simulate(binary, folder, *arguments, random, rate_hz):
    run(binary, "simulate", "--model", "data/paper/model.json", "-o", folder, "--noise-nm", WHITE_NM, "--rate-hz", rate_hz,
        *arguments)
    add_slow_noise(folder, random, rate_hz)


def with_sd(group, figure):
    return f"{group[f'{figure}_nm_mean']:.4f} ± {group[f'{figure}_nm_sd']:.4f}"


def rows_of(model, judged, multi, touched):
    """(what, the paper's figure, ours, why ours may be above) for every figure that the paper gives."""
    fit, curves = model["fit"], judged["combinations"]
    both = lambda key, digits: " / ".join(f"{fit[d][key]:.{digits}f}" for d in ("up", "down"))
    yield "A sin θ fits of the legs: R²", "0.896 / 0.765", both("leg_r_squared_mean", 3)
    yield "A sin θ fits of the legs: RMSE, N m", "0.0238 / 0.0202", both("leg_rmse_nm_mean", 4)
    yield "A, N m", "0.3510 ± 0.0126 / 0.3388 ± 0.0119", " / ".join(
        f"{fit[d]['a_nm']:.4f} ± {fit[d]['a_sd_nm']:.4f}" for d in ("up", "down")), "the noise was made to scatter A so"
    yield "B(v) fit: R²", "0.99 / 0.86", both("r_squared", 3), \
        "with the inferred radii Table II's B(v) up varies by 0.012 N m over the sweeps, far less than the paper's points"
    yield "B(v) fit: RMSE, N m", "0.0033 / 0.0024", both("rmse_nm", 4)
    yield "model against the raw signal of the legs: RMSE, N m", "0.0276 / 0.0274", both("leg_raw_rmse_nm_mean", 4)
    stable = curves["linear"]["stable"]
    yield "cosines, stable state, linear: MAE; RMSE, N m", "0.0220; 0.0298", f"{stable['mae_nm']:.4f}; {stable['rmse_nm']:.4f}"
    cosine = judged["groups"][0]
    yield "cosines, whole series, arctan: MAE, N m", "0.0349 ± 0.0033", with_sd(cosine, "mae")
    yield "cosines, whole series, arctan: RMSE, N m", "0.0429 ± 0.0045", with_sd(cosine, "rmse")
    peaks = " → ".join(f"{curves[c]['transition']['peak_nm']:.2f}" for c in ("sign", "linear", "arctan"))
    yield "peak at reversals: sign → linear → arctan, N m", "over 1 → 0.4 → 0.13", peaks, \
        "the line is farthest from Table III's curve by a third of the change of friction, here 1.2 N m; the largest of 80,000 samples of noise stands on every peak"
    arctan = model["combinations"]["arctan"]
    yield "arctan curve: k; p", "0.752; 2.011", f"{model['combination']['k']:.3f}; {model['combination']['p']:.3f}"
    yield "arctan curve: R²", "0.994", f"{arctan['r_squared']:.3f}", \
        "of the torque itself, noise included; the paper's is of normalised averages over three trials"
    group = multi["groups"][0]
    yield "with the shoulder moving, 40 to 90 deg: MAE, N m", "0.0307 ± 0.0044", with_sd(group, "mae")
    yield "with the shoulder moving, 40 to 90 deg: RMSE, N m", "0.0386 ± 0.0046", with_sd(group, "rmse")
    yield "with the shoulder moving: peak, N m", "0.33", f"{multi['overall']['transition']['peak_nm']:.2f}"
    held, moving = (next(t for t in touched["trials"] if name in t["file"]) for name in ("held", "moving"))
    yield "touched at rest: MAE; RMSE, N m", "0.1407; 0.2429", f"{held['mae_nm']:.4f}; {held['rmse_nm']:.4f}"
    yield "touched at rest: error of the peaks, N m", "0.0234", f"{held['peak_error_nm']:.4f}", \
        "Table II's Stribeck terms rise below the slowest sweep, where nothing shows them; at rest they are an offset"
    yield "touched in motion: MAE; RMSE, N m", "0.1731; 0.2513", f"{moving['mae_nm']:.4f}; {moving['rmse_nm']:.4f}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--binary", default="target/release/tautline")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--rate-hz", type=float, default=1000.0)
    parser.add_argument("--keep", type=pathlib.Path, help="folder for the campaigns and results")
    options = parser.parse_args()
    binary, random = options.binary, np.random.default_rng(options.seed)
    with tempfile.TemporaryDirectory() as scratch:
        place = options.keep or pathlib.Path(scratch)
        alone, arm = place / "alone", place / "arm"
        shared = {"random": random, "rate_hz": options.rate_hz}
        simulate(binary, alone, "--interactions", 1, "--seed", options.seed, **shared)
        simulate(binary, arm, "--urdf", "data/arm/arm.urdf", "--joint", "elbow_flexion", "--multi-joint", 3, "--speeds", 0,
                 "--cosines", 0, "--seed", options.seed + 1, **shared)
        model = run(binary, "identify", alone, "-o", place / "model")
        file = place / "model" / "model.json"
        judged = run(binary, "evaluate", alone, "--model", file, "-o", place / "judged")
        multi = run(binary, "evaluate", arm, "--model", file, "-o", place / "multi")
        touched = run(binary, "interaction", alone, "--model", file, "-o", place / "touched")
    print("| figure (up / down) | the paper, its hardware | tautline, simulated | where ours is larger |\n|---|---|---|---|")
    for what, paper, ours, *why in rows_of(model, judged, multi, touched):
        print("| " + " | ".join([what, paper, ours, *(why or [""])]) + " |")


main()
