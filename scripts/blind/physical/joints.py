"""Joints to draw from, what goes stale in them, how well an identification knew them, and what else a sensor adds."""
import numpy as np
from scipy.signal import lfilter

from effect import Effect, log_uniform
from motions import Range
from plant import Base, torque

BRANCHES = ("up", "down")


def draw_span(rng, kind):
    """Range of motion and the fastest speed in it."""
    if kind == "prismatic":
        low, travel = rng.uniform(-0.2, 0.1), log_uniform(rng, 0.04, 0.4)
        return Range(low, low + travel, travel * log_uniform(rng, 0.4, 3.0))
    travel = rng.uniform(0.5, 1.6)
    low = rng.uniform(-0.9, 0.3) if rng.random() < 0.5 else rng.uniform(0.05, 0.3)
    return Range(low, low + travel, travel * log_uniform(rng, 0.4, 3.0))


def draw_base(rng, kind, span, wants):
    """A joint of any size that lacks what an effect is to add (`wants`: ids of effects and stale parameters)."""
    slide = kind == "prismatic"
    r1, r2 = (1.0, 1.0) if slide else (log_uniform(rng, 0.005, 0.03), log_uniform(rng, 0.02, 0.08))
    gravity = 0.0 if slide else log_uniform(rng, 0.08, 40.0)
    pull = log_uniform(rng, 8, 300) if slide else gravity * r1 / r2  # at the winch
    friction = pull * log_uniform(rng, 0.08, 0.7)
    capstan = log_uniform(rng, 0.03, 0.3) if not slide and (rng.random() < 0.6 or "load_coefficient" in wants) else 0.0
    dip = rng.uniform(0.1, 0.45) if "stribeck_level" in wants or ("stribeck" not in wants and rng.random() < 0.4) else 0.0
    mass = 0.0
    if "inertia" in wants or ("inertia_effect" not in wants and rng.random() < 0.6):
        acceleration = span.fastest * 4 / max(0.3, 2 * span.half / span.fastest)
        mass = pull * log_uniform(rng, 0.05, 0.6) / acceleration * (1.0 if slide else r2 / r1)
    base = {}
    for direction, s in zip(BRANCHES, (1.0, -1.0)):
        side = friction * rng.uniform(0.8, 1.25)
        base[direction] = {
            "mu": 1 - np.exp(-s * capstan), "a": s * side / r1, "b": s * dip * side / r1, "c": s * log_uniform(rng, 8, 30) / span.fastest,
            "d": side * rng.uniform(0.1, 0.8) / span.fastest / r1,
        }
    still = {"presliding", "reversal_transition"} & set(wants)
    shapes = ["linear", "arctan", "power"] if "backlash_width" in wants else ["sign", "linear", "arctan", "power"]
    shape = "sign" if still else str(rng.choice(shapes))
    curve = {"arctan": ("arctan", rng.uniform(1.0, 4.0)), "power": ("power", rng.uniform(0.4, 1.5))}.get(shape, (shape,))
    width = 2 * span.half * r2 * log_uniform(rng, 0.01, 0.08)
    return Base(kind, r1, r2, width, gravity, mass, base["up"], base["down"], curve)


# --- stale parameters: what maintenance changes

STALE = ("gravity", "coulomb", "viscous", "backlash_width", "load_coefficient", "stribeck_level", "inertia")


