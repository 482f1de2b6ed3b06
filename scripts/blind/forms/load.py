"""The load's side and the cable: gravity, springs, inertia, other joints, stretch."""
import numpy as np

from forms.base import Form, form


@form("gravity_phase", "at_joint")
def _(rng, c):
    return Form("load", lambda st: np.cos(st.q), 0.6 * c.joint.gravity_nm)


@form("gravity_phase", "negative")
def _(rng, c):
    return Form("load", lambda st: -np.cos(st.q), 0.6 * c.joint.gravity_nm)


@form("gravity_phase", "turned")
def _(rng, c):
    """The centre of mass turned off the assumed line: the amplitude stays."""
    sign = rng.choice([-1, 1])

    def act(st, angle_rad):
        mu = [st.joint.friction[d]["mu_c"] for d in ("down", "up")]
        change = c.joint.gravity_nm * (np.sin(st.q + sign * angle_rad) - np.sin(st.q))
        return st.y + c.ratio * change / (1 - mu[0] - st.share * (mu[1] - mu[0]))

    return Form("strain", act, 0.5, False)


@form("elastic_spring", "stiffening")
def _(rng, c):
    rest, more = rng.uniform(c.low_rad, c.high_rad), rng.uniform(0.0, 0.4)

    def act(st):
        x = (st.q - rest) / c.width_rad
        return x * (1 + more * x * x)

    return Form("load", act, 4 * c.joint.gravity_nm)


@form("elastic_spring", "at_winch")
def _(rng, c):
    rest = rng.uniform(c.low_rad - 0.3 * c.width_rad, c.high_rad + 0.3 * c.width_rad)
    return Form("winch", lambda st: (st.q - rest) / c.width_rad, c.torque_span_nm)


@form("inertia", "at_joint")
def _(rng, c):
    top = max(np.abs(t.a).max() for t in c.trials)
    return Form("load", lambda st: st.a / top, 10 * c.joint.gravity_nm)


@form("inertia", "turning_pulley")
def _(rng, c):
    top, uneven, phase = max(np.abs(t.a).max() for t in c.trials), rng.uniform(0, 0.15), rng.uniform(0, 6)
    act = lambda st: st.a / top * (1 + uneven * np.sin(st.q + phase))
    return Form("winch", act, 10 * c.torque_span_nm)


@form("joint_coupling", "position")
def _(rng, c):
    phase = rng.uniform(0, 2 * np.pi)
    return Form("winch", lambda st: np.sin(st.trial.other[0] + phase), c.torque_span_nm)


@form("joint_coupling", "gravity")
def _(rng, c):
    """The base tilts with the other joint, and gravity's angle with it."""
    ratio = rng.choice([-1, 1]) * rng.uniform(0.5, 1.0)
    act = lambda st: np.sin(st.q + ratio * st.trial.other[0]) - np.sin(st.q)
    return Form("load", act, 2 * c.joint.gravity_nm)


@form("joint_coupling", "friction")
def _(rng, c):
    soft = 0.1 * max(np.abs(t.other[1]).max() for t in c.trials)
    return Form("winch", lambda st: np.tanh(st.trial.other[1] / soft), c.torque_span_nm)


@form("joint_coupling", "viscous")
def _(rng, c):
    """Cables that rub where they pass the other joint."""
    top = max(np.abs(t.other[1]).max() for t in c.trials)
    return Form("winch", lambda st: st.trial.other[1] / top, c.torque_span_nm)


@form("joint_coupling", "inertial")
def _(rng, c):
    top = max(np.abs(t.other[2]).max() for t in c.trials)
    return Form("load", lambda st: np.cos(st.q) * st.trial.other[2] / top, 5 * c.joint.gravity_nm)


@form("joint_coupling", "spring")
def _(rng, c):
    mean = np.mean([t.other[0].mean() for t in c.trials])
    return Form("winch", lambda st: st.trial.other[0] - mean * 0.8, c.torque_span_nm)




def moved(st, stretch):
    """The joint behind its measured angle by `stretch`."""
    q = st.q - stretch
    rate = st.trial.rate_hz
    v = np.gradient(q) * rate
    return q, v, np.gradient(v) * rate


@form("cable_elasticity", "hardening_by_load")
def _(rng, c):
    harder = rng.uniform(0.0, 0.5)
    top = c.joint.gravity_nm

    def act(st, s):
        load = c.joint.gravity_nm * np.sin(st.q) / top
        return moved(st, s * load / (1 + harder * np.abs(load)))

    return Form("motion", act, 0.25, False)


@form("cable_elasticity", "slack_taken_up")
def _(rng, c):
    """Stiff only once the strands lie together: the stretch grows as a root of the load."""
    power = rng.uniform(0.6, 0.9)

    def act(st, s):
        load = np.sin(st.q)
        return moved(st, s * load / np.maximum(np.abs(load), 0.02) ** (1 - power))

    return Form("motion", act, 0.25, False)


@form("cable_elasticity", "by_tension")
def _(rng, c):
    """The stretch follows the whole tension, friction included; friction follows the winch."""
    softer = rng.uniform(0.0, 0.5)

    def act(st, s):
        y = st.y
        for _ in range(3):
            relative = y / c.torque_span_nm
            stretch = s * relative / (1 + softer * np.abs(relative))
            y = st.y + c.ratio * c.joint.gravity_nm * (np.sin(st.q - stretch) - np.sin(st.q)) / (1 - c.joint.friction["up"]["mu_c"])
        return y

    return Form("strain", act, 0.3, False)
