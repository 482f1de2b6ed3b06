#!/usr/bin/env python3
"""Twelve folders of logs as labs have them, and how well `tautline init` understands them.

usage: scripts/lab_folders.py [--binary target/release/tautline] [--only NAME ...] [--keep FOLDER]

Each folder is recorded by `tautline simulate`, then written anew in a form of its own: German CSV, nanoseconds, motor current, a
gear, a slide, several joints, gaps and repeated rows, MATLAB, MCAP, pandas' Parquet, no column of time, 20 kHz with units in the
header. Judged: columns and units, protocols, speeds and repeats; that exactly what no data can tell is asked; and that with
the answers `validate --strict` and `identify` run without an error and find the friction that was simulated.
Ends with status 1 when fewer than 11 of 12 (of those that ran) are right. Needs scipy (MATLAB) and pandas with pyarrow (Parquet).
"""
import argparse
import csv
import json
import math
import pathlib
import struct
import subprocess
import sys
import tempfile

MODEL = json.load(open("data/elbow/truth/model.json"))
RADII = {"joint.winch_radius_m", "joint.pulley_radius_m"}
ALWAYS = {"dynamics.gravity_nm", "signal.torque_sign"}
ZERO = {"columns.position.offset"}
CABLE = ["--winch-radius-mm=12", "--pulley-radius-mm=40", "--backlash-mm=0.8"]
LOAD = ["--gravity-nm=0.6916", "--inertia-kg-m2=0.012", "--torque-sign=-1"]
TURNS = CABLE + LOAD + ["--zero=0"]


class Lab:
    """A folder in the making: `trials` of rows of (time s, position deg or m, torque N m)."""

    def __init__(self, binary, scratch, model=MODEL, rate_hz=200, speeds=5, slowest=0.05, fastest=0.4, cosines=2, extra=()):
        (scratch / "model.json").write_text(json.dumps(model))
        simulate = [binary, "simulate", "--model", scratch / "model.json", "-o", scratch / "recorded", "--rate-hz", rate_hz, "--speeds", speeds,
                    "--slowest-rad-s", slowest, "--fastest-rad-s", fastest, "--repeats", 2, "--cosines", cosines, "--noise-nm", 0.005, "--quiet", *extra]
        subprocess.run([str(word) for word in simulate], check=True)
        self.speeds = [round(slowest * (fastest / slowest) ** (i / max(speeds - 1, 1)), 4) for i in range(speeds)]
        self.cosines = cosines
        self.folder = scratch / "logs"
        self.folder.mkdir()
        self.trials = {}
        for log in sorted((scratch / "recorded").glob("*.csv")):
            rows = csv.reader(open(log))
            next(rows)
            self.trials[log.stem] = [[float(cell) for cell in row[:3]] for row in rows]

    def text(self, ending, encoding, write):
        """Writes each trial as text: `write(name, rows)` gives it."""
        for name, rows in self.trials.items():
            (self.folder / f"{name}{ending}").write_bytes(write(name, rows).encode(encoding))


def table(header, rows, separator=",", comma=False, before=""):
    body = "\n".join(separator.join(cells) for cells in rows)
    return before + header + "\n" + (body.replace(".", ",") if comma else body) + "\n"


def german(lab):
    head = "Prüfstand 3;;\nDatum 03.04.2025;;\n"
    lab.text(".csv", "latin-1", lambda _, rows: table("Zeit [s];Winkel [°];Drehmoment [mNm]",
             ((f"{t:.3f}", f"{q:.5f}", f"{1e3 * y:.3f}") for t, q, y in rows), ";", True, head))
    return {"time": "s", "position": "deg", "torque": "mN m"}, RADII | ALWAYS | ZERO, TURNS


def nanoseconds(lab):
    start = 1_700_000_000_000_000_000
    lab.text(".txt", "utf-8", lambda _, rows: table("stamp_ns\tq_rad\ttau_nm",
             ((str(start + round(1e9 * t)), f"{math.radians(q):.7f}", f"{y:.5f}") for t, q, y in rows), "\t"))
    return {"time": "ns", "position": "rad", "torque": "N m"}, RADII | ALWAYS | ZERO, TURNS


