"""What friction may do that the base does not know: at turns, by speed, by load, by place, by time."""
import numpy as np
from scipy.signal import lfilter

from draw import Unfit, pick, uniform
from effect import Effect, both_ways, smooth, wave


def reversal_transition(rng, scales):
    """A change of branch over a travel where the model switches at once, or over another travel along another curve."""
    world, base = scales.world, scales.base
    if scales.turns < 2 * scales.trials:
        raise Unfit("few reversals")
    variant = pick(rng, "exp", "scurve", "deadzone_rise", "two_slope", "power", "late_arctan")
    rate = uniform(rng, 2, 4)
    dead = uniform(rng, 0.15, 0.5)
    knee = uniform(rng, 0.25, 0.5)
    knee_share = uniform(rng, 0.6, 0.85)
    exponent = uniform(rng, 0.45, 2.2)
    bend = uniform(rng, 1, 4)
    shape = {
        "exp": lambda u: (1 - np.exp(-rate * u)) / (1 - np.exp(-rate)),
        "scurve": lambda u: u * u * (3 - 2 * u),
        "deadzone_rise": lambda u: np.clip((np.asarray(u) - dead) / (1 - dead), 0, 1) ** 1.5,
        "two_slope": lambda u: np.interp(u, [0, knee, 1], [0, knee_share, 1]),
        "power": lambda u: np.asarray(u) ** exponent,
        "late_arctan": lambda u: np.arctan(bend * 2 * u) / np.arctan(2 * bend),
    }[variant]
    x, span = world.q * base.r2_m, scales.span * base.r2_m
    zone = 0.0 if base.combination["kind"] == "sign" else base.backlash_m

    def longer(parts, amount):
        parts.share = world.passage(x, zone * (1 + amount), shape)

    def instead_of_jump(parts, amount):
        parts.share = world.passage(x, amount * span, shape)

    if zone:
        most = 0.3 * span / zone
        return Effect(f"{variant}, longer than the zone", start=1.0, most=most, least=0.3, mechanics=longer)
    return Effect(f"{variant}, for a jump", start=0.03, most=0.35, least=1e-3, mechanics=instead_of_jump)


def presliding(rng, scales):
    """Contacts that yield before they slip: Dahl, with an exponent, four slipping springs, damped bristles."""
    world, base = scales.world, scales.base
    if scales.turns < 2 * scales.trials:
        raise Unfit("few reversals")
    variant = pick(rng, "dahl", "dahl_n", "maxwell_slip", "lugre")
    exponent = uniform(rng, 0.6, 1.8)
    weights = rng.dirichlet(np.ones(4) * 2)
    slips = np.array([0.25, 0.6, 1.2, 2.5])
    damping = uniform(rng, 0.2, 1.0) if variant == "lugre" else 0
    x, span = world.q * base.r2_m, scales.span * base.r2_m
    zone = 0 if base.combination["kind"] == "sign" else base.backlash_m

    def share(reach):
        if variant == "maxwell_slip":
            return sum(w * world.passage(x, 4 * reach * slip, lambda u: u) for w, slip in zip(weights, slips))
        return world.dahl(x, reach, exponent if variant == "dahl_n" else 1.0)

    def mechanics(parts, amount):
        parts.share = share(amount * span + 0.25 * zone)
        if damping:
            rate = world.rate_of(2 * parts.share - 1)
            drag = damping * 0.02 * scales.friction * np.tanh(rate / 20.0)
            both_ways(parts, drag, -drag)

    return Effect(variant, start=0.02, most=0.12, least=5e-4, mechanics=mechanics)


def stribeck(rng, scales):
    """Friction that falls with speed."""
    slow, fast = np.quantile(scales.speeds, [0.05, 0.95])
    if fast / max(slow, 1e-9) < 3:
        raise Unfit("one speed")
    variant = pick(rng, "gaussian", "lorentz", "tustin", "gauss_power")
    typical = np.quantile(scales.speeds, uniform(rng, 0.12, 0.45))
    exponent = uniform(rng, 0.7, 1.6)
    upward = uniform(rng, 0.75, 1.25)

    def mechanics(parts, amount):
        u = parts.speed / typical
        decay = {
            "gaussian": lambda: np.exp(-(u**2)),
            "lorentz": lambda: 1 / (1 + u**2),
            "tustin": lambda: np.exp(-u),
            "gauss_power": lambda: np.exp(-(u**exponent)),
        }[variant]()
        both_ways(parts, amount * decay * upward, amount * decay * (2 - upward))

    most = 2.5 * scales.friction + 5 * scales.floor
    return Effect(variant, start=2 * scales.floor, most=most, mechanics=mechanics)


