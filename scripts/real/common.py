"""What every script here writes: a case, that is a campaign, trials held out of it, a model of the joint as it was, the answer beside.

    CASE/campaign/     what `tautline diagnose` is given
    CASE/held_out/     further recordings with the same intervention, that nothing is fitted to
    CASE/model.json    identified from a reference recording without the intervention
    CASE/answer.json   what was done to the joint, the causes that name it, figures to compare with, source and licence

A recording is its name, the name of its trajectory, and a table: time_s, position, torque, then load or other joints' positions.
"""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

import numpy as np
from scipy.signal import butter, sosfiltfilt

BINARY = os.environ.get("TAUTLINE", "target/release/tautline")


def stop(message):
    sys.exit(f"{pathlib.Path(sys.argv[0]).name}: {message}")


def needed(path):
    """The path, or a word about what is missing."""
    return path if path.exists() else stop(f"{path} is missing in the download")


class Joint:
    """The unchanging part of a campaign."""

    def __init__(self, name, kind="revolute", winch_m=1.0, pulley_m=1.0, backlash_m=1e-4, gravity_nm=0.0, inertia=0.0, sign=1, lowpass_hz=5.0,
                 loaded=False, notes="", urdf=None, others=()):
        self.name, self.kind, self.notes, self.loaded, self.urdf, self.others = name, kind, notes, loaded, urdf, others
        self.winch_m, self.pulley_m, self.backlash_m = winch_m, pulley_m, backlash_m
        self.gravity_nm, self.inertia, self.sign, self.lowpass_hz = gravity_nm, inertia, sign, lowpass_hz

    def toml(self, trials):
        unit, force = ("m", "N") if self.kind == "prismatic" else ("rad", "N m")
        lines = [f"# {n}" for n in self.notes.splitlines()] + [
            'format = "campaign/1"', "", "[joint]", f'name = "{self.name}"', f'kind = "{self.kind}"', f"winch_radius_m = {self.winch_m!r}",
            f"pulley_radius_m = {self.pulley_m!r}", f"backlash_m = {self.backlash_m!r}", "", "[dynamics]", *self.dynamics(),
            "", "[signal]", f"torque_sign = {self.sign}", f"lowpass_hz = {float(self.lowpass_hz)!r}",
            "lowpass_order = 4", "", "[columns]", 'time = { name = "time_s", unit = "s" }', f'position = {{ name = "position", unit = "{unit}" }}',
            f'torque = {{ name = "torque", unit = "{force}" }}']
        if self.loaded:
            lines.append(f'load_torque = {{ name = "load", unit = "{force}" }}')
        for k, other in enumerate(self.others):
            lines.append(f'other_position{f"_{k + 1}" if k else ""} = {{ joint = "{other}", name = "{other}", unit = "rad" }}')
        for name, trajectory, repeat in trials:
            lines += ["", "[[trials]]", f'file = "{name}.csv"', 'protocol = "free"', f'trajectory = "{trajectory}"', f"repeat = {repeat}"]
        return "\n".join(lines) + "\n"


    def dynamics(self):
        if self.urdf:
            return ['urdf = "arm.urdf"', f'joint = "{self.name}"']
        return [f"gravity_nm = {float(self.gravity_nm)!r}", f"inertia_kg_m2 = {float(self.inertia)!r}"]


def campaign(folder, joint, recordings):
    """Writes a campaign of recordings: name, trajectory, columns time, position, torque (load; other joints)."""
    folder.mkdir(parents=True, exist_ok=True)
    counted, trials = {}, []
    for name, trajectory, table in recordings:
        counted[trajectory] = counted.get(trajectory, 0) + 1
        trials.append((name, trajectory, counted[trajectory]))
        head = "time_s,position,torque" + (",load" if joint.loaded else "") + "".join(f",{o}" for o in joint.others)
        np.savetxt(folder / f"{name}.csv", table, "%.8g", delimiter=",", header=head, comments="")
    (folder / "campaign.toml").write_text(joint.toml(trials))
    if joint.urdf:
        (folder / "arm.urdf").write_text(joint.urdf)
    return folder


