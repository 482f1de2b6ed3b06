"""Writes a case as files: campaign.toml, CSV logs, model.json. Names, units, the sign and the encoder vary."""
import json

import numpy as np


def write_case(case, folder, rng):
    logs = folder / "campaign"
    logs.mkdir(parents=True)
    world, slide = case.world, case.base.kind == "prismatic"
    sign = int(rng.choice([-1, 1]))
    position = ("x_mm", "mm", 1000.0) if slide and rng.random() < 0.5 else ("x_m", "m", 1.0) if slide else (
        ("angle_deg", "deg", 180 / np.pi) if rng.random() < 0.5 else ("angle_rad", "rad", 1.0))
    force = ("force_n", "N", 1.0) if slide else ("torque_mnm", "mN m", 1000.0) if rng.random() < 0.3 else ("torque_nm", "N m", 1.0)
    zero = rng.uniform(0, case.encoder)
    angle = (np.round((world.q - zero) / case.encoder) * case.encoder + zero) * position[2]
    reading = sign * case.recorded * force[2]
    resolution = 10.0 ** np.floor(np.log10(case.answer["floor_nm"] * force[2] * 1e-3))
    digits = max(0, int(-np.log10(resolution)))
    for trial, s in zip(world.trials, world.slices):
        time = trial.t_s + (trial.start_s if case.clocked else 0.0)
        table, formats = [time, angle[s], reading[s]], ["%.5f", "%.8g", f"%.{digits}f"]
        header = f"time_s,{position[0]},{force[0]}"
        if trial.other is not None:
            table, formats, header = [*table, np.degrees(trial.other[:, 0])], [*formats, "%.4f"], header + ",second_joint_deg"
        np.savetxt(logs / f"{trial.name}.csv", np.column_stack(table), ",".join(formats), header=header, comments="")
    (logs / "campaign.toml").write_text(toml(case, sign, position, force))
    (folder / "model.json").write_text(json.dumps(case.written or model(case), indent=2) + "\n")


def toml(case, sign, position, force):
    b, world = case.base, case.world
    lines = [
        'format = "campaign/1"', "", "[joint]", 'name = "joint"', f'kind = "{b.kind}"', f"winch_radius_m = {float(b.r1_m)!r}",
        f"pulley_radius_m = {float(b.r2_m)!r}", f"backlash_m = {float(b.backlash_m)!r}", "", "[dynamics]", f"gravity_nm = {float(b.gravity_nm)!r}",
        f"inertia_kg_m2 = {float(b.inertia_kg_m2)!r}", "", "[signal]", f"torque_sign = {sign}", f"lowpass_hz = {float(world.lowpass_hz)!r}",
        f"lowpass_order = {world.order}", "", "[columns]", 'time = { name = "time_s", unit = "s" }',
        f'position = {{ name = "{position[0]}", unit = "{position[1]}" }}', f'torque = {{ name = "{force[0]}", unit = "{force[1]}" }}',
    ]
    if world.trials[0].other is not None:
        lines.append('other_position = { name = "second_joint_deg", unit = "deg" }')
    for trial in world.trials:
        protocol = trial.protocol if trial.protocol != "uniform" or plain_sweep(case, trial) else "free"
        lines += ["", "[[trials]]", f'file = "{trial.name}.csv"', f'protocol = "{protocol}"']
        if protocol == "uniform":
            lines.append(f"speed_rad_s = {float(trial.speed_rad_s)!r}")
        lines += [f"repeat = {trial.repeat}", f'trajectory = "{trial.trajectory}"']
    return "\n".join(lines) + "\n"


def plain_sweep(case, trial):
    """Whether a recording shows its constant speed well enough to be called a sweep: a turning joint, legs long in samples and in steps."""
    leg = np.ptp(trial.q)
    samples = leg / trial.speed_rad_s * case.world.rate_hz
    return case.base.kind == "revolute" and samples > 150 and leg / case.encoder > 5000 and case.base.backlash_m / case.base.r2_m < 0.2 * leg


def model(case):
    b = case.base
    combination = {"kind": b.curve[0]}
    if b.curve[0] == "arctan":
        combination |= {"k": float(1 / np.arctan(2 * b.curve[1])), "p": float(b.curve[1])}
    elif b.curve[0] == "power":
        combination["n"] = float(b.curve[1])
    branches = {
        d: {"mu_c": float(p["mu"]), "a_j": float(p["a"]), "b_c": 0.0, "c_c": 100.0 * s, "b_j": float(p["b"]), "c_j": float(p["c"]), "d": float(p["d"])}
        for d, s, p in (("up", 1, b.up), ("down", -1, b.down))
    }
    written = {
        "format": "model/1",
        "joint": {"name": "joint", "winch_radius_m": float(b.r1_m), "pulley_radius_m": float(b.r2_m), "backlash_m": float(b.backlash_m)},
        "dynamics": {"gravity_nm": float(b.gravity_nm), "inertia_kg_m2": float(b.inertia_kg_m2)},
        "friction": branches, "combination": combination, "effects": [],
    }
    if case.confidence is not None:
        values = b.values()
        written["confidence"] = {n: interval(values[n], *limits) for n, limits in case.confidence.items()}
    return written


def interval(value, one, other):
    low, high = min(one, other), max(one, other)
    cv = (high - low) / 2 / 1.96 / max(1e-300, abs(value))
    return {"low": float(low), "high": float(high), "cv": float(cv), "status": "pinned" if cv < 0.1 else "trade_off"}
