"""What may act at the joint that the base does not know: springs, stops, pushes, weight, inertia, another joint."""
import numpy as np
from scipy.ndimage import gaussian_filter1d

from draw import Unfit, log_uniform, pick, uniform
from effect import Effect, smooth


def cable_elasticity(rng, scales):
    """A cable that stretches under its tension, so that the load is not where the winch is."""
    world = scales.world
    if scales.base.gravity_nm == 0:
        raise Unfit("angle error does not show")
    variant = pick(rng, "linear", "hardening", "power", "slack_then_stiff")
    exponent = uniform(rng, 0.55, 0.8)
    hardening = uniform(rng, 0.5, 2)

    def stretch(y, amount):
        z = smooth(world, y, 0.02) / scales.top
        yielded = {
            "linear": lambda: z,
            "hardening": lambda: z / (1 + hardening * np.abs(z)) * (1 + hardening),
            "power": lambda: np.sign(z) * np.sqrt(z**2 + 1e-4) ** exponent,
            "slack_then_stiff": lambda: 0.5 * z + 0.5 * np.tanh(6 * z),
        }[variant]()
        return amount * yielded

    creep = lambda yielded: smooth(world, yielded, 0.12)
    return Effect(variant, start=0.02, most=0.25, least=1e-4, stretch=stretch, creep=creep)


def gravity_phase(rng, scales):
    """A base out of plumb, or a centre of mass off its line."""
    if scales.base.gravity_nm == 0 or scales.world.prismatic:
        raise Unfit("no gravity")
    variant = pick(rng, "tilted_base", "com_offset", "tilt_and_sag")
    sign = rng.choice([-1, 1])
    gravity = scales.base.gravity_nm

    def mechanics(parts, amount):
        q = parts.q
        if variant == "tilted_base":
            added = gravity * (np.sin(q + sign * amount) - np.sin(q))
        elif variant == "com_offset":
            added = sign * amount * gravity * np.cos(q)
        else:
            added = gravity * (np.sin(q + sign * amount * (1 + 0.15 * np.sin(q))) - np.sin(q))
        parts.torque = parts.torque + added

    return Effect(variant, start=0.05, most=0.6, least=1e-3, mechanics=mechanics)


def inertia(rng, scales):
    """Inertia where the model has none: constant, by posture, behind a compliance."""
    world, base = scales.world, scales.base
    if base.inertia_kg_m2 != 0:
        raise Unfit("model has one")
    variant = pick(rng, "constant", "constant", "posture", "rotor_with_compliance")
    uneven = uniform(rng, 0.1, 0.3)
    per_angle = 1 if not world.prismatic else np.pi / 2 / scales.span

    def mechanics(parts, amount):
        a = parts.a
        if variant == "posture":
            a = a * (1 + uneven * np.cos(2 * parts.q * per_angle))
        if variant == "rotor_with_compliance":
            a = smooth(world, a, 0.02)
        parts.torque = parts.torque + amount / scales.a_rms / scales.gain * a

    limb = 0.6 * (scales.load_top / 9.81 * 0.6) if base.gravity_nm else 1.0  # what a limb of that weight could have
    most = limb * scales.a_rms * scales.gain + 2 * scales.floor
    return Effect(variant, start=2 * scales.floor, most=most, mechanics=mechanics)


def joint_coupling(rng, scales):
    """What a second joint that is recorded does to this one."""
    world = scales.world
    if world.other_q is None:
        raise Unfit("no other joint")
    variants = ["routing_spring", "viscous_drag", "cable_friction", "inertia", "centrifugal"]
    variant = pick(rng, *variants, *([] if world.prismatic else ["gravity", "gravity"]))
    q = world.other_q - np.mean(world.other_q)
    v = world.other_v
    still = 0.15 * np.max(np.abs(v))
    sign = rng.choice([-1, 1])
    z = {
        "routing_spring": lambda: q + 0.3 * q * np.abs(q) / np.max(np.abs(q)),
        "viscous_drag": lambda: v,
        "cable_friction": lambda: np.tanh(v / still),
        "inertia": lambda: world.other_a,
        "centrifugal": lambda: v * np.abs(v) if world.prismatic else v**2 * np.sin(world.other_q),
        "gravity": lambda: np.sin(world.q + world.other_q) - np.sin(world.q),
    }[variant]()
    if np.std(z) < 1e-9:
        raise Unfit("other joint still")
    return at_joint(scales, variant, sign * z / np.std(z), 1.2, 0.5 * scales.reach)


def at_joint(scales, variant, z, start_floors, most, **more):
    """An effect that adds a torque z at the joint, an amount of one being one at the reading."""

    def mechanics(parts, amount):
        parts.torque = parts.torque + amount / scales.gain * z

    return Effect(variant, start=start_floors * scales.floor, most=most, mechanics=mechanics, **more)


