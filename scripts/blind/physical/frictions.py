"""What friction at the winch, bearings and sheaths may do that the base does not know: laws of tribology and hysteresis."""
import numpy as np

from effect import Effect, by_segment, log_uniform, loop
from plant import passed_over

# --- hysteresis: the force of a contact that yields before it slips


def bouc_wen(world, rng, reach):
    """dz/dx = (1 - |z|^n (gamma + (1 - gamma) sgn(z dx))) / reach: stiffer or softer on the way back by gamma (Wen 1976)."""
    n, gamma = rng.uniform(1.0, 2.5), rng.uniform(0.3, 0.9)

    def rate(z, dx):
        steps = min(60, 1 + int(10 * abs(dx) / reach))
        dx /= steps
        for _ in range(steps):
            side = 1.0 if z * dx > 0 else -1.0
            z += dx / reach * (1 - abs(z) ** n * (gamma + (1 - gamma) * side))
        return max(-1.0, min(1.0, z))

    return loop(world, rate)


def maxwell_slip(world, rng, reach):
    """Four to eight springs that each slip at a force of their own (Iwan 1966; Al-Bender 2005)."""
    n = int(rng.integers(4, 9))
    slips = reach * np.linspace(0.15, 1.6, n) ** rng.uniform(0.8, 1.6)
    weight = rng.dirichlet(np.full(n, 2.0))

    def step(dx, direction, state):
        z = np.clip((np.zeros(n) if state is None else state)[:, None] + dx[None, :] / slips[:, None], -1, 1)
        return weight @ z, z[:, -1]

    return by_segment(world, step)


def bristles(world, rng, reach):
    """Bristles that bend exponentially, with damping of their own while they do (Dahl 1968 with micro-damping)."""
    damping = rng.uniform(0.0, 0.25)

    def step(dx, direction, state):
        z0 = 0.0 if state is None else state
        z = direction + (z0 - direction) * np.exp(-np.abs(dx) / reach)
        return z + damping * (direction - z), z[-1]

    return by_segment(world, step)


def presliding(world, base, rng, size):
    """Replaces the jump of the friction at a turn by a hysteresis of yielding contacts."""
    span = np.ptp(world.q)
    reach = span * log_uniform(rng, 0.01, 0.12)
    variant = str(rng.choice(["maxwell_slip", "bristles", "bouc_wen"]))
    law = {"maxwell_slip": maxwell_slip, "bristles": bristles, "bouc_wen": bouc_wen}[variant]
    state = rng.bit_generator.state

    def act(world, base, amount):
        rng.bit_generator.state = state
        z = law(world, rng, reach * amount)
        return (1 + z) / 2

    return Effect("presliding", variant, "share", act, linear=False, most=4.0, notes={"reach_rad": reach})


def reversal_transition(world, base, rng, size):
    """A clearance: the joint's pulleys turn over one after the other, or the cable takes up its slack."""
    span = np.ptp(world.q) * (base.r2_m if base.kind == "revolute" else 1.0)
    width = span * log_uniform(rng, 0.02, 0.15)
    variant = str(rng.choice(["pulleys_in_turn", "slack_then_grip", "smooth_grip"]))
    places = np.sort(rng.uniform(0.1, 1.0, 5))
    weight = np.cumsum(rng.dirichlet(np.full(5, 3.0)))
    shapes = {
        "pulleys_in_turn": lambda u: np.interp(u, [0, *places, 1.0], [0, *(weight * 0.98), 1.0]),
        "slack_then_grip": lambda u: np.clip((u - 0.35) / 0.65, 0, 1) ** 1.5,
        "smooth_grip": lambda u: u * u * u * (10 - 15 * u + 6 * u * u),
    }

    def act(world, base, amount):
        x = world.q * (base.r2_m if base.kind == "revolute" else 1.0)
        return world.by_trial(lambda s: passed_over(x[s], world.direction[s], width * amount, shapes[variant]))

    return Effect("reversal_transition", variant, "share", act, linear=False, most=4.0, notes={"width_m": width})


# --- laws of speed


def stribeck(world, base, rng, size):
    """Lubrication that builds up with speed: rational, hyperbolic, or with the film's own memory."""
    slow = np.quantile(np.abs(world.v[np.abs(world.v) > 1e-6 * np.abs(world.v).max()]), 0.9) * log_uniform(rng, 0.05, 0.3)
    variant = str(rng.choice(["rational", "hyperbolic", "film_memory"]))
    down = rng.uniform(0.6, 1.5)
    x = np.abs(world.v) / slow
    if variant == "film_memory":  # Hess and Soom 1990: friction answers a change of speed late
        tau = min(0.1, 0.3 * slow / max(1e-9, np.quantile(np.abs(world.a), 0.8)))
        x = world.by_trial(lambda s: lagged(x[s], tau * world.rate_hz))
    bump = {"rational": 1 / (1 + x**2), "hyperbolic": 1 / np.cosh(np.minimum(x, 50)), "film_memory": np.exp(-np.minimum(x, 50) ** 2)}[variant]

    def act(parts, amount):
        s = 2 * parts.share - 1
        return amount * size * bump * np.where(s > 0, s, down * s)

    return Effect("stribeck", variant, "friction", act, notes={"speed_rad_s": slow})


