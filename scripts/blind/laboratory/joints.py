"""Joints of any size, and parameters that have moved since their model was made."""
import numpy as np

from draw import Unfit, digits, log_uniform, pick, uniform
from plant import Base

STALE = ("gravity", "coulomb", "viscous", "backlash_width", "load_coefficient", "stribeck_level", "inertia")
NEED_GRAVITY = {"gravity", "gravity_phase", "cable_elasticity", "load_dependent_friction"}
TWO_WAYS = ("coulomb", "viscous", "load_coefficient", "stribeck_level")  # with a value for either direction
PARAMETERS = {
    "gravity": ("dynamics.gravity_nm",), "inertia": ("dynamics.inertia_kg_m2",),
    "backlash_width": ("joint.backlash_m",),
    "coulomb": ("a_j",), "viscous": ("d",), "load_coefficient": ("mu_c",), "stribeck_level": ("b_c", "b_j"),
}


def draw_inertia(rng, prismatic, gravity, share, alone):
    """Of a slide as such, of a limb by its weight, of a wheel without any."""
    if prismatic:
        inertia = log_uniform(rng, 0.5, 5)
    elif gravity:
        inertia = gravity * uniform(rng, *share)
    else:
        inertia = log_uniform(rng, *alone)
    return digits(inertia, 3)


def draw_load_terms(rng, causes):
    """mu_c of either direction: as published, as a loss, small, none."""
    kinds = ("paper", "loss") if "load_coefficient" in causes else ("paper", "loss", "small", "zero")
    kind = pick(rng, *kinds)
    if kind == "paper":
        up, _ = uniform(rng, 0.1, 0.42), uniform(rng, 0.1, 0.42)
        return up, up * uniform(rng, 0.85, 1.1)
    if kind == "loss":
        return uniform(rng, 0.04, 0.2), -uniform(rng, 0.04, 0.2)
    if kind == "small":
        return uniform(rng, 0.01, 0.06), uniform(rng, 0.01, 0.06)
    return 0.0, 0.0


def draw_base(rng, campaign, causes, widest):
    """A joint in which the causes can show. `widest`: most of the clearance as a share of the range."""
    prismatic, speed = campaign.world.prismatic, campaign.speed
    r1 = r2 = 1.0
    gravity = 0.0
    if not prismatic:
        r1, r2 = digits(log_uniform(rng, 0.008, 0.03), 3), digits(log_uniform(rng, 0.025, 0.09), 3)
        weightless = rng.random() < 0.15 and not set(causes) & NEED_GRAVITY
        gravity = 0.0 if weightless else digits(log_uniform(rng, 0.2, 10), 4)
    inertia = 0.0
    if "inertia" not in causes and rng.random() >= 0.25:
        inertia = draw_inertia(rng, prismatic, gravity, (0.008, 0.035), (0.004, 0.06))
    load_terms = draw_load_terms(rng, causes)
    ratio = r1 / r2
    if gravity:
        level = ratio * gravity * uniform(rng, 0.15, 0.9)
    else:
        level = log_uniform(rng, 2, 20) if prismatic else ratio * log_uniform(rng, 0.3, 3)
    no_stribeck = "stribeck" in causes and rng.random() < 0.6
    no_stribeck = no_stribeck or rng.random() < 0.15 and "stribeck_level" not in causes
    stribeck = 0.0 if no_stribeck else uniform(rng, 0.1, 0.7)
    at_cable = uniform(rng, 0.2, 0.8) if rng.random() < 0.6 else 1.0
    slow_cable, slow_joint = speed * uniform(rng, 0.03, 0.12), speed * uniform(rng, 0.15, 0.6)
    viscous = level * uniform(rng, 0.1, 0.8) / (1.5 * speed)
    about = lambda: 1 + uniform(rng, -0.2, 0.2)
    branches = []
    for sign, mu in zip((1, -1), load_terms):
        branches.append({
            "mu_c": digits(mu, 5),
            "a_j": sign * digits(level * about() / r1, 5),
            "b_c": sign * digits(level * stribeck * at_cable * about() / r1, 5) + 0.0,
            "c_c": sign * digits(1 / slow_cable / r2 * about(), 5),
            "b_j": sign * digits(level * stribeck * (1 - at_cable) * about() / r1, 5) + 0.0,
            "c_j": sign * digits(1 / slow_joint * about(), 5),
            "d": digits(viscous * about() / r1, 5),
        })
    backlash = digits(log_uniform(rng, 0.012, widest) * campaign.span * r2, 4)
    combination = draw_combination(rng, causes, campaign.rests)
    return Base(r1, r2, gravity, inertia, backlash, *branches, combination)


def draw_combination(rng, causes, rests):
    """How the branches change: at once, in some of the campaigns without rests, else along a curve."""
    often = 0.1
    if set(causes) & {"reversal_transition", "presliding"}:
        often = 0.65
    elif "backlash_width" in causes:
        often = 0
    if not rests and rng.random() < often:
        return {"kind": "sign"}
    combination = {"kind": pick(rng, "linear", "arctan", "arctan", "power")}
    if combination["kind"] == "arctan":
        combination["p"] = digits(uniform(rng, 0.7, 3.5), 5)
        combination["k"] = 1 / np.arctan(2 * combination["p"])
    elif combination["kind"] == "power":
        combination["n"] = digits(uniform(rng, 0.5, 1.8), 4)
    return combination


def draw_stale(rng, cause, base):
    """(change of the first parameter, function of a scale to all changes by name): truth over model, less one."""
    change = uniform(rng, 0.1, 0.6)
    if rng.choice([-1, 1]) < 0:
        change = -change / (1 + change) if rng.random() < 0.5 else -change
    mode = pick(rng, "both", "both_unequal", "one") if cause in TWO_WAYS else "only"
    other = change
    if mode == "both_unequal":
        other = change * uniform(rng, 0.4, 1.6)
    elif mode == "one":
        other = 0
    other = float(np.clip(other, -0.6, 0.6))
    first, second = ("up", "down") if rng.random() < 0.5 else ("down", "up")
    if cause == "load_coefficient" and base.up["mu_c"] == 0:
        raise Unfit("no load term")

    def changes(scale):
        out = {}
        for key in PARAMETERS[cause]:
            if "." in key:
                out[key] = change * scale
            else:
                out[f"friction.{first}.{key}"] = change * scale
                out[f"friction.{second}.{key}"] = other * scale
        return {k: x for k, x in out.items() if x}

    return change, changes
