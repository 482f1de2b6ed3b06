"""Builds one case: a joint, its campaign, what is wrong with its model, and the answer."""
import dataclasses

import numpy as np
from scipy.signal import lfilter

import campaign as draw
from answers import accepted, indistinguishable, where
from causes import Rejected, make_cause, torques_with, wants_of
from forms.friction import cold
from measure import Absorber, Ruler, held_out_shrink, jacobian, record_all, rms
from plant import State
from rivals import Bench

ATTEMPTS = 100
STRENGTHS = {"effect": (0.7, 12.0), "stale": (0.7, 12.0), "unknown": (1.0, 12.0), "pair": (1.5, 12.0), "tie": (1.5, 12.0)}  # floors
TOO_STRONG = 2.2  # times the strongest: what a cause that is not sized may come to
LEAST_OF_PAIR = 1.2  # floors: what of each neither the base nor the other may stand in for
FLOOR_OF_SPAN = (0.0025, 0.015)
LEAST_OF_JUMP = 0.015  # floor over the jump of friction where it truly jumps: an encoder cannot time a reversal better
SELDOM = 0.15
UNJUDGED = ("contact", "saturation")  # a touch cannot be predicted, and clipped samples are not judged: no shrink to compare with


@dataclasses.dataclass
class Case:
    """What is written down, and the answer."""

    campaign: draw.Campaign
    recorded: list
    model: object
    confidence: dict
    beside: dict  # further columns: name -> (quantity, unit, one array per trial)
    answer: dict


def build(kind, options, rng):
    """Draws until a draw can show what it should. `options`: (names, variants) to try, in turn; a variant of None is a stale parameter."""
    for draws in range(1, ATTEMPTS + 1):
        try:
            return attempt_case(kind, *options[draws % len(options)], rng, draws)
        except Rejected:
            continue
    raise RuntimeError(f"no case of {kind} {options} in {ATTEMPTS} draws")


def noise_of(rng, ruler, trials):
    """White or slightly coloured noise of each trial, scaled to 1 N m RMS once low-passed."""
    keep = rng.uniform(0.3, 0.8) if rng.random() < 0.25 else 0.0
    noise = [lfilter([1], [1, -keep], rng.normal(size=len(t.q))) for t in trials]
    return [n / rms(ruler.cut(noise)) for n in noise]


def draw_floor(rng, joint, ruler, context, base, causes, wanted):
    """The noise that is to be left after the low-pass. With a cause that has a size already, so that it stands out as wanted."""
    span_nm = context.torque_span_nm
    for cause, strength in zip(causes, wanted):
        if not cause.sized:
            size_nm = rms(ruler.cut(torques_with([cause], joint, ruler.trials)) - base)
            return float(np.clip(size_nm / strength, 0.0015 * span_nm, 0.03 * span_nm))
    floor_nm = span_nm * draw.log_uniform(rng, *FLOOR_OF_SPAN)
    if joint.curve[0] == "sign":
        floor_nm = max(floor_nm, LEAST_OF_JUMP * joint.r1_m * (joint.friction["up"]["a_j"] - joint.friction["down"]["a_j"]))
    return floor_nm


def solve_strength(cause, joint, ruler, base, absorber, wanted_nm):
    """Sets the strength at which `wanted_nm` of the cause is left once the base has absorbed what it may."""

    def effect(strength):
        cause.strength = strength
        return ruler.cut(torques_with([cause], joint, ruler.trials)) - base

    if cause.form.linear:
        one = effect(1.0)
        net = lambda strength: absorber.left(strength * one)
    else:
        net = lambda strength: absorber.left(effect(strength))
    low, high = np.log(cause.form.largest * 1e-4), np.log(cause.form.largest)
    if net(np.exp(high)) < wanted_nm:
        raise Rejected("too weak at its physical limit")
    for _ in range(30 if cause.form.linear else 12):
        middle = (low + high) / 2
        low, high = (middle, high) if net(np.exp(middle)) < wanted_nm else (low, middle)
    cause.strength = float(np.exp(high))


def net_of_each(absorber, alone):
    """RMS of each effect that neither the base nor the others can stand in for."""
    return [absorber.beside([e for k, e in enumerate(alone) if k != i]).left(effect) for i, effect in enumerate(alone)]


