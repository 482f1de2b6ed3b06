"""Puts a case together: a setting, causes at the strength asked for, what is recorded, the answer."""
import dataclasses

import numpy as np

from draw import Unfit, digits, log_uniform, uniform
from effect import Scales
from fair import judge
from frictions import (
    friction_ripple, load_dependent_friction, presliding, quadratic_viscous, reversal_transition, stribeck, warm_up)
from joints import STALE, draw_stale
from loads import cable_elasticity, contact, elastic_spring, end_stop, gravity_phase, inertia, joint_coupling
from outside import OUTSIDE
from plant import winch_torque
from readings import saturation, sensor_bias, sensor_drift, sensor_gain, time_delay, torque_ripple
from setting import Setting, draw_setting, rms

EFFECTS = {f.__name__: f for f in (
    reversal_transition, stribeck, load_dependent_friction, friction_ripple, torque_ripple, cable_elasticity,
    quadratic_viscous, sensor_bias, sensor_gain, sensor_drift, time_delay, gravity_phase, inertia, warm_up,
    joint_coupling, contact, elastic_spring, saturation, end_stop, presliding)}
# Net strengths in floors; stale parameters have a size of their own.
STRENGTHS = {"effect": (0.5, 15), "stale": (1, 12), "unknown": (1, 12), "pair": (1.5, 12), "triple": (1.5, 12)}
LEAST = {"effect": 0.5, "stale": 0.5, "unknown": 1.0, "pair": 1.5, "triple": 1.5}
MOST_STALE = {"stale": 15, "pair": 12, "triple": 12}
RAIL_FIRST = 0.6  # of clipped cases: the noise comes before the rail


@dataclasses.dataclass
class Cause:
    """One thing that is wrong, at its amount."""

    id: str
    family: str  # effect, stale or outside
    variant: str
    amount: float
    net: float  # floors after the base has absorbed what it may, alone
    raw: float
    effect: object = None


@dataclasses.dataclass
class Case:
    setting: Setting
    recorded: np.ndarray
    answer: dict


def build(kind, causes, style, rng):
    """One draw of a case; raises Unfit where it is no fair question."""
    effects = [c for c in causes if c in EFFECTS and not (kind == "stale" and c == "inertia")]
    stale = [c for c in causes if c in STALE and c not in effects]
    setting = draw_setting(rng, style, causes, effects, stale, loaded=kind != "unknown")
    campaign, truth = setting.campaign, setting.truth
    world = campaign.world
    scales = Scales(world, setting.base, setting.y, setting.floor, campaign.lowpass_hz, campaign.rests)
    targets = {c: log_uniform(rng, *STRENGTHS[kind]) for c in causes}
    found = []
    for name in causes:
        if name in stale:
            cause, changes = moved(rng, kind, name, setting)
            truth = truth.scaled(changes)
        else:
            make = OUTSIDE[name] if kind == "unknown" else EFFECTS[name]
            family = "outside" if kind == "unknown" else "effect"
            cause = tuned(setting, family, name, make(rng, scales), targets[name], LEAST[kind])
        found.append(cause)
    acting = [(c.effect, c.amount) for c in found if c.effect]
    y = winch_torque(world, truth, acting)
    if not np.all(np.isfinite(y)) or np.ptp(y) > 4 * np.ptp(setting.y):
        raise Unfit("range")
    absorber = setting.absorber
    gap = setting.thinned(y - setting.y)
    column = absorber.columns(gap)[0]
    whole = absorber.left(column)
    finding = judge(kind, causes, [e for e, _ in acting], absorber, column, whole, campaign.span)
    recorded = reading(rng, setting, truth, acting, y)
    return Case(setting, recorded, explain(kind, found, setting, finding, whole, rms(gap) / setting.floor, style))


def tuned(setting, family, name, effect, target, least):
    """An effect at the amount at which its net strength is the target, or as much of it as this joint can show."""
    world, truth = setting.campaign.world, setting.truth
    torque = lambda amount: setting.thinned(winch_torque(world, truth, [(effect, amount)]) - setting.true_y)
    net = lambda amount: setting.absorber.net(torque(amount))
    amount, reached = search(net, effect, target, least)
    return Cause(name, family, effect.variant, float(amount), reached, rms(torque(amount)) / setting.floor, effect)


