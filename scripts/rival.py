#!/usr/bin/env python3
"""The same protocol in a few lines of NumPy, SciPy and Polars: what one would otherwise write, to compare with.

usage: scripts/rival.py CAMPAIGN      -> JSON on standard output      (needs numpy, scipy, polars)

It reads CSV campaigns with the columns that `tautline simulate` writes, and only their sweeps.
"""
import json
import pathlib
import sys
import tomllib

import numpy as np
import polars as pl
from scipy.optimize import least_squares
from scipy.signal import butter, sosfiltfilt

STARTS = 40  # random starts of the nonlinear fit


def legs_of(campaign, folder):
    """Direction, speed, sin(theta) and filtered torque of every constant-speed leg."""
    signal = campaign["signal"]
    for trial in campaign["trials"]:
        if trial["protocol"] != "uniform":
            continue
        log = pl.read_csv(folder / trial["file"])
        time = log["time_s"].to_numpy()
        rate = (len(time) - 1) / (time[-1] - time[0])
        sections = butter(signal["lowpass_order"], signal["lowpass_hz"], fs=rate, output="sos")
        theta = np.deg2rad(log["position_deg"].to_numpy())
        torque = sosfiltfilt(sections, signal["torque_sign"] * log["torque_nm"].to_numpy())
        speed = np.gradient(sosfiltfilt(sections, theta)) * rate
        for direction, sign in (("up", 1), ("down", -1)):
            on = np.flatnonzero(np.abs(sign * speed - trial["speed_rad_s"]) < 0.05 * trial["speed_rad_s"])
            on = on[len(on) // 8 : -len(on) // 16]
            yield direction, trial["speed_rad_s"], np.sin(theta[on]), torque[on]


def fit_friction(speed, b):
    """B(v) with two exponentials, the best of many starts."""
    random = np.random.default_rng(0)

    def residual(p):
        return p[0] + p[1] * speed + p[2] * np.exp(-p[3] * speed) + p[4] * np.exp(-p[5] * speed) - b

    best = None
    for _ in range(STARTS):
        rates = np.exp(random.uniform(np.log(0.3 / speed.max()), np.log(4 / speed.min()), 2))
        start = [b.mean(), 0.0, *(random.normal(0, b.std(), 1)), rates[0], *(random.normal(0, b.std(), 1)), rates[1]]
        with np.errstate(over="ignore", invalid="ignore"):
            try:
                found = least_squares(residual, start, method="lm", x_scale=np.abs(start) + 1e-3, max_nfev=2000)
            except ValueError:
                continue
        if np.isfinite(found.cost) and (best is None or found.cost < best.cost):
            best = found
    return best


def main():
    folder = pathlib.Path(sys.argv[1])
    campaign = tomllib.loads((folder / "campaign.toml").read_text())
    legs = list(legs_of(campaign, folder))
    ratio = campaign["joint"]["winch_radius_m"] / campaign["joint"]["pulley_radius_m"]
    result = {}
    for direction in ("up", "down"):
        mine = [(speed, sine, torque) for d, speed, sine, torque in legs if d == direction]
        slopes = [np.polyfit(sine, torque, 1)[0] for _, sine, torque in mine]
        a = float(np.mean(slopes))
        b = {}
        for speed, sine, torque in mine:
            b.setdefault(speed, []).append(float(np.mean(torque - a * sine)))
        speeds = np.array(sorted(b))
        means = np.array([np.mean(b[s]) for s in speeds])
        fit = fit_friction(speeds, means)
        result[direction] = {
            "a_nm": a, "a_sd_nm": float(np.std(slopes, ddof=1)), "mu_c": 1 - ratio * campaign["dynamics"]["gravity_nm"] / a,
            "speed_rad_s": speeds.tolist(), "b_nm": means.tolist(), "rmse_nm": float(np.sqrt(2 * fit.cost / len(speeds))),
        }
    print(json.dumps(result))


if __name__ == "__main__":
    main()