def lagged(x, samples):
    from scipy.signal import lfilter

    k = 1 - np.exp(-1 / max(1e-6, samples))
    return lfilter([k], [1, k - 1], x, zi=[(1 - k) * x[0]])[0]


def quadratic_viscous(world, base, rng, size):
    """Churning and windage: drag by a power of the speed, or thin at rest and thick at speed."""
    top = np.abs(world.v).max()
    variant = str(rng.choice(["power_1.7", "power_2.4", "cubic_added"]))
    u = np.abs(world.v) / top
    drag = {"power_1.7": u**1.7, "power_2.4": u**2.4, "cubic_added": u**2 + 0.4 * u**3}[variant]
    side = rng.uniform(0.8, 1.25)
    return Effect("quadratic_viscous", variant, "friction", lambda parts, amount: amount * size * drag * np.sign(world.v) * np.where(world.v > 0, 1, side))


# --- laws of load and place


def load_dependent_friction(world, base, rng, size):
    """The capstan: friction e^(mu phi) - 1 of the tension, in bearings a power of the load."""
    variant = str(rng.choice(["capstan", "bearing_power", "pretensioned"]))
    pretension = rng.uniform(0.05, 0.4)

    def act(parts, amount):
        s, carried = 2 * parts.share - 1, parts.ratio * parts.joint
        top = np.quantile(np.abs(carried), 0.98) + 1e-12
        if variant == "capstan":
            return (np.exp(amount * s) - 1) * np.abs(carried)
        if variant == "bearing_power":
            return amount * s * top * (np.abs(carried) / top) ** 1.3
        return amount * s * np.hypot(carried, pretension * top)

    return Effect("load_dependent_friction", variant, "friction", act, linear=variant != "capstan", most=1.0)


def friction_ripple(world, base, rng, size):
    """Pulleys out of round, strands that pass a guide, a worn tooth: friction by place."""
    waves = ripple(world, rng)
    variant = str(rng.choice(["strands", "out_of_round", "two_pulleys"]))
    phase = rng.uniform(0, 2 * np.pi)
    x = waves * world.q + phase
    shape = {
        "strands": np.exp(-((np.mod(x, 2 * np.pi) - np.pi) / 0.9) ** 2),
        "out_of_round": np.sin(x) + 0.25 * np.sin(2 * x + 1.0),
        "two_pulleys": np.sin(x) + 0.5 * np.sin(1.37 * x + 2.0),
    }[variant]
    shape = shape - shape.mean()
    return Effect(
        "friction_ripple", variant, "friction", lambda parts, amount: amount * size * (2 * parts.share - 1) * shape, most=0.8,
        notes={"waves_per_rad": waves},
    )


def ripple(world, rng):
    """Waves per rad such that one to eight lie in the range and none is faster than the low-pass."""
    span, top = np.ptp(world.q), np.quantile(np.abs(world.v), 0.98)
    most = min(2 * np.pi * 9 / span, 2 * np.pi * 0.5 * world.lowpass_hz / top)
    return log_uniform(rng, 2 * np.pi * 1.6 / span, max(2 * np.pi * 2.2 / span, most))


def warm_up(world, base, rng, size):
    """Friction's own heat thins the grease: dT/dt = (power - T) / time, viscosity e^-T."""
    total = world.elapsed.max()
    tau = total * rng.uniform(0.15, 0.6)
    variant = str(rng.choice(["heated_by_friction", "two_bodies", "grease_only"]))
    grid = np.linspace(0, total, 400)
    power = np.interp(grid, *binned(world.elapsed, np.abs(world.v) / np.abs(world.v).mean()), left=0, right=0)
    temperature, at = np.empty(400), 0.0
    for i in range(400):
        at += (power[i] - at) * (grid[1] / tau)
        temperature[i] = at
    warm = np.interp(world.elapsed, grid, temperature / max(1e-9, temperature.max()))
    if variant == "two_bodies":
        warm = 0.6 * (1 - np.exp(-world.elapsed / tau)) + 0.4 * (1 - np.exp(-world.elapsed / (5 * tau)))

    def act(parts, amount):
        if variant == "grease_only":
            viscous = base.r1_m * np.where(world.v > 0, base.up["d"], base.down["d"]) * world.v
            part = viscous + 0.5 * (parts.friction - viscous)
        else:
            part = parts.friction
        return part * np.expm1(amount * (1 - warm))

    return Effect("warm_up", variant, "friction", act, linear=False, most=1.2, notes={"time_s": tau}, needs=("clock",))


def binned(t, x, width_s=5.0):
    """Mean of x in bins of time, and their middles."""
    index = (t / width_s).astype(int)
    total, count = np.bincount(index, x), np.bincount(index)
    seen = count > 0
    return (np.flatnonzero(seen) + 0.5) * width_s, total[seen] / count[seen]


FRICTIONS = {f.__name__: f for f in (
    presliding, reversal_transition, stribeck, quadratic_viscous, load_dependent_friction, friction_ripple, warm_up)}
