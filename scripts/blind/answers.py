"""The answer of a case: right verdicts, right places, and what could not be told from it."""
from causes import Rejected
from rivals import what_each_leaves

TELLABLE = 0.25  # floors: a rival that leaves no more than this beyond what the cause's own textbook form leaves cannot be told from it
UNKNOWN_LEFT = 0.6  # of a gap from outside the library: the least that any one cause leaves
PAIR_LEFT = 0.8  # floors: the least that any one cause leaves of a pair
SIMPLER = {"sensor_bias": ("elastic_spring", "sensor_drift", "joint_coupling")}  # these hold a constant in them: no rivals of it
TIED = {"sensor_bias": "coulomb", "sensor_gain": "load_coefficient", "load_coefficient": "sensor_gain", "coulomb": "sensor_bias"}

WHERE = {  # first regions that an honest look at the residual may name
    "reversal_transition": ["after_reversal", "low_speed", "acceleration"],
    "stribeck": ["low_speed", "after_reversal", "rest", "acceleration"],
    "load_dependent_friction": ["load", "position", "up", "down", "everywhere"],
    "friction_ripple": ["position", "up", "down", "load", "frequency", "everywhere"],
    "torque_ripple": ["position", "load", "frequency", "everywhere"],
    "cable_elasticity": ["load", "position", "after_reversal", "everywhere", "frequency"],
    "quadratic_viscous": ["high_speed", "up", "down"],
    "sensor_bias": ["everywhere", "up", "down", "position", "load"],
    "sensor_gain": ["load", "everywhere", "position", "up", "down"],
    "sensor_drift": ["time", "everywhere"],
    "time_delay": ["after_reversal", "high_speed", "acceleration", "frequency", "low_speed"],
    "gravity_phase": ["position", "load", "everywhere"],
    "inertia": ["acceleration", "high_speed", "frequency", "after_reversal", "low_speed"],
    "warm_up": ["time", "everywhere", "up", "down"],
    "joint_coupling": ["other_joint", "time", "everywhere", "frequency"],
    "contact": ["bursts", "time"],
    "elastic_spring": ["position", "load", "everywhere"],
    "saturation": ["clipped", "load", "position", "up", "down"],
    "end_stop": ["position", "load"],
    "presliding": ["after_reversal", "low_speed", "acceleration"],
    "gravity": ["load", "position", "everywhere"],
    "coulomb": ["up", "down", "everywhere", "position", "load", "low_speed", "after_reversal"],
    "viscous": ["high_speed", "up", "down"],
    "backlash_width": ["after_reversal", "low_speed", "acceleration"],
    "load_coefficient": ["load", "position", "everywhere", "up", "down"],
    "stribeck_level": ["low_speed", "after_reversal", "rest", "up", "down", "acceleration"],
}

WHERE_UNKNOWN = {
    "drag_by_position": ["high_speed", "position", "up", "down", "everywhere"],
    "centrifugal": ["high_speed", "position", "acceleration", "everywhere"],
    "relaxing_sheath": ["position", "time", "after_reversal", "high_speed", "frequency", "everywhere", "acceleration"],
    "ringing": ["after_reversal", "frequency", "low_speed", "acceleration"],
    "clockwork": ["time", "frequency", "everywhere"],
    "braking_differs": ["acceleration", "after_reversal", "everywhere", "low_speed", "high_speed"],
    "remembered_extreme": ["after_reversal", "time", "position", "up", "down", "everywhere"],
    "dead_zone": ["load", "position", "up", "down"],
    "steps_by_direction": ["position", "up", "down", "everywhere", "load"],
    "stiction_by_rest": ["rest", "low_speed", "after_reversal", "acceleration"],
    "wrap_by_stroke": ["time", "position", "load", "everywhere", "up", "down", "after_reversal"],
    "friction_lags_speed": ["acceleration", "after_reversal", "low_speed", "high_speed", "everywhere"],
    "wandering": ["time", "everywhere", "frequency", "bursts"],
}


def where(kind, names, variants):
    """First regions that count as right."""
    if kind == "unknown":
        return WHERE_UNKNOWN[variants[0]]
    return sorted({r for n in names for r in WHERE[n]})


def accepted(kind, names, variants, rival=None):
    """Verdicts that count as right."""
    if kind == "unknown" and variants == ["wandering"]:  # it does not repeat: to a judge by repeats it is noise
        return [{"kind": "unknown", "effects": []}, {"kind": "none", "effects": []}]
    if kind in ("none", "unknown"):
        return [{"kind": kind, "effects": []}]
    if kind == "pair":
        return [{"kind": "several", "effects": sorted(names)}]
    if kind == "tie":
        return [{"kind": "ambiguous", "effects": sorted([*names, rival])}]
    plain = {"kind": "stale_parameters" if kind == "stale" else "effect", "effects": list(names)}
    twin = TIED.get(names[0])
    return [plain] + ([{"kind": "ambiguous", "effects": sorted([names[0], twin])}] if twin else [])


def indistinguishable(kind, names, bench, floor_nm, net_nm, rival=None):
    """What textbook forms of every cause leave, in floors, and which causes could not be told from the one that is there.

    Rejects a draw that is no fair question: another cause explains it better, an unknown that the library does for, a tie that is none.
    """
    leaves = {n: v / floor_nm for n, v in sorted(what_each_leaves(bench).items(), key=lambda item: item[1])}
    left = {n: round(v, 3) for n, v in leaves.items()}
    if kind == "unknown":
        if min(leaves.values()) < UNKNOWN_LEFT * net_nm / floor_nm:
            raise Rejected("a cause of the library does for it")
        return left, []
    if kind == "pair":
        if min(leaves.values()) < PAIR_LEFT:
            raise Rejected("one cause does for both")
        return left, []
    own = leaves.pop(names[0], 0.0)
    rivals = {n: v for n, v in leaves.items() if n not in SIMPLER.get(names[0], ())}
    same = [n for n, v in rivals.items() if v**2 - own**2 < TELLABLE**2]
    if rival is not None and rival not in same:
        raise Rejected("no tie")
    if rival is None and min(rivals.values()) < 0.9 * own:
        raise Rejected("another cause explains it better")
    return left, same
