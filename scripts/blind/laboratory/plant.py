"""The base plant: a joint behind a cable, by the formula that the project states as its model.

The motion of a whole campaign comes first, the torque at the winch follows from it. Effects act on the parts of the
formula, on the angle that the load sees, and on the reading.
"""
import copy
import dataclasses

import numpy as np

BRANCH = ("mu_c", "a_j", "b_c", "c_c", "b_j", "c_j", "d")  # parameters of one direction


@dataclasses.dataclass
class Base:
    """Parameters of the formula, under the names of a model file."""

    r1_m: float
    r2_m: float
    gravity_nm: float
    inertia_kg_m2: float
    backlash_m: float
    up: dict  # by the names in BRANCH
    down: dict
    combination: dict  # kind: sign, linear, arctan (p, k) or power (n)

    def names(self):
        """Dotted names of the parameters that play a part."""
        named = []
        if self.gravity_nm != 0:
            named.append("dynamics.gravity_nm")
        if self.inertia_kg_m2 != 0:
            named.append("dynamics.inertia_kg_m2")
        for direction in ("up", "down"):
            branch = getattr(self, direction)
            idle = {rate for rate, level in (("c_c", "b_c"), ("c_j", "b_j")) if branch[level] == 0}
            named += [f"friction.{direction}.{k}" for k in BRANCH if branch[k] != 0 and k not in idle]
        kind = self.combination["kind"]
        if kind != "sign":
            named.append("joint.backlash_m")
        if kind in ("arctan", "power"):
            named.append("combination.p" if kind == "arctan" else "combination.n")
        return named

    def scaled(self, changes):
        """A copy with relative changes, by dotted name."""
        other = copy.deepcopy(self)
        for name, change in changes.items():
            group, *_, key = name.split(".")
            if group == "friction":
                getattr(other, name.split(".")[1])[key] *= 1 + change
            elif group == "combination":
                other.combination[key] *= 1 + change
                if key == "p":
                    other.combination["k"] = 1 / np.arctan(2 * other.combination["p"])
            else:
                setattr(other, key, getattr(other, key) * (1 + change))
        return other


def branches(base, speed):
    """Friction at the winch in either direction, N m."""
    up, down, r1, r2 = base.up, base.down, base.r1_m, base.r2_m
    cable_up = up["b_c"] * np.exp(-up["c_c"] * r2 * speed)
    cable_down = down["b_c"] * np.exp(down["c_c"] * r2 * speed)
    joint_up = up["b_j"] * np.exp(-up["c_j"] * speed)
    joint_down = down["b_j"] * np.exp(down["c_j"] * speed)
    return (
        r1 * (up["a_j"] + cable_up + joint_up + up["d"] * speed),
        r1 * (down["a_j"] + cable_down + joint_down - down["d"] * speed),
    )


@dataclasses.dataclass
class Parts:
    """The parts of the formula, for effects to act on."""

    base: Base
    q: np.ndarray
    v: np.ndarray
    a: np.ndarray
    share: np.ndarray  # of the upward branch
    speed: np.ndarray = None
    torque: float = 0.0  # at the joint, N m
    friction_up: float = 0.0  # added at the winch
    friction_down: float = 0.0
    factor: float = 1.0  # of the friction in both directions


def winch_torque(world, base, effects=(), share=None):
    """Torque at the winch without noise; `effects` are pairs (effect, amount)."""
    parts = Parts(base, world.q, world.v, world.a, world.share(base) if share is None else share)
    stretching = [(e, x) for e, x in effects if e.stretch]
    if stretching:
        stiff = [(e, x) for e, x in effects if e.mechanics]
        y = winch_torque(world, base, stiff)
        for effect, amount in stretching:
            yielded = effect.stretch(y, amount)
            parts.q = world.q - yielded
            creep = world.rate_of(effect.creep(yielded))  # the joint follows slowly, it does not jump
            parts.v = world.v - creep
            parts.a = world.a - world.rate_of(creep)
    parts.speed = np.abs(parts.v)
    friction_up, friction_down = branches(base, parts.speed)
    for effect, amount in effects:
        if effect.mechanics:
            effect.mechanics(parts, amount)
    load = base.gravity_nm * np.sin(parts.q) + base.inertia_kg_m2 * parts.a + parts.torque
    if world.load is not None:
        load = load + world.load
    up = friction_up * parts.factor + parts.friction_up
    down = friction_down * parts.factor + parts.friction_down
    share = parts.share
    carried = 1 - base.down["mu_c"] - share * (base.up["mu_c"] - base.down["mu_c"])
    y = (base.r1_m / base.r2_m * load + down + share * (up - down)) / carried
    for last in (False, True):
        for effect, amount in effects:
            if effect.reading and effect.last == last:
                y = effect.reading(y, amount)
    return y


def jacobian(world, base, step=0.01):
    """Names of the parameters, torque by relative change of each, torque."""
    y = winch_torque(world, base)
    names = base.names()
    columns = [(winch_torque(world, base.scaled({n: step})) - y) / step for n in names]
    return names, np.array(columns), y
