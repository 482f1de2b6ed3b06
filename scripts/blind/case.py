"""Builds one case: a joint, its campaign, what is wrong with its model, and the answer."""
import dataclasses

import numpy as np
from scipy.signal import lfilter

import campaign as draw
from forms import FORMS, Form
from measure import Absorber, Ruler, bounded, held_out_shrink, jacobian, record_all, rms
from plant import DIRECTIONS

ATTEMPTS = 60
WEAKEST, STRONGEST = 0.7, 12.0  # floors
LEAST_OF_JUMP = 0.015  # floor over the jump of friction where it truly jumps: an encoder cannot time a reversal better
FLOOR_OF_SPAN = (0.0025, 0.015)

WANTS = {
    "reversal_transition": {"curves": ["sign", "linear"]},
    "presliding": {"curves": ["sign"]},
    "stribeck": {"no_stribeck": 1},
    "load_dependent_friction": {"no_load_term": 1},
    "quadratic_viscous": {"fast": 1},
    "time_delay": {"fast": 1},
    "inertia": {"fast": 1, "no_inertia": 1},
    "warm_up": {"long": 1, "running_clock": 1},
    "sensor_drift": {"long": 1, "running_clock": 1},
    "joint_coupling": {"other": 1},
}
VARIANT_WANTS = {
    "sensor_drift/each_trial": {"long": 1, "zero_clock": 1},
    "joint_coupling/inertial": {"other": 1, "other_fast": 1},
    "load_dependent_friction/tension": {"both_sides": 1},
}
STALE = ("gravity", "coulomb", "viscous", "backlash_width", "load_coefficient", "stribeck_level", "inertia")
STALE_WANTS = {"backlash_width": {"curves": ["linear", "arctan"]}, "inertia": {"fast": 1}, "viscous": {"fast": 1}}

