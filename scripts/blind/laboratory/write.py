"""Writes a case as files: campaign.toml, CSV logs, model.json. Names, units, the sign and the clock vary."""
import json

import numpy as np

from draw import digits, pick

SLIDES = ("slide", "insertion", "z_axis")
HINGES = ("elbow", "shoulder", "wrist", "knee", "joint2", "j3", "hip")


def write_case(case, folder, rng):
    """Writes the campaign and the model into a folder."""
    logs = folder / "campaign"
    logs.mkdir(parents=True)
    setting = case.setting
    base, logged = setting.base, setting.logged
    prismatic = logged.prismatic
    sign = int(rng.choice([-1, 1]))
    degrees = not prismatic and rng.random() < 0.6
    millimetres = prismatic and rng.random() < 0.5
    joint = {"name": pick(rng, *(SLIDES if prismatic else HINGES)), "winch_radius_m": base.r1_m}
    joint |= {"pulley_radius_m": base.r2_m, "backlash_m": base.backlash_m}
    dynamics = {"gravity_nm": base.gravity_nm}
    if base.inertia_kg_m2 != 0 or rng.random() >= 0.5:
        dynamics["inertia_kg_m2"] = base.inertia_kg_m2
    (folder / "model.json").write_text(json.dumps(model(setting, joint), indent=1))
    columns = tabulate(rng, case, sign, degrees, millimetres)
    lines = campaign_lines(joint, dynamics, prismatic, sign, setting)
    lines += [f'{quantity} = {{ name = "{name}", unit = "{unit}" }}' for quantity, name, unit, _, _ in columns]
    header = ",".join(name for _, name, *_ in columns) + "\n"
    row = ",".join(form for *_, form in columns) + "\n"
    table = np.array([values for *_, values, _ in columns]).T
    for k, (s, trial) in enumerate(zip(logged.slices, setting.campaign.trials)):
        file = f"run_{k + 1:02d}.csv"
        values = table[s]
        (logs / file).write_text(header + (row * len(values)) % tuple(values.ravel().tolist()))
        lines += trial_lines(file, trial)
    (logs / "campaign.toml").write_text("\n".join(lines) + "\n")


def model(setting, joint):
    """The model file; its confidence where it declares any."""
    base = setting.base
    combination = {k: v if k == "kind" else digits(v, 8) for k, v in base.combination.items()}
    written = {
        "format": "model/1", "joint": joint,
        "dynamics": {"gravity_nm": base.gravity_nm, "inertia_kg_m2": base.inertia_kg_m2},
        "friction": {"up": base.up, "down": base.down}, "combination": combination, "effects": [],
    }
    if setting.declared:
        written["confidence"] = {n: interval(value_of(written, n), setting.widths[n]) for n in base.names()}
    return written


def value_of(written, name):
    value = written
    for key in name.split("."):
        value = value[key]
    return value


def interval(value, width):
    low, high = sorted((value * (1 - width), value * (1 + width)))
    status = "pinned" if width < 0.03 else "trade_off"
    return {"low": digits(low), "high": digits(high), "cv": digits(width / 2, 3), "status": status}


def tabulate(rng, case, sign, degrees, millimetres):
    """(quantity, name, unit, values, number format) of every column."""
    setting = case.setting
    logged = setting.logged
    prismatic = logged.prismatic
    milliseconds = rng.random() < 0.1
    time = "time_ms" if milliseconds else pick(rng, "time_s", "t", "Time")
    clock = logged.wall if rng.random() < 0.3 else logged.t
    angle_unit = "deg" if degrees else "rad"
    position = "x" if prismatic else pick(rng, "position", "q", f"angle_{angle_unit}")
    torque = "force_n" if prismatic else pick(rng, "torque_nm", "tau", "M")
    unit = ("mm" if millimetres else "m") if prismatic else angle_unit
    scale = 180 / np.pi if degrees else 1e3 if millimetres else 1
    force_unit = "N" if prismatic else "N m"
    seconds = np.round(clock * 1e3, 3) if milliseconds else np.round(clock, 6)
    columns = [
        ("time", time, "ms" if milliseconds else "s", seconds, "%.3f" if milliseconds else "%.6f"),
        ("position", position, unit, setting.angle * scale, "%.6g" if setting.counts is None else "%.8g"),
        ("torque", torque, force_unit, case.recorded * sign, "%.6g"),
    ]
    if logged.other_q is not None:
        other_degrees = rng.random() < 0.5
        other = logged.other_q * (180 / np.pi if other_degrees else 1)
        columns.append(("other_position", "q_other", "deg" if other_degrees else "rad", other, "%.6g"))
    if logged.temperature is not None:
        read = logged.temperature + 0.05 * rng.standard_normal(logged.size)
        columns.append(("temperature", "temp", "degC", read, "%.2f"))
    if logged.load is not None:
        columns.append(("load_torque", "load", force_unit, logged.load, "%.6g"))
    return columns


def campaign_lines(joint, dynamics, prismatic, sign, setting):
    """campaign.toml as far as the columns."""
    lines = ['format = "campaign/1"', "", "[joint]", f'name = "{joint["name"]}"']
    lines.append(f'kind = "{"prismatic" if prismatic else "revolute"}"')
    lines += [f"{k} = {v!r}" for k, v in joint.items() if k != "name"]
    lines += ["", "[dynamics]", *(f"{k} = {v!r}" for k, v in dynamics.items())]
    lines += ["", "[signal]", f"torque_sign = {sign}", f"lowpass_hz = {setting.campaign.lowpass_hz!r}"]
    return lines + [f"lowpass_order = {setting.order}", "", "[columns]"]


def trial_lines(file, trial):
    """One trial of campaign.toml."""
    lines = ["", "[[trials]]", f'file = "{file}"', f'protocol = "{trial["protocol"]}"']
    if "speed" in trial:
        lines.append(f"speed_rad_s = {trial['speed']!r}")
    lines.append(f"repeat = {trial['repeat']}")
    if "trajectory" in trial:
        lines.append(f'trajectory = "{trial["trajectory"]}"')
    return lines