def current(lab):
    lab.text(".csv", "utf-8", lambda _, rows: table("t (ms),theta (deg),motor current (A)",
             ((f"{1e3 * t:.2f}", f"{q:.5f}", f"{y / 0.052:.5f}") for t, q, y in rows)))
    return {"time": "ms", "position": "deg", "current": "A"}, RADII | ALWAYS | ZERO, TURNS + ["--torque-constant-nm-a=0.052"]


def geared(lab):
    lab.text(".csv", "utf-8", lambda _, rows: table("Time [s],Joint Angle [rad],Motor Torque [N.m]",
             ((f"{t:.4f}", f"{math.radians(q):.7f}", f"{y:.6f}") for t, q, y in rows)))
    answers = ["--drive=gear", "--gear-ratio=50", *LOAD, "--zero=0"]
    return {"time": "s", "position": "rad", "torque": "N m"}, {"joint.gear_ratio"} | ALWAYS | ZERO, answers


def slide(lab):
    lab.text(".csv", "utf-8", lambda _, rows: table("time_s,slide_pos_mm,force_N",
             ((f"{t:.4f}", f"{1e3 * q:.5f}", f"{y:.5f}") for t, q, y in rows)))
    return {"time": "s", "position": "mm", "torque": "N"}, ALWAYS, ["--gravity-nm=0", "--torque-sign=-1"]


def several_joints(lab):
    other = lambda t: 30 * math.sin(0.7 * t)
    lab.text(".csv", "utf-8", lambda _, rows: table("time,shoulder_pos_deg,shoulder_torque_nm,elbow_pos_deg,elbow_torque_nm",
             ((f"{t:.4f}", f"{other(t):.4f}", f"{2 * math.cos(t):.4f}", f"{q:.5f}", f"{y:.5f}") for t, q, y in rows)))
    return ({"time": "s", "position": "deg", "torque": "N m", "other_position": "deg"}, RADII | ALWAYS | ZERO, ["--joint=elbow", *TURNS])


def gaps(lab):
    def write(name, rows):
        if name == "cosine_1":
            rows = rows[:20000] + rows[20080:]
        if name == "cosine_2":
            rows = rows[:9000] + [rows[8999]] + rows[9000:]
        return table("time_s,position_deg,torque_nm", ((f"{t:.4f}", f"{q:.5f}", f"{y:.5f}") for t, q, y in rows))
    lab.text(".csv", "utf-8", write)
    lab.parts = 1
    return {"time": "s", "position": "deg", "torque": "N m"}, RADII | ALWAYS | ZERO, TURNS


def matlab(lab):
    import numpy
    from scipy.io import savemat
    for name, rows in lab.trials.items():
        data = numpy.array(rows)
        savemat(lab.folder / f"{name}.mat", {"t": data[:, 0], "q_deg": data[:, 1], "tau": data[:, 2]}, do_compression=True, oned_as="column")
    return ({"time": "s", "position": "deg", "torque": "N m"}, RADII | ALWAYS | ZERO | {"columns.torque"}, TURNS + ["--torque-unit=Nm"])


