"""Writes a case: campaign.toml, its logs, model.json."""
import json

import numpy as np
import polars


def write_case(case, folder, rng):
    """Files as formats.md has them; units, names, encoder and file type vary."""
    logs = folder / "campaign"
    logs.mkdir(parents=True)
    style = {
        "suffix": str(rng.choice(["parquet", "csv"], p=[0.8, 0.2])), "degrees": bool(rng.random() < 0.7), "milli": bool(rng.random() < 0.2),
        "ms": bool(rng.random() < 0.15), "sign": int(rng.choice([-1, 1])),
    }
    for i, (trial, y) in enumerate(zip(case.campaign.trials, case.recorded)):
        beside = {name: np.round(series[i], 4) for name, (_, _, series) in case.beside.items()}
        write_log(logs / f"{trial.name}.{style['suffix']}", case.campaign, trial, y, beside, style)
    (logs / "campaign.toml").write_text(campaign_toml(case, style))
    (folder / "model.json").write_text(json.dumps(model_json(case), indent=2) + "\n")


def write_log(path, campaign, trial, y, beside, style):
    clock = trial.elapsed_s if campaign.running_clock else trial.t_s
    q = np.round(trial.q / campaign.encoder_rad) * campaign.encoder_rad
    columns = {
        ("time_ms" if style["ms"] else "time_s"): np.round(clock * (1000 if style["ms"] else 1), 6),
        ("position_deg" if style["degrees"] else "position_rad"): np.round(np.degrees(q) if style["degrees"] else q, 8),
        ("torque_mnm" if style["milli"] else "torque_nm"): np.round(style["sign"] * y * (1000 if style["milli"] else 1), 7),
    }
    if trial.other is not None:
        columns["other_deg"] = np.round(np.degrees(trial.other[0]), 4)
    frame = polars.DataFrame({**columns, **beside})
    if style["suffix"] == "csv":
        frame.write_csv(path)
    else:
        frame.write_parquet(path)


def campaign_toml(case, style):
    model, campaign = case.model, case.campaign
    lines = [
        'format = "campaign/1"', "", "[joint]", 'name = "joint"', 'kind = "revolute"',
        f"winch_radius_m = {float(model.r1_m)!r}", f"pulley_radius_m = {float(model.r2_m)!r}",
        f"backlash_m = {float(model.backlash_m)!r}", "", "[dynamics]", f"gravity_nm = {float(model.gravity_nm)!r}",
        f"inertia_kg_m2 = {float(model.inertia_kg_m2)!r}", "", "[signal]", f"torque_sign = {style['sign']}", f"lowpass_hz = {campaign.lowpass_hz!r}",
        f"lowpass_order = {campaign.order}", "", "[columns]",
        'time = { name = "time_ms", unit = "ms" }' if style["ms"] else 'time = { name = "time_s", unit = "s" }',
        'position = { name = "position_deg", unit = "deg" }' if style["degrees"] else 'position = { name = "position_rad", unit = "rad" }',
        'torque = { name = "torque_mnm", unit = "mN m" }' if style["milli"] else 'torque = { name = "torque_nm", unit = "N m" }',
    ]
    if campaign.trials[0].other is not None:
        lines.append('other_position = { name = "other_deg", unit = "deg" }')
    lines += [f'{quantity} = {{ name = "{name}", unit = "{unit}" }}' for name, (quantity, unit, _) in case.beside.items()]
    for trial in campaign.trials:
        lines += ["", "[[trials]]", f'file = "{trial.name}.{style["suffix"]}"', f'protocol = "{trial.protocol}"']
        if trial.protocol == "uniform":
            lines.append(f"speed_rad_s = {float(trial.speed_rad_s)!r}")
        lines += [f"repeat = {trial.repeat}", f'trajectory = "{trial.trajectory}"']
    return "\n".join(lines) + "\n"


def model_json(case):
    model = case.model
    kind, p = model.curve
    combination = {"kind": kind}
    if kind == "arctan":
        combination.update(k=float(1 / np.arctan(2 * p)), p=float(p))
    written = {
        "format": "model/1",
        "joint": {"name": "joint", "winch_radius_m": model.r1_m, "pulley_radius_m": model.r2_m, "backlash_m": float(model.backlash_m)},
        "dynamics": {"gravity_nm": float(model.gravity_nm), "inertia_kg_m2": float(model.inertia_kg_m2)},
        "friction": {d: {n: float(v) for n, v in p.items()} for d, p in model.friction.items()},
        "combination": combination,
        "effects": [],
    }
    if case.confidence is not None:
        values = model.values()
        written["confidence"] = {n: interval(values[n], *bounds) for n, bounds in case.confidence.items()}
        if "combination.p" in case.confidence:
            written["confidence"]["combination.k"] = interval(combination["k"], *(1 / np.arctan(2 * b) for b in case.confidence["combination.p"]))
    return written


def interval(value, one, other):
    low, high = min(one, other), max(one, other)
    return {"low": float(low), "high": float(high), "cv": float((high - low) / 2 / 1.96 / abs(value)), "status": "pinned"}