def stale(name, base, rng):
    """A parameter that has changed since the identification; at an amount of one by the change that was drawn."""
    sign = rng.choice([-1.0, 1.0])
    levels = {"coulomb": rng.uniform(-0.5, 1.0), "viscous": rng.uniform(-0.5, 1.0), "stribeck_level": rng.uniform(-0.7, 1.0)}
    change = levels.get(name, sign * rng.uniform(0.1, 0.5))
    if name == "backlash_width":
        change = rng.uniform(0.4, 1.5) if sign > 0 else rng.uniform(-0.7, -0.3)
    each = {d: change * rng.uniform(0.85, 1.15) for d in BRANCHES}
    key = {"coulomb": "a", "viscous": "d", "stribeck_level": "b", "load_coefficient": "mu"}.get(name)

    def act(base, amount):
        if name == "load_coefficient":
            return base.changed({f"friction.{d}.mu_c": getattr(base, d)["mu"] * (1 + 2 * each[d] * amount) for d in BRANCHES})
        if key:
            long = {"a": "a_j", "d": "d", "b": "b_j"}[key]
            return base.changed({f"friction.{d}.{long}": getattr(base, d)[key] * (1 + each[d] * amount) for d in BRANCHES})
        field = {"gravity": "gravity_nm", "inertia": "inertia_kg_m2", "backlash_width": "backlash_m"}[name]
        return base.changed({field: getattr(base, field) * (1 + change * amount)})

    least = 0.95 / max(0.2, -change) if change < 0 else np.inf
    return Effect(name, "retensioned" if name in ("coulomb", "load_coefficient", "backlash_width") else "changed", "base", act, linear=False,
                  most=min(1.6, least), notes={"relative_change_at_one": change})


def may_be(name, kind):
    """Whether a joint of this kind can have it at all."""
    return kind == "revolute" or name not in ("gravity", "load_coefficient", "gravity_phase", "cable_elasticity", "load_dependent_friction")


# --- what an identification of the joint as it was would have known

PRIOR = {"gravity_nm": 0.05, "inertia_kg_m2": 0.2, "mu_c": 0.5, "a_j": 0.3, "b_j": 0.6, "c_j": 0.4, "d": 0.5, "backlash_m": 0.25, "p": 0.3, "n": 0.3}
MORE_DATA = 2.0  # of the reference campaign against this one


def jacobian(world, base):
    """Names of the parameters that are not zero, and the torque's change by a relative change of each, low-passed, thinned."""
    here = torque(world, base)
    names = [n for n, v in base.values().items() if v != 0.0 and not (n.endswith("c_j") and base.up["b"] == 0.0)]
    values = base.values()
    columns = [world.judged(torque(world, base.changed({n: values[n] * 1.01})) - here) / 0.01 for n in names]
    return names, np.column_stack(columns)


def known(world, names, columns, floor, rng):
    """Relative standard deviations by linear least squares on a reference campaign, and a draw from them.

    A second campaign of the same motions, twice as long, with the same noise: information 2 B T independent readings, the priors of
    a drawing (`PRIOR`), and the covariance widened by a factor from 1 to 3, as no residual is white.
    """
    seconds = sum(t.t_s[-1] for t in world.trials)
    information = columns.T @ columns / len(columns) * 2 * world.lowpass_hz * seconds * MORE_DATA / floor**2
    prior = np.array([PRIOR[n.split(".")[-1]] for n in names])
    covariance = np.linalg.inv(information + np.diag(prior**-2.0)) * rng.uniform(1.0, 3.0) ** 2
    sd = np.sqrt(np.diag(covariance))
    draw = rng.multivariate_normal(np.zeros(len(names)), covariance)
    return sd, np.clip(draw, -1.96 * sd, 1.96 * sd)


# --- noise of a reading

NOISES = ("white", "coloured", "pink", "hum")


def noise(world, rng, kind):
    """One draw for the whole campaign, of unit RMS after the low-pass in the judged samples."""
    n = len(world.q)
    x = rng.normal(size=n)
    if kind == "coloured":
        pole = np.exp(-2 * np.pi * rng.uniform(0.3, 3.0) * world.lowpass_hz / world.rate_hz)
        x = lfilter([1], [1, -pole], x) * np.sqrt(1 - pole**2) + 0.3 * rng.normal(size=n)
    elif kind == "pink":
        spectrum = np.fft.rfft(x)
        f = np.maximum(np.fft.rfftfreq(n, 1 / world.rate_hz), 0.3 * world.lowpass_hz)
        x = np.fft.irfft(spectrum / np.sqrt(f), n)
    elif kind == "hum" and world.rate_hz > 60:
        x = x + rng.uniform(0.7, 3.0) * np.sin(2 * np.pi * 50.02 * world.elapsed + rng.uniform(0, 6)) + 0.3 * np.sin(2 * np.pi * 150.06 * world.elapsed)
    return x / np.sqrt(np.mean(world.judged(x) ** 2))
