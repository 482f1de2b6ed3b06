"""Regressor of a serial chain: torque at one joint as a linear function of the ten inertial parameters of each link.

Newton-Euler in world axes, all samples at once: of each link mass m, first moment m c and inertia I about its frame's origin.
"""
import numpy as np

GRAVITY_M_S2 = 9.81


def about(axis, angle):
    """Rotations about a fixed axis (Rodrigues), one per sample."""
    x, y, z = axis
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    s, c = np.sin(angle)[:, None, None], np.cos(angle)[:, None, None]
    return np.eye(3) + s * k + (1 - c) * (k @ k)


def fixed(roll, pitch, yaw):
    one = lambda axis, a: about(axis, np.array([a]))[0]
    return one((0, 0, 1), yaw) @ one((0, 1, 0), pitch) @ one((1, 0, 0), roll)


def regressor(joints, q, v, a, at):
    """Columns (ten a link: m, mc xyz, Ixx Iyy Izz Ixy Ixz Iyz) of the torque at joint `at`; joints are (xyz, rpy, axis)."""
    n = len(q)
    turn, origin = np.broadcast_to(np.eye(3), (n, 3, 3)), np.zeros((n, 3))
    w, wd, acc = np.zeros((n, 3)), np.zeros((n, 3)), np.tile([0, 0, GRAVITY_M_S2], (n, 1)).astype(float)
    columns, z_at, o_at = [], None, None
    for i, (xyz, rpy, axis) in enumerate(joints):
        arm = turn @ np.array(xyz, float)
        acc = acc + np.cross(wd, arm) + np.cross(w, np.cross(w, arm))
        origin = origin + arm
        turn = turn @ fixed(*rpy) @ about(axis, q[:, i])
        z = turn @ np.array(axis, float)
        wd = wd + a[:, i : i + 1] * z + np.cross(w, v[:, i : i + 1] * z)
        w = w + v[:, i : i + 1] * z
        if i == at:
            z_at, o_at = z, origin
        if i < at:
            continue
        reach = origin - o_at
        dot = lambda moment: np.einsum("ij,ij->i", z_at, moment)
        columns.append(dot(np.cross(reach, acc)))
        for k in range(3):
            e = turn[:, :, k]
            force = np.cross(wd, e) + np.cross(w, np.cross(w, e))
            columns.append(dot(np.cross(reach, force) + np.cross(e, acc)))
        for r, c in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)):
            unit = np.zeros((3, 3))
            unit[r, c] = unit[c, r] = 1.0
            inertia = turn @ unit @ turn.transpose(0, 2, 1)
            spun = np.einsum("nij,nj->ni", inertia, w)
            columns.append(dot(np.einsum("nij,nj->ni", inertia, wd) + np.cross(w, spun)))
    return np.column_stack(columns)