def run(*words):
    if shutil.which(BINARY) is None:
        stop(f"{BINARY} cannot be run: build with `cargo build --release`, or name the program by the environment variable TAUTLINE")
    done = subprocess.run([str(w) for w in (BINARY, *words)], capture_output=True, text=True)
    if done.returncode not in (0, 1):
        stop(f"{' '.join(str(w) for w in words)}: {done.stderr.strip() or done.stdout.strip()}")
    return done.stdout


def identified(joint, recordings, *options):
    """The model that tautline identifies from reference recordings."""
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        campaign(scratch / "reference", joint, recordings)
        run("identify", scratch / "reference", "-o", scratch / "out", "--quiet", *options)
        return json.loads((scratch / "out" / "model.json").read_text())


def case(folder, joint, model, recordings, held_out, answer):
    """Writes a case; an existing one is replaced."""
    shutil.rmtree(folder, ignore_errors=True)
    campaign(folder / "campaign", joint, recordings)
    if held_out:
        campaign(folder / "held_out", joint, held_out)
    (folder / "model.json").write_text(json.dumps(model, indent=2) + "\n")
    (folder / "answer.json").write_text(json.dumps(answer, indent=2, default=float) + "\n")
    print(f"{folder}: {answer['done']}")


def predicted(joint, model, recordings):
    """What `tautline predict` writes, by the recordings' names: columns by name, nan where a sample has no prediction."""
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        campaign(scratch / "campaign", joint, recordings)
        (scratch / "model.json").write_text(json.dumps(model))
        run("predict", scratch / "campaign", "--model", scratch / "model.json", "-o", scratch / "out", "--quiet")
        return {name: np.genfromtxt(scratch / "out" / f"{name}.csv", delimiter=",", names=True) for name, _, _ in recordings}


def residual_rms(joint, model, recordings):
    """RMS of what a model leaves of recordings, N m (N of a slide), as read: not low-passed."""
    left = np.concatenate([columns["residual_nm"] for columns in predicted(joint, model, recordings).values()])
    return rms(left[np.isfinite(left)])


def case_with_residual(folder, joint, model, recordings, held_out, answer, before=None):
    """A case whose figures also say what its model leaves of its recordings; `before`: the same recordings, nothing injected."""
    figures = dict(answer.get("figures", {}))
    figures["raw_residual_rms_nm"] = residual_rms(joint, model, recordings)
    if before is not None:
        figures["raw_residual_rms_before_injection_nm"] = residual_rms(joint, model, before)
    case(folder, joint, model, recordings, held_out, answer | {"figures": figures})


def with_torque(table, torque):
    """The recording with another torque."""
    return np.column_stack([table[:, :2], torque, table[:, 3:]])


def changed(recordings, change):
    """Every recording after a change of its table."""
    return [(name, trajectory, change(table)) for name, trajectory, table in recordings]


def rms(x):
    return float(np.sqrt(np.mean(np.square(x))))


def low(x, hz, rate_hz, axis=0):
    return sosfiltfilt(butter(4, hz, fs=rate_hz, output="sos"), x, axis=axis)


def direction(v, still):
    """+1 and -1, passing smoothly through rest: for a regression, not for a model."""
    return np.tanh(v / still)


ALIKE = 1.05  # a rival's straight-line fit that leaves no more than this times the right cause's cannot be told from it


def explained(gap, q, torque):
    """RMS that plain regressions leave of a gap: a mass (sin q, cos q), a spring (q and a constant), a gain of all that is read."""
    one = np.ones_like(q)
    forms = {"gravity": [np.sin(q)], "gravity_phase": [np.sin(q), np.cos(q)], "elastic_spring": [q, one], "sensor_gain": [torque]}
    return {name: left_by(gap, columns) for name, columns in forms.items()}


def left_by(gap, columns):
    """RMS that least squares on these columns leaves."""
    x = np.column_stack(columns)
    return rms(gap - x @ np.linalg.lstsq(x, gap, rcond=None)[0])


def cannot_be_told_from(left, right):
    """Rivals that leave as little as the best of the right causes does."""
    best = min(left[n] for n in right)
    return sorted(n for n, v in left.items() if n not in right and v <= ALIKE * best)


def arguments(doc):
    """FOLDER_OF_DOWNLOAD and OUTPUT."""
    if len(sys.argv) != 3:
        sys.exit(doc)
    return pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
