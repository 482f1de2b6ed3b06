"""Regressions on the steady sliding of the da Vinci tool drives, by direction: which part of the spindle's torque is what.

A recording's table is time, spindle angle, spindle torque, jaw torque.
"""
import numpy as np

from common import left_by, low, predicted, rms

KEPT_HZ = 500.0  # samples a second of a table
LOWPASS_HZ = 20.0
LEVEL_HZ = 5  # low-pass of torques for the regressions
THINNED = 20  # samples that count as one in them
TURN_RAD, PAST_TURN_RAD = 0.52, 0.35  # the sines' amplitude, and what a change of branch may take of it
SIDES = {1: "up", -1: "down"}


def steady(table):
    """Speed, and by direction the samples of steady sliding: a third of the stroke past a turn, not slow."""
    q = table[:, 1]
    v = np.gradient(low(q, LOWPASS_HZ, KEPT_HZ)) * KEPT_HZ
    return v, {s: (np.sign(v) == s) & (np.abs(v) > 0.3 * np.abs(v).max()) & (s * q > -TURN_RAD + PAST_TURN_RAD) for s in SIDES}


def sliding(recordings, sign):
    """Jaw torque, speed without sign and spindle torque in steady sliding one way, low-passed and thinned."""
    rows = []
    for _, _, table in recordings:
        v, moving = steady(table)
        rows.append(np.column_stack([low(table[:, 3], LEVEL_HZ, KEPT_HZ), np.abs(v), low(table[:, 2], LEVEL_HZ, KEPT_HZ)])[moving[sign]][::THINNED])
    return np.vstack(rows).T


def groups(reference, shown):
    """How much of the change of spindle torque is gain of the jaw's torque, offset by direction (Coulomb), speed; N m RMS, and factors.

    A regression by direction on steady sliding on both sets of recordings: no model of tautline in it.
    """
    def fit(recordings):
        found = {}
        for sign in SIDES:
            jaw, speed, torque = sliding(recordings, sign)
            x = np.column_stack([jaw, np.ones_like(jaw), speed])
            found[sign] = np.linalg.lstsq(x, torque, rcond=None)[0], x[:, 0].mean(), x[:, 2].mean()
        return found

    a, b = fit(reference), fit(shown)
    gain = [(b[s][0][0] - a[s][0][0]) * b[s][1] for s in SIDES]
    level = [b[s][0][1] - a[s][0][1] for s in SIDES]
    speed = [(b[s][0][2] - a[s][0][2]) * b[s][2] for s in SIDES]
    half = lambda f: (f[1][0][1] - f[-1][0][1]) / 2
    shift, opening = np.mean(level), (level[0] - level[1]) / 2
    parts = {"load_gain_nm": rms(gain), "shift_nm": abs(float(shift)), "opening_nm": abs(float(opening)), "viscous_nm": rms(speed)}
    return parts | {"half_loop_before_nm": abs(half(a)), "half_loop_after_nm": abs(half(b))}


NAMES = {"load_gain_nm": ["load_coefficient", "load_dependent_friction", "sensor_gain"],
         "shift_nm": ["coulomb", "sensor_bias"], "opening_nm": ["coulomb"],
         "viscous_nm": ["viscous", "quadratic_viscous"]}


def named(figures):
    """The causes whose part of the change is at least half of the largest part."""
    parts = {k: figures[k] for k in NAMES}
    return sorted({n for k, v in parts.items() if v >= 0.5 * max(parts.values()) for n in NAMES[k]})


def slope_by_load(recordings, sign):
    jaw, _, torque = sliding(recordings, sign)
    return float(np.linalg.lstsq(np.column_stack([jaw, np.ones_like(jaw)]), torque, rcond=None)[0][0])


def left_on_sliding(j, model, recordings):
    """RMS in N m that regressions by cause leave of a model's residual in steady sliding."""
    columns, rows = predicted(j, model, recordings), []
    for name, _, table in recordings:
        v, moving = steady(table)
        residual = columns[name]["residual_nm"]
        keep = (moving[1] | moving[-1]) & np.isfinite(residual)
        rows.append(np.column_stack([residual, table[:, 3], np.sign(v), table[:, 2]])[keep])
    gap, load, way, torque = np.vstack(rows).T
    return {"load_dependent_friction": left_by(gap, [way * load, way]), "sensor_gain": left_by(gap, [torque]),
            "coulomb": left_by(gap, [(way > 0) * 1.0, (way < 0) * 1.0]), "none": rms(gap)}