def search(net, effect, target, least):
    """(amount, net strength): by regula falsi on logarithms, kept off the ends."""
    amount = min(max(effect.start, effect.least), effect.most)
    low = high = None
    for _ in range(14):
        reached = net(amount)
        if not np.isfinite(reached):
            raise Unfit("no number")
        if abs(np.log(max(reached, 1e-9) / target)) < 0.04:
            return amount, reached
        if reached < target:
            low = (amount, reached)
        else:
            high = (amount, reached)
        if low and high:
            bottom, top = np.log([max(low[1], 1e-6), high[1]])
            f = np.clip((np.log(target) - bottom) / (top - bottom + 1e-12), 0.15, 0.85)
            amount = float(np.exp(np.log(low[0]) * (1 - f) + np.log(high[0]) * f))
            continue
        step = np.clip(target / max(reached, 1e-6), 0.1, 10)
        following = float(np.clip(amount * step, effect.least, effect.most))
        if following == amount:
            if least <= reached < target:
                return amount, reached
            raise Unfit("strength out of reach")
        amount = following
    reached = net(amount)
    if reached >= least and abs(np.log(reached / target)) < 0.3:
        return amount, reached
    raise Unfit("no strength")


def moved(rng, kind, name, setting):
    """A stale parameter at a size of its own: (cause, changes by dotted name)."""
    world, truth = setting.campaign.world, setting.truth
    change, changes = draw_stale(rng, name, setting.base)
    torque = lambda scale: setting.thinned(winch_torque(world, truth.scaled(changes(scale))) - setting.true_y)
    net = lambda scale: setting.absorber.net(torque(scale))
    scale, most = 1.0, MOST_STALE[kind]
    reached = net(scale)
    if reached > most:
        scale = max(most * uniform(rng, 0.3, 1) / reached, 0.1 / abs(change))
        reached = net(scale)
    if reached < LEAST[kind] or reached > most * 1.4:
        raise Unfit("strength of stale parameters")
    told = ", ".join(f"{n} {x:+.3f}" for n, x in changes(scale).items())
    raw = rms(torque(scale)) / setting.floor
    return Cause(name, "stale", told, float(change * scale), reached, raw), changes(scale)


def reading(rng, setting, truth, acting, y):
    """The reading with its noise and the steps of its converter."""
    fine, world = setting.campaign.fine, setting.campaign.world
    recorded = world.every(y, fine) + setting.noise
    clipping = [(e, amount) for e, amount in acting if e.clips]
    if clipping and rng.random() < RAIL_FIRST:
        effect, amount = clipping[0]
        others = [(e, x) for e, x in acting if e is not effect]
        recorded = effect.reading(world.every(winch_torque(world, truth, others), fine) + setting.noise, amount)
    if setting.step:
        recorded = np.round(recorded / setting.step) * setting.step
    return recorded


def accepted(kind, found):
    """The right verdicts: the truth and nothing else, under every kind that names it."""
    ids = sorted(c.id for c in found)
    kinds = {"stale": ["stale_parameters"], "pair": ["several"], "triple": ["several"]}.get(kind, [kind])
    if kind == "stale" and ids == ["inertia"]:
        kinds = ["stale_parameters", "effect"]  # the same cause under both
    if kind in ("pair", "triple") and all(c.family == "stale" for c in found):
        kinds = ["several", "stale_parameters"]
    return [{"kind": k, "effects": [] if kind in ("none", "unknown") else ids} for k in kinds]


def explain(kind, found, setting, finding, whole, raw, style):
    """The answer."""
    campaign = setting.campaign
    left = sorted(finding.left.items(), key=lambda item: item[1])
    net, raw = (found[0].net, found[0].raw) if len(found) == 1 else (whole, raw) if found else (0.0, 0.0)
    return {
        "kind": kind, "effects": [c.id for c in found] if kind != "unknown" else [], "causes": [c.id for c in found],
        "variants": [c.variant for c in found], "families": [c.family for c in found],
        "accepted": accepted(kind, found),
        "indistinguishable": sorted(finding.indistinguishable), "net_over_floor": net,
        "raw_over_floor": raw, "net_of_each_over_floor": [c.net for c in found],
        "raw_of_each_over_floor": [c.raw for c in found], "amounts": [digits(c.amount, 4) for c in found],
        "left_by_over_floor": {n: round(x, 3) for n, x in left if np.isfinite(x)},
        "gap_over_floor": whole, "left_by_truth_over_floor": finding.own, "floor_nm": setting.floor, "style": style,
        "rate_hz": campaign.rate_hz, "lowpass_hz": campaign.lowpass_hz, "trials": len(campaign.trials),
        "seconds_recorded": campaign.seconds, "samples": setting.logged.size, "noise": setting.noise_kind,
        "converter_step": setting.step, "joint": "prismatic" if campaign.world.prismatic else "revolute",
        "combination": setting.base.combination["kind"], "declared_confidence": setting.declared,
        "base_off_over_floor": setting.base_error, "encoder_counts_per_turn": setting.counts,
        "rounding_over_floor": setting.encoder_error,
    }