def contact(rng, scales):
    """Pushes and blows in some of the trials."""
    world = scales.world
    z = np.zeros(world.size)
    count, kinds, covered = 0, set(), 0
    one_sign = rng.random() < 0.4
    sign = rng.choice([-1, 1])
    touched_share = uniform(rng, 0.3, 1)
    most_covered = uniform(rng, 0.05, 0.3) * world.size
    touched = [i for i in range(scales.trials) if rng.random() < touched_share] or [int(rng.integers(scales.trials))]
    for i in touched:
        trial = world.slices[i]
        length = trial.stop - trial.start
        seconds = length / world.rate_hz
        for _ in range(int(rng.integers(1, 5 if seconds > 20 else 3))):
            lasts = min(log_uniform(rng, 0.25, 8), 0.3 * seconds)
            samples = int(lasts * world.rate_hz)
            too_much = covered + samples > most_covered and count > 0
            if samples < 8 or too_much or lasts < 0.7 / scales.lowpass_hz:
                continue
            kind, shape = burst(rng, samples)
            first = trial.start + int(uniform(rng, 0.03, 0.97) * (length - samples))
            towards = sign if one_sign else rng.choice([-1, 1])
            z[first : first + samples] += towards * uniform(rng, 0.5, 1.3) * shape
            count += 1
            kinds.add(kind)
            covered += samples
    if count == 0:
        raise Unfit("no burst")
    told = f"{count} bursts: {', '.join(sorted(kinds))}"
    return at_joint(scales, told, smooth(world, z, 0.01), 3, 1.2 * scales.top, bursts=count)


def burst(rng, samples):
    """The course of one push: (kind, values)."""
    kind = pick(rng, "halfsine", "gauss", "trapezoid", "decay", "push", "ramp_release", "double")
    t = np.linspace(0, 1, samples)
    edge = uniform(rng, 4, 12)
    tremble = gaussian_filter1d(rng.standard_normal(samples), samples / 12) * np.sqrt(samples / 12)
    shape = {
        "halfsine": lambda: np.sin(np.pi * t),
        "gauss": lambda: np.exp(-(((t - 0.5) / 0.18) ** 2)),
        "trapezoid": lambda: np.clip(np.minimum(t, 1 - t) * edge, 0, 1),
        "decay": lambda: np.minimum(t * 15, 1) * np.exp(-3 * t) * (1 - t),
        "push": lambda: np.sin(np.pi * t) ** 0.7 * (1 + 0.5 * tremble),
        "ramp_release": lambda: t * np.clip((1 - t) * 15, 0, 1),
        "double": lambda: np.abs(np.sin(2 * np.pi * t)) * (1 - 0.4 * t),
    }[kind]
    return kind, shape()


def elastic_spring(rng, scales):
    """A spring at the joint: straight, stiffening, giving way, like tissue, with a little friction in it."""
    world = scales.world
    variant = pick(rng, "linear", "hardening", "exp_tissue", "slightly_hysteretic", "regressive")
    rest = scales.low + scales.span * uniform(rng, 0.2, 0.8)
    hardening = uniform(rng, 0.3, 1.5)
    rate = uniform(rng, 1.5, 3)
    share = world.dahl(world.q, 0.06 * scales.span)

    def mechanics(parts, amount):
        x = (parts.q - rest) / (0.5 * scales.span)
        force = {
            "linear": lambda: x,
            "hardening": lambda: x * (1 + hardening * x * x),
            "exp_tissue": lambda: np.sign(x) * np.expm1(rate * np.abs(x)) / np.expm1(rate),
            "slightly_hysteretic": lambda: x + 0.12 * (2 * share - 1) * np.abs(x),
            "regressive": lambda: np.tanh(1.2 * x),
        }[variant]()
        parts.torque = parts.torque + amount / scales.gain * force

    return Effect(variant, start=1.5 * scales.floor, most=0.6 * scales.reach, mechanics=mechanics)


def end_stop(rng, scales):
    """A soft stop at one end of the range."""
    variant = pick(rng, "power", "linear_soft_start", "exponential", "damped", "hysteretic")
    side = rng.choice([-1, 1])
    depth = uniform(rng, 0.03, 0.18)
    exponent = uniform(rng, 1.3, 2.5)
    edge = scales.high if side > 0 else scales.low
    onset = edge - side * depth * scales.span

    def mechanics(parts, amount):
        d = np.maximum(side * (parts.q - onset), 0) / (depth * scales.span)
        force = {
            "power": lambda: d**exponent,
            "linear_soft_start": lambda: np.where(d < 0.3, d * d / 0.6, d - 0.15),
            "exponential": lambda: np.expm1(3 * d) / np.expm1(3),
            "damped": lambda: d**1.5 * (1 + 0.5 * np.tanh(side * parts.v / (0.2 * scales.fastest))),
            "hysteretic": lambda: d**1.3 * (1 + 0.2 * np.tanh(side * parts.v / (0.02 * scales.fastest))),
        }[variant]()
        parts.torque = parts.torque + side * amount / scales.gain * force

    sunk = np.maximum(side * (scales.world.q - onset), 0)
    if np.mean(sunk > 0.1 * depth * scales.span) < 0.01:
        raise Unfit("stop hardly touched")
    told = f"{variant}, {depth:.0%} of the range"
    return Effect(told, start=4 * scales.floor, most=1.5 * scales.reach, mechanics=mechanics)