def mcap(lab):
    """One JointState message a row, written by hand: MCAP without chunks, CDR little end first."""
    for name, rows in lab.trials.items():
        text = lambda of: struct.pack("<I", len(of)) + of.encode()
        record = lambda kind, body: bytes([kind]) + struct.pack("<Q", len(body)) + body
        out = [b"\x89MCAP0\r\n", record(1, text("ros2") + text("")),
               record(3, struct.pack("<H", 1) + text("sensor_msgs/msg/JointState") + text("ros2msg") + struct.pack("<I", 0)),
               record(4, struct.pack("<HH", 1, 1) + text("/joint_states") + text("cdr") + struct.pack("<I", 0))]
        for sequence, (t, q, y) in enumerate(rows):
            nanoseconds_of = 1_700_000_000_000_000_000 + round(1e9 * t)
            cdr = bytearray(struct.pack("<iI", nanoseconds_of // 10**9, nanoseconds_of % 10**9))
            def put(body, align):
                cdr.extend(bytes(-len(cdr) % align))
                cdr.extend(body)
            put(struct.pack("<I", 1) + b"\0", 4)
            put(struct.pack("<I", 1), 4)
            put(struct.pack("<I", 6) + b"elbow\0", 4)
            for values in ([math.radians(q)], [], [y]):
                put(struct.pack("<I", len(values)), 4)
                if values:
                    put(struct.pack("<d", values[0]), 8)
            message = struct.pack("<HIQQ", 1, sequence, nanoseconds_of, nanoseconds_of) + b"\0\1\0\0" + bytes(cdr)
            out.append(record(5, message))
        out += [record(15, struct.pack("<I", 0)), record(2, struct.pack("<QQI", 0, 0, 0)), b"\x89MCAP0\r\n"]
        (lab.folder / f"{name}.mcap").write_bytes(b"".join(out))
    questions = RADII | ALWAYS | ZERO | {"columns.position", "columns.torque"}
    return {"time": "s", "position": "rad", "torque": "N m"}, questions, TURNS + ["--position-unit=rad", "--torque-unit=Nm"]


def pandas_parquet(lab):
    import pandas
    for name, rows in lab.trials.items():
        frame = pandas.DataFrame(rows, columns=["time", "position", "torque [Nm]"])
        frame["note"] = "ok"
        frame["position"] = frame["position"].astype("float32")
        frame.index = frame.index + 1000
        frame.to_parquet(lab.folder / f"{name}.parquet")
    return {"time": "s", "position": "deg", "torque": "N m"}, RADII | ALWAYS | ZERO, TURNS


def no_time(lab):
    lab.text(".csv", "utf-8", lambda _, rows: table("sample,angle [deg],torque [Nm]",
             ((str(i), f"{q:.5f}", f"{y:.5f}") for i, (_, q, y) in enumerate(rows))))
    return ({"position": "deg", "torque": "N m"}, RADII | ALWAYS | ZERO | {"files.rate_hz"}, TURNS + ["--rate-hz=200"])


def fast(lab):
    lab.text(".csv", "utf-8", lambda _, rows: table("Time [us],Position [deg],Torque [N m]",
             ((f"{1e6 * t:.0f}", f"{q:.5f}", f"{y:.4f}") for t, q, y in rows)))
    return {"time": "us", "position": "deg", "torque": "N m"}, RADII | ALWAYS | ZERO, TURNS


def geared_model():
    """A gear of ratio 50: friction at the joint as a share of gravity, as the elbow has it."""
    model = json.loads(json.dumps(MODEL))
    model["joint"] = {"name": "joint", "winch_radius_m": 0.02, "pulley_radius_m": 1.0, "backlash_m": 0.01}
    for direction in ("up", "down"):
        f = model["friction"][direction]
        for key in ("a_j", "b_c", "b_j", "d"):
            f[key] *= 0.04
        f["c_c"] *= 0.04
        f["mu_c"] *= 0.5
    return model


def slide_model():
    model = geared_model()
    model["joint"] = {"name": "slide", "kind": "prismatic", "winch_radius_m": 1.0, "pulley_radius_m": 1.0, "backlash_m": 0.0005}
    model["dynamics"] = {"gravity_nm": 0.0, "inertia_kg_m2": 1.0}
    return model


FOLDERS = {
    "german_csv": (german, {}), "nanoseconds": (nanoseconds, {}), "current": (current, {}), "geared": (geared, {"model": geared_model()}),
    "slide": (slide, {"model": slide_model(), "speeds": 0, "cosines": 3}), "several_joints": (several_joints, {}), "gaps": (gaps, {}),
    "matlab": (matlab, {}), "mcap": (mcap, {"speeds": 4, "cosines": 0, "rate_hz": 100}), "pandas_parquet": (pandas_parquet, {}),
    "no_time": (no_time, {}), "fast_20khz": (fast, {"rate_hz": 20000, "speeds": 3, "slowest": 0.4, "fastest": 1.2, "cosines": 0}),
}


def tautline(binary, *words):
    return subprocess.run([binary, *map(str, words)], capture_output=True, text=True)


def faults(binary, lab, expected, questions, answers, scratch):
    """Everything that `init` got wrong, and whether the way to `identify` is open."""
    known = [option for option in answers if option.split("=")[0] in ("--joint", "--drive", "--rate-hz")]
    asked = [option for option in known if not option.startswith("--rate-hz")]
    done = tautline(binary, "init", lab.folder, "-o", scratch / "asked", "--json", *asked)
    if done.returncode:
        return [f"init: {done.stderr.strip()}"]
    found = json.loads(done.stdout)
    wrong = []
    units = {column["key"]: column["unit"] for column in found["columns"]}
    if units != expected:
        wrong.append(f"columns {units}, expected {expected}")
    keys = {question["key"] for question in found["questions"]}
    if keys != questions:
        wrong.append(f"asks {sorted(keys - questions)} too much, {sorted(questions - keys)} too little")
    refused = tautline(binary, "validate", scratch / "asked")
    if refused.returncode != 2 or "still a question" not in refused.stderr:
        wrong.append("validate accepts open questions")
    done = tautline(binary, "init", lab.folder, "-o", scratch / "campaign", "--json", *answers)
    if done.returncode:
        return wrong + [f"init with answers: {done.stderr.strip()}"]
    found = json.loads(done.stdout)
    wrong += [f"still asks {question['key']}" for question in found["questions"]]
    trials = found["trials"]
    speeds = sorted(trial["speed_rad_s"] for trial in trials if trial["protocol"] == "uniform")
    true = sorted(lab.speeds * 2)
    if len(speeds) != len(true) or any(abs(a / b - 1) > 0.02 for a, b in zip(speeds, true)):
        wrong.append(f"speeds {speeds}, expected {true}")
    others = [trial["protocol"] for trial in trials if trial["protocol"] != "uniform"]
    if len(others) != lab.cosines + getattr(lab, "parts", 0) or others.count("cosine") < lab.cosines - getattr(lab, "parts", 0):
        wrong.append(f"other trials {others}, expected {lab.cosines} cosines")
    for command in (["validate", scratch / "campaign", "--strict"], ["identify", scratch / "campaign", "-o", scratch / "identified", "--quiet"]):
        done = tautline(binary, *command)
        if done.returncode:
            wrong.append(f"{command[0]}: {done.stderr.strip()[:400]}")
    model = scratch / "identified" / "model.json"
    if lab.speeds and model.exists():
        truth = json.load(open(scratch / "model.json"))["friction"]["up"]["mu_c"]
        mu_c = json.load(open(model))["friction"]["up"]["mu_c"]
        if abs(mu_c - truth) > 0.05:
            wrong.append(f"mu_c = {mu_c:.3f}, simulated {truth:.3f}")
    return wrong


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--binary", default="target/release/tautline")
    parser.add_argument("--only", nargs="*", default=list(FOLDERS))
    parser.add_argument("--keep", type=pathlib.Path)
    a = parser.parse_args()
    right = ran = 0
    for name in a.only:
        write, settings = FOLDERS[name]
        with tempfile.TemporaryDirectory() as temporary:
            scratch = (a.keep / name) if a.keep else pathlib.Path(temporary)
            scratch.mkdir(parents=True, exist_ok=True)
            lab = Lab(a.binary, scratch, **settings)
            try:
                expected, questions, answers = write(lab)
            except ImportError as missing:
                print(f"{name:15} not run: {missing}")
                continue
            wrong = faults(a.binary, lab, expected, questions, answers, scratch)
        ran += 1
        right += not wrong
        print(f"{name:15} {'right' if not wrong else '; '.join(wrong)}", flush=True)
    print(f"{right} of {ran} right")
    sys.exit(0 if right >= min(ran, math.ceil(11 / 12 * ran)) else 1)


if __name__ == "__main__":
    main()
