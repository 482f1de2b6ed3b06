#!/usr/bin/env python3
"""Writes tests/reference/chain.json: Pinocchio's inverse dynamics of several URDFs at random states, for tests/reference.rs.

usage: scripts/reference/chain.py [--check]      (needs numpy and pin; run from the top of the project)

Per case: one joint's G, M a and C v, N m (N for a slide). With --check nothing is written; it ends with status 1 when the
file is not what Pinocchio gives today.
"""
import json
import pathlib
import sys

import numpy as np
import pinocchio as pin

FILES = ["data/arm/arm.urdf", "data/robots/panda/panda.urdf", "tests/reference/tree.urdf"]
STATES = 12


def configuration(model, positions):
    """Pinocchio holds the angle of a continuous joint as its cosine and sine."""
    q = pin.neutral(model)
    for joint, position in zip(model.joints[1:], positions):
        q[joint.idx_q:joint.idx_q + joint.nq] = [np.cos(position), np.sin(position)] if joint.nq == 2 else [position]
    return q


def cases_of(file, random):
    model = pin.buildModelFromUrdf(file)
    data = model.createData()
    names = list(model.names)[1:]
    for _ in range(STATES):
        positions, speeds, accelerations = (random.uniform(-s, s, model.nv) for s in (2.5, 3.0, 20.0))
        q, zero = configuration(model, positions), np.zeros(model.nv)
        gravity = pin.rnea(model, data, q, zero, zero).copy()
        inertia = pin.rnea(model, data, q, zero, accelerations) - gravity
        coriolis = pin.rnea(model, data, q, speeds, zero) - gravity
        whole = pin.rnea(model, data, q, speeds, accelerations).copy()
        assert np.allclose(gravity + inertia + coriolis, whole, atol=1e-9)
        yield {"urdf": file, "joints": names, "positions": positions.tolist(), "velocities": speeds.tolist(),
               "accelerations": accelerations.tolist(), "gravity_nm": gravity.tolist(), "inertia_nm": inertia.tolist(),
               "coriolis_nm": coriolis.tolist()}


random = np.random.default_rng(20260301)
cases = [case for file in FILES for case in cases_of(file, random)]
out = pathlib.Path("tests/reference/chain.json")
if "--check" in sys.argv:
    stored = json.loads(out.read_text())["cases"]
    parts = ("gravity_nm", "inertia_nm", "coriolis_nm")
    off = max(np.max(np.abs(np.subtract(a[p], b[p]))) for a, b in zip(stored, cases, strict=True) for p in parts)
    print(f"{out}: {len(cases)} cases, off by at most {off:.1e} N m")
    sys.exit(int(off > 1e-10))
out.write_text(json.dumps({"pinocchio": pin.__version__, "cases": cases}) + "\n")
print(f"{out}: {len(cases)} cases")