def load_dependent_friction(rng, scales):
    """Friction that grows with what the joint or the cable carries."""
    if scales.load_reach < 0.15 * scales.load_top or scales.load_top * scales.ratio < 3 * scales.floor:
        raise Unfit("no change of load")
    variant = pick(rng, "load", "hertz", "tension", "preloaded", "taut_side", "capstan")
    exponent = uniform(rng, 0.6, 0.8) if variant == "hertz" else 1.0
    pretension = uniform(rng, 0.1, 0.5)
    side = float(np.sign(np.mean(scales.load))) or 1.0
    upward = uniform(rng, 0.8, 1.2)
    load, top = scales.load, scales.load_top
    carried = {
        "load": lambda: np.abs(load) / top,
        "hertz": lambda: (np.abs(load) / top) ** exponent,
        "tension": lambda: np.abs(scales.y) / scales.top,
        "preloaded": lambda: np.sqrt((load / top) ** 2 + pretension**2) - pretension,
        "taut_side": lambda: np.maximum(side * load, 0) / top,
        "capstan": lambda: np.expm1(0.8 * np.abs(load) / top) / np.expm1(0.8),
    }[variant]()

    def mechanics(parts, amount):
        both_ways(parts, amount * carried * upward, amount * carried * (2 - upward))

    return Effect(variant, start=2 * scales.floor, most=0.7 * scales.ratio * top, mechanics=mechanics)


def friction_ripple(rng, scales):
    """Friction by place: rollers out of round, lumps, a drum's turn."""
    forms = ["sine", "harmonics", "drum_once", "growing", "two_tones", "lumps", "sawtooth"]
    variant, k, function = wave(rng, scales, forms)

    def mechanics(parts, amount):
        h = amount * function(parts.q)
        both_ways(parts, h, h)

    told = f"{variant}, {k * scales.span / 6.2832:.2f} periods"
    most = 1.0 * scales.friction + 3 * scales.floor
    return Effect(told, start=1.5 * scales.floor, most=most, mechanics=mechanics)


def quadratic_viscous(rng, scales):
    """Drag by a power of the speed."""
    if np.quantile(scales.speeds, 0.95) / max(np.quantile(scales.speeds, 0.1), 1e-9) < 2.5:
        raise Unfit("one speed")
    exponent = uniform(rng, 1.7, 2.3)
    variant = pick(rng, "power", "above_threshold", "one_way_stronger")
    upward = uniform(rng, 0.5, 1.5) if variant == "one_way_stronger" else 1.0
    threshold = 0.2 * scales.fastest if variant == "above_threshold" else 0

    def mechanics(parts, amount):
        h = amount * (np.maximum(parts.speed - threshold, 0) / scales.fastest) ** exponent
        both_ways(parts, h * upward, h * (2 - upward))

    most = 3 * scales.friction + 5 * scales.floor
    return Effect(f"{variant}, exponent {exponent:.2f}", start=4 * scales.floor, most=most, mechanics=mechanics)


def warm_up(rng, scales):
    """Friction that falls as the joint warms: all of it or a part, by its own heat, with a recorded temperature."""
    world = scales.world
    if scales.wall_seconds < 50:
        raise Unfit("short")
    variants = ["all_exp", "viscous_only", "coulomb_only", "heat_balance", "two_rates"]
    if world.temperature is not None and np.ptp(world.temperature) > 3:
        variants.append("by_temperature")
    variant = pick(rng, *variants)
    tau = uniform(rng, 0.08, 0.5) * scales.wall_seconds
    wall = world.wall
    if variant == "two_rates":
        cold = 0.5 * np.exp(-wall / tau) + 0.5 * np.exp(-wall / (tau * 0.2))
    elif variant == "heat_balance":
        cold = np.exp(-1.8 * heated(world, tau))
    elif variant == "by_temperature":
        cold = np.exp(-(world.temperature - world.temperature[0]) / (0.4 * np.ptp(world.temperature)))
    else:
        cold = np.exp(-wall / tau)
    if variant == "viscous_only" and np.quantile(scales.speeds, 0.9) < scales.fastest * 0.15:
        raise Unfit("slow")

    def mechanics(parts, amount):
        base = parts.base
        r1, up, down = base.r1_m, base.up, base.down
        if variant == "viscous_only":
            both_ways(parts, amount * cold * r1 * up["d"] * parts.speed, amount * cold * r1 * down["d"] * parts.speed)
        elif variant == "coulomb_only":
            both_ways(parts, amount * cold * r1 * up["a_j"], -(amount * cold * r1 * down["a_j"]))
        else:
            parts.factor = parts.factor * (1 + amount * cold)

    most = 4 if variant == "viscous_only" else 1.5
    return Effect(f"{variant}, {tau:.0f} s", start=0.2, most=most, least=0.01, mechanics=mechanics)


def heated(world, tau):
    """Temperature, 1 at the mean speed for good, by what the motion heats and what is lost within tau."""
    wall = world.wall
    power = np.abs(world.v) / np.mean(np.abs(world.v))
    grid = np.linspace(0, wall[-1], 2000)
    on_grid = np.interp(grid, wall, smooth(world, power, 0.5))
    keep = np.exp(-(grid[1] - grid[0]) / tau)
    return np.interp(wall, grid, lfilter([1 - keep], [1, -keep], on_grid))
