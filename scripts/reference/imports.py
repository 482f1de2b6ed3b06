#!/usr/bin/env python3
"""Writes tests/reference/import/: one motion as SciPy, h5py and mcap-ros2-support write it, and as TwinCAT's Scope does.

usage: scripts/reference/imports.py        (needs numpy, scipy, h5py, mcap-ros2-support; run from the top of the project)

The Scope's files follow Beckhoff's documentation of its export (TE13xx, Export in csv; Scope 2, Export to CSV): tabulators and
decimal commas with one time for each channel, commas and points with a common time counted in 100 ns.
"""
import pathlib

import h5py
import numpy as np
from mcap_ros2.writer import Writer
from scipy.io import savemat

out = pathlib.Path("tests/reference/import")
out.mkdir(parents=True, exist_ok=True)
n = 300
t = np.arange(n) / 100.0
position_deg = np.round(40 - 20 * np.cos(2 * np.pi * t / 3.0), 6)
torque_nm = np.round(-(0.3 * np.sin(np.radians(position_deg)) + 0.1 * np.sign(np.sin(2 * np.pi * t / 3.0))), 6)
shoulder_deg = np.round(10 * np.sin(2 * np.pi * t / 3.0), 6)
np.savetxt(out / "truth.csv", np.column_stack([t, position_deg, torque_nm, shoulder_deg]), delimiter=",", fmt="%.6f",
           header="time_s,position_deg,torque_nm,shoulder_deg", comments="")

# MATLAB: a column, a row, a matrix, integers that MATLAB stores small, a text, a structure.
both = np.column_stack([torque_nm, shoulder_deg])
for compressed in (False, True):
    savemat(out / f"v5_{'compressed' if compressed else 'plain'}.mat",
            {"t": t.reshape(-1, 1), "q": position_deg.reshape(1, -1), "both": both, "count": np.arange(n, dtype=np.uint8) % 200,
             "note": "elbow", "rate_hz": 100.0, "run": {"inside": t}}, do_compression=compressed)
with h5py.File(out / "v73.mat", "w", userblock_size=512, libver="earliest") as f:
    def put(group, name, values, **more):
        data = group.create_dataset(name, data=values, **more)
        data.attrs["MATLAB_class"] = np.bytes_("double")
    put(f, "t", t.reshape(1, -1), chunks=(1, 100), compression="gzip")
    put(f, "q", position_deg.reshape(-1, 1))
    run = f.create_group("run")
    run.attrs["MATLAB_class"] = np.bytes_("struct")
    put(run, "both", both.T, chunks=(1, 300), compression="gzip", shuffle=True)
    f.create_dataset("note", data=np.frombuffer("elbow".encode("utf-16le"), dtype="<u2").reshape(-1, 1))
with open(out / "v73.mat", "r+b") as f:
    f.write(b"MATLAB 7.3 MAT-file, Platform: GLNXA64, Created on: Sat Jan  3 00:00:00 2026 HDF5 schema 1.00 .".ljust(116) + bytes(8) + b"\x00\x02IM")

# ROS 2: joint states of two joints, another topic beside.
JOINT_STATE = """std_msgs/Header header
string[] name
float64[] position
float64[] velocity
float64[] effort
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
"""
with open(out / "states.mcap", "wb") as f:
    writer = Writer(f)
    states = writer.register_msgdef("sensor_msgs/msg/JointState", JOINT_STATE)
    words = writer.register_msgdef("std_msgs/msg/String", "string data")
    for i in range(n):
        ns = 1_700_000_000_000_000_000 + i * 10_000_000
        writer.write_message("/joint_states", states, {
            "header": {"stamp": {"sec": ns // 10**9, "nanosec": ns % 10**9}, "frame_id": "base"},
            "name": ["shoulder", "elbow"], "position": np.radians([shoulder_deg[i], position_deg[i]]).tolist(),
            "velocity": [], "effort": [0.0, float(torque_nm[i])]}, log_time=ns + 123, publish_time=ns)
        if i % 100 == 0:
            writer.write_message("/rosout", words, {"data": "on"}, log_time=ns, publish_time=ns)
    writer.finish()

# TwinCAT Scope.
ticks = 133_000_000_000_000_000
channels = {"position": position_deg, "torque": torque_nm}
def twice(key, values):
    return "\t".join(cell for value in values for cell in (key, value))
lines = ["Name\tScope Project", "File\tC:\\scope\\run.csv", f"Starttime of export\t{ticks}\tSonntag, 19. Juni 2022", f"Endtime of export\t{ticks + 30_000_000}", ""]
lines += [twice("Name", channels), twice("SymbolComment", ["", ""]), twice("Data-Type", ["REAL64"] * 2), twice("SampleTime[ms]", ["10"] * 2),
          twice("VariableSize", ["8"] * 2), twice("SymbolBased", ["True"] * 2), twice("SymbolName", [f"MAIN.{name}" for name in channels]),
          twice("Offset", ["0"] * 2), twice("ScaleFactor", ["1"] * 2), twice("Unit", ["(None)"] * 2), ""]
for i in range(n):
    cells = [cell for values in channels.values() for cell in (f"{1000 * t[i]:g}", f"{values[i]:.6f}")]
    lines.append("\t".join(cells).replace(".", ","))
(out / "scope_tabs.csv").write_bytes(("\r\n".join(lines + ["EOF", ""])).encode("utf-8-sig"))
lines = ["Name,position,torque"] + [f"{ticks + i * 100_000},{position_deg[i]:.6f},{torque_nm[i]:.6f}" for i in range(n)]
(out / "scope_commas.csv").write_text("\n".join(lines) + "\n")
print(*(f"{file}: {file.stat().st_size} bytes" for file in sorted(out.iterdir())), sep="\n")