def further_columns(rng, trials, causes):
    """What else a log may hold: a velocity, a thermometer that shows the warmth where that matters."""
    beside = {}
    if rng.random() < SELDOM:
        scatter = rng.uniform(0.0, 0.002)
        beside["velocity_rad_s"] = ("velocity", "rad/s", [t.v + rng.normal(0, scatter, len(t.v)) for t in trials])
    warm = next((c.form.warm for c in causes if c.form is not None and c.form.warm is not None), None)
    if rng.random() < (2 * SELDOM if warm else SELDOM):
        shown = warm or cold(rng, trials[-1].elapsed_s[-1])
        start, rise = rng.uniform(15, 28), rng.uniform(3, 20)
        states = [State(t, None, t.q, t.v, t.a) for t in trials]
        beside["winch_deg_c"] = ("temperature", "degC", [start + rise * (1 - shown(st)) + rng.normal(0, 0.05, len(st.q)) for st in states])
    return beside


def attempt_case(kind, names, variants, rng, draws):
    """One draw of everything, or `Rejected`."""
    wants = wants_of(kind, names, variants)
    joint = draw.draw_joint(rng, wants)
    recorded_in = draw.draw_campaign(rng, joint, wants)
    trials = recorded_in.trials
    ruler = Ruler(trials, joint, recorded_in.lowpass_hz, recorded_in.order)
    torques = record_all(joint, trials)
    base = ruler.cut(torques)
    context = draw.setting(joint, recorded_in, torques)
    made = [make_cause(rng, kind, n, v, context) for n, v in zip(names, variants)]
    causes, rival = [c for c, _ in made], made[0][1] if made else None
    names = [] if kind == "unknown" else [c.name for c in causes]
    named = [c.variant for c in causes]

    wanted = [draw.log_uniform(rng, *STRENGTHS[kind]) for _ in causes]
    floor_nm = draw_floor(rng, joint, ruler, context, base, causes, wanted)
    parameters, columns = jacobian(joint, ruler)
    known = draw.declared(rng, joint, columns, parameters, floor_nm)
    absorber = Absorber(columns, known.low, known.high)
    for cause, strength in zip(causes, wanted):
        if cause.sized:
            solve_strength(cause, joint, ruler, base, absorber, strength * floor_nm)

    true = ruler.cut(torques_with(causes, joint, trials))
    alone = [ruler.cut(torques_with([c], joint, trials)) - base for c in causes]
    nets = net_of_each(absorber, alone)
    least, most = (0.9 * STRENGTHS[kind][0], TOO_STRONG * STRENGTHS[kind][1]) if causes else (0, 0)
    if kind == "pair":
        least = LEAST_OF_PAIR
    if any(not least <= n / floor_nm <= most for n in nets):
        raise Rejected("outside the strengths wanted")
    net_nm = absorber.left(true - base)
    left_by, same = {}, []
    if causes:
        bench = Bench(joint, ruler, parameters, columns, known.low, known.high, true - base)
        left_by, same = indistinguishable(kind, names, bench, floor_nm, net_nm, rival)

    model = joint.altered({n: v * (1 + o) for (n, v), o in zip(known.values.items(), known.offset)})
    noise = [n * floor_nm for n in noise_of(rng, ruler, trials)]
    recorded = torques_with(causes, joint, trials, noise)
    gap = true - ruler.cut(record_all(model, trials))
    shrink = None
    if causes and kind != "unknown" and not set(names) & set(UNJUDGED):
        shrink = held_out_shrink(ruler, columns, known.low - known.offset, known.high - known.offset, alone, gap, ruler.cut(noise))
    answer = {
        "kind": kind, "effects": names, "variants": named, "accepted": accepted(kind, names, named, rival), "indistinguishable": same,
        "where": where(kind, names, named),
        "floor_nm": floor_nm, "raw_over_floor": rms(true - base) / floor_nm, "net_over_floor": net_nm / floor_nm,
        "net_of_each_over_floor": [n / floor_nm for n in nets], "gap_over_floor": rms(gap) / floor_nm,
        "model_error_over_floor": known.cost_nm / floor_nm, "shrink_true_form": shrink, "left_by_over_floor": left_by,
        "base": joint.curve[0], "confidence_given": known.given, "rate_hz": recorded_in.rate_hz, "lowpass_hz": recorded_in.lowpass_hz,
        "trials": len(trials), "samples": sum(len(t.q) for t in trials), "strengths": [c.strength if c.form else c.changes for c in causes],
        "draws": draws,
    }
    return Case(recorded_in, recorded, model, known.intervals() if known.given else None, further_columns(rng, trials, causes), answer)