WHERE = {
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
TIED = {"sensor_bias": "coulomb", "sensor_gain": "load_coefficient", "load_coefficient": "sensor_gain", "coulomb": "sensor_bias"}


class Rejected(Exception):
    """This draw cannot show what it should; draw again."""


@dataclasses.dataclass
class Cause:
    """One thing that the plant has and the model lacks."""

    name: str
    variant: str
    form: Form = None
    changes: dict = None  # relative change of the plant's parameters, for stale ones
    strength: float = 0.0

    def on(self, joint):
        """The plant's joint and its forms."""
        if self.form is None:
            values = joint.values()
            return joint.altered({n: values[n] * (1 + c) for n, c in self.changes.items()}), []
        return joint, [(self.form.hook, self.form.act, self.strength)]


def stale_changes(rng, name):
    """Which parameters of the plant have moved, and by how much: 10 to 60 %."""
    both = lambda key: {f"friction.{d}.{key}": factor for d in DIRECTIONS}
    factor = draw.log_uniform(rng, 0.1, 0.6) * rng.choice([-1, 1])
    if name == "gravity":
        return "gravity", {"dynamics.gravity_nm": factor}
    if name == "inertia":
        return "inertia", {"dynamics.inertia_kg_m2": factor}
    if name == "backlash_width":
        return "backlash_width", {"joint.backlash_m": factor}
    if name == "viscous":
        return "both", both("d")
    if name == "load_coefficient":
        return "both", both("mu_c")
    if name == "stribeck_level":
        return "both", {**both("b_c"), **both("b_j")}
    if rng.random() < 0.5:
        return "both", both("a_j")
    direction = str(rng.choice(DIRECTIONS))
    return direction, {f"friction.{direction}.a_j": factor}


def make_cause(rng, name, context, variant=None):
    if variant is None:
        variant, changes = stale_changes(rng, name)
        return Cause(name, variant, changes=changes)
    return Cause(name, variant, form=FORMS[name][variant](rng, context))


def torques_with(causes, joint, trials, noise=None):
    forms = []
    for cause in causes:
        joint, more = cause.on(joint)
        forms += more
    return record_all(joint, trials, forms, noise)


def noise_of(rng, ruler, trials):
    """White or slightly coloured noise of each trial, scaled to 1 N m RMS once low-passed."""
    keep = rng.uniform(0.3, 0.8) if rng.random() < 0.25 else 0.0
    noise = [lfilter([1], [1, -keep], rng.normal(size=len(t.q))) for t in trials]
    return [n / rms(ruler.cut(noise)) for n in noise]


def solve_strength(cause, joint, ruler, base, absorber, wanted_nm):
    """The strength at which the net effect is `wanted_nm`."""

    def net(strength):
        cause.strength = strength
        return absorber.left(ruler.cut(torques_with([cause], joint, ruler.trials)) - base)

    if cause.form.linear:
        cause.strength = 1.0
        one = ruler.cut(torques_with([cause], joint, ruler.trials)) - base
        net = lambda strength: absorber.left(strength * one)
    low, high = np.log(cause.form.largest * 1e-4), np.log(cause.form.largest)
    if net(np.exp(high)) < wanted_nm:
        raise Rejected("too weak at its physical limit")
    for _ in range(30 if cause.form.linear else 12):
        middle = (low + high) / 2
        low, high = (middle, high) if net(np.exp(middle)) < wanted_nm else (low, middle)
    cause.strength = float(np.exp(high))
    return cause.strength


@dataclasses.dataclass
class Case:
    """What is written down, and the answer."""

    campaign: draw.Campaign
    recorded: list
    model: object
    confidence: dict
    answer: dict


def wants_of(names, variants):
    wants = {}
    for name, variant in zip(names, variants):
        wants.update(VARIANT_WANTS.get(f"{name}/{variant}", WANTS.get(name, {}) if variant else STALE_WANTS.get(name, {})))
    return wants


def build(kind, names, variants, rng):
    """Draws until a draw can show what it should. `variants` has None for stale parameters."""
    for attempt in range(ATTEMPTS):
        try:
            return attempt_case(kind, names, variants, rng, attempt)
        except Rejected:
            continue
    raise RuntimeError(f"no case of {kind} {names} {variants} in {ATTEMPTS} draws")


def attempt_case(kind, names, variants, rng, attempt):
    wants = wants_of(names, variants)
    joint = draw.draw_joint(rng, wants)
    recorded_in = draw.draw_campaign(rng, joint, wants)
    trials = recorded_in.trials
    ruler = Ruler(trials, joint, recorded_in.lowpass_hz, recorded_in.order)
    base_torques = record_all(joint, trials)
    base = ruler.cut(base_torques)
    context = draw.setting(joint, recorded_in, base_torques)
    causes = [make_cause(rng, n, context, v) for n, v in zip(names, variants)]
    floor_nm = context.torque_span_nm * draw.log_uniform(rng, *FLOOR_OF_SPAN)
    if joint.curve[0] == "sign":
        floor_nm = max(floor_nm, LEAST_OF_JUMP * joint.r1_m * (joint.friction["up"]["a_j"] - joint.friction["down"]["a_j"]))
    wanted = [draw.log_uniform(rng, WEAKEST, STRONGEST) for _ in causes]
    unsized = [c for c in causes if c.form is None or not c.form.sized]
    if unsized:
        size_nm = rms(ruler.cut(torques_with(unsized[:1], joint, trials)) - base)
        floor_nm = float(np.clip(size_nm / wanted[causes.index(unsized[0])], 0.0015 * context.torque_span_nm, 0.03 * context.torque_span_nm))

    parameters, columns = jacobian(joint, ruler)
    with_confidence = rng.random() < 0.8
    offset, low, high, cost_nm = draw.declared(rng, joint, columns, parameters, floor_nm, with_confidence)
    absorber = bounded(columns, low, high)
    for cause, strength in zip(causes, wanted):
        if cause.form is not None and cause.form.sized:
            solve_strength(cause, joint, ruler, base, absorber, strength * floor_nm)

    true = ruler.cut(torques_with(causes, joint, trials))
    alone = [ruler.cut(torques_with([c], joint, trials)) - base for c in causes]
    nets = net_of_each(columns, low, high, alone)
    if any(not 0.9 * WEAKEST <= n / floor_nm <= 2.2 * STRONGEST for n in nets):
        raise Rejected("outside the strengths wanted")
    if kind == "pair" and min(nets) < 1.2 * floor_nm:
        raise Rejected("one of the pair hides in the other")

    values = joint.values()
    model = joint.altered({n: values[n] * (1 + o) for n, o in zip(parameters, offset)})
    confidence = {n: (values[n] * (1 + l), values[n] * (1 + h)) for n, l, h in zip(parameters, low, high)} if with_confidence else None
    noise = [n * floor_nm for n in noise_of(rng, ruler, trials)]
    recorded = torques_with(causes, joint, trials, noise)
    gap = true - ruler.cut(record_all(model, trials))
    answer = {
        "kind": kind, "effects": list(names), "variants": [c.variant for c in causes], "accepted": accepted(kind, names),
        "where": sorted({r for n in names for r in WHERE.get(n, [])}), "floor_nm": floor_nm,
        "raw_over_floor": rms(true - base) / floor_nm, "net_over_floor": absorber.left(true - base) / floor_nm,
        "net_of_each_over_floor": [n / floor_nm for n in nets], "gap_over_floor": rms(gap) / floor_nm,
        "perturbation_over_floor": cost_nm / floor_nm, "shrink_true_form": None, "base": joint.curve[0], "confidence_given": with_confidence,
        "rate_hz": recorded_in.rate_hz, "trials": len(trials), "samples": sum(len(t.q) for t in trials),
        "strengths": [c.strength if c.form else c.changes for c in causes], "draws": attempt + 1,
    }
    if causes and "contact" not in names:
        answer["shrink_true_form"] = held_out_shrink(ruler, columns, low - offset, high - offset, alone, gap, ruler.cut(noise))
    return Case(recorded_in, recorded, model, confidence, answer)


def net_of_each(columns, low, high, alone):
    """RMS of each effect that neither the base nor the others can stand in for."""
    nets = []
    for i, effect in enumerate(alone):
        others = [e for k, e in enumerate(alone) if k != i]
        nets.append(bounded(columns, low, high, others).left(effect))
    return nets


def accepted(kind, names):
    """Verdicts that count as right: (kind, effects)."""
    if kind in ("none", "unknown"):
        return [{"kind": kind, "effects": []}]
    if kind == "pair":
        return [{"kind": "several", "effects": sorted(names)}]
    plain = {"kind": "stale_parameters" if kind == "stale" else "effect", "effects": list(names)}
    rival = TIED.get(names[0])
    return [plain] + ([{"kind": "ambiguous", "effects": sorted([names[0], rival])}] if rival else [])
