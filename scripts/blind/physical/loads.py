"""What may hang on, push or bend the joint: mechanics of stops, springs, elastic cables, masses, people."""
import numpy as np

from effect import Effect
from frictions import lagged, ripple


def per_joint(world, base, size):
    """Size at the winch, as torque at the joint."""
    return size * (base.r2_m / base.r1_m if base.kind == "revolute" else 1.0)


def end_stop(world, base, rng, size):
    """A stop met softly: Hertz' contact, rubber that stiffens exponentially, one with losses (Hunt and Crossley 1975)."""
    side = rng.choice([-1.0, 1.0])
    far, near = (world.q.max(), world.q.min()) if side > 0 else (world.q.min(), world.q.max())
    depth = abs(far - near) * rng.uniform(0.04, 0.16)
    sunk = np.maximum(0, depth - np.abs(far - world.q)) / depth
    variant = str(rng.choice(["hertz", "rubber", "with_losses"]))
    law = {
        "hertz": sunk**1.5, "rubber": np.expm1(2.5 * sunk) / np.expm1(2.5),
        "with_losses": sunk**1.5 * np.maximum(0, 1 + 0.3 * side * world.v / np.abs(world.v).max()),
    }[variant]
    push = side * per_joint(world, base, size) * law
    return Effect("end_stop", variant, "joint", lambda parts, amount: amount * push, notes={"from_rad": far - side * depth})


def elastic_spring(world, base, rng, size):
    """Sheaths, hoses and tissue: softer than linear, harder, or a bungee about its rest."""
    span = np.ptp(world.q)
    rest = world.q.min() + span * rng.uniform(-0.3, 1.3)
    x = (world.q - rest) / span
    variant = str(rng.choice(["stiffening", "softening", "linear_hose"]))
    law = {"stiffening": x + 0.6 * x**3, "softening": np.tanh(1.2 * x) / 1.2, "linear_hose": x}[variant]
    return Effect("elastic_spring", variant, "joint", lambda parts, amount: amount * per_joint(world, base, size) * law, notes={"rest_rad": rest})


def gravity_phase(world, base, rng, size):
    """A centre of mass off its line, or the base plate not level."""
    variant = str(rng.choice(["off_line", "base_tilted"]))
    sign = rng.choice([-1.0, 1.0])
    if variant == "off_line":
        act = lambda parts, amount: sign * amount * per_joint(world, base, size) * np.cos(world.q)
    else:
        act = lambda parts, amount: base.gravity_nm * (np.sin(world.q + sign * amount) - np.sin(world.q))
    return Effect("gravity_phase", variant, "joint", act, linear=variant == "off_line", most=0.5 if variant == "base_tilted" else np.inf)


def torque_ripple(world, base, rng, size):
    """Pulleys off centre under load, a cardan joint's two waves a turn, magnets."""
    waves, phase = ripple(world, rng), rng.uniform(0, 2 * np.pi)
    x = waves * world.q + phase
    variant = str(rng.choice(["off_centre", "magnets", "beating"]))
    wave = {"off_centre": np.sin(x), "magnets": np.sin(x) + 0.4 * np.sin(2 * x + 0.7), "beating": np.sin(x) + 0.4 * np.sin(1.21 * x)}[variant]

    def act(parts, amount):
        carried = parts.joint / max(1e-12, np.quantile(np.abs(parts.joint), 0.9)) if variant == "off_centre" else 1.0
        return amount * per_joint(world, base, size) * wave * carried

    return Effect("torque_ripple", variant, "joint", act, notes={"waves_per_rad": waves})


def cable_elasticity(world, base, rng, size):
    """The joint lags its angle by what the cable stretches: linear, stiffer the tighter, or with the sheath's friction in it."""
    variant = str(rng.choice(["linear", "stiffens", "sheathed"]))
    tightness = rng.uniform(0.5, 1.5)

    def act(parts, amount):
        pull = parts.ratio * parts.joint + (parts.friction if variant == "sheathed" else 0.0)
        top = max(1e-12, np.quantile(np.abs(pull), 0.95))
        x = pull / top
        stretch = np.sign(x) * np.log1p(tightness * np.abs(x)) / np.log1p(tightness) if variant == "stiffens" else x
        return -0.1 * amount * np.ptp(world.q) * stretch

    return Effect("cable_elasticity", variant, "angle", act, linear=False, most=2.0)


def inertia(world, base, rng, size):
    """Mass that no drawing had: at the joint, or a flywheel that couples through its own compliance."""
    top = max(1e-9, np.abs(world.a).max())
    variant = str(rng.choice(["at_joint", "soft_flywheel"]))
    a = world.a
    if variant == "soft_flywheel":
        a = world.by_trial(lambda s: lagged(world.a[s], 0.01 * world.rate_hz))
    return Effect("inertia", variant, "joint", lambda parts, amount: amount * per_joint(world, base, size) * a / top)


def joint_coupling(world, base, rng, size):
    """Another joint that moves: its weight, its cable over a shared pulley, its reaction."""
    angle, speed = world.other.T
    variant = str(rng.choice(["shared_pulley", "its_weight", "its_friction"]))
    span = np.ptp(angle)
    law = {
        "shared_pulley": (angle - angle.mean()) / span,
        "its_weight": np.sin(angle + 0.5) - np.mean(np.sin(angle + 0.5)),
        "its_friction": np.tanh(speed / (0.1 * np.abs(speed).max())),
    }[variant]
    return Effect("joint_coupling", variant, "joint", lambda parts, amount: amount * per_joint(world, base, size) * law, needs=("other",))


def contact(world, base, rng, size):
    """Somebody touches it: taps, a push and release, a hand that trembles, leaning, an elastic obstacle held in its way."""
    variant = str(rng.choice(["taps", "push", "tremble", "lean", "obstacle"]))
    out = np.zeros(len(world.q))
    many = {"taps": 8, "push": 5, "tremble": 3, "lean": 2, "obstacle": 3}[variant]
    total = sum(t.t_s[-1] for t in world.trials)
    for _ in range(int(rng.integers(max(2, many // 2), many + 3))):
        s = world.slices[int(rng.integers(len(world.slices)))]
        t = world.t[s]
        start = rng.uniform(0.1, 0.85) * t[-1]
        u, sign = t - start, rng.choice([-1.0, 1.0]) * rng.uniform(0.5, 1.5)
        if variant == "taps":
            width = rng.uniform(0.5, 1.5) / world.lowpass_hz
            out[s] += sign * np.exp(-0.5 * (u / width) ** 2)
        elif variant == "push":
            length = rng.uniform(0.3, 1.5)
            out[s] += sign * np.clip(u / 0.1, 0, 1) * np.clip((length - u) / 0.1, 0, 1)
        elif variant == "tremble":
            length = rng.uniform(0.5, 2.0)
            shake = 1 + 0.4 * np.sin(2 * np.pi * min(6, world.lowpass_hz / 2) * u)
            out[s] += sign * (u > 0) * (u < length) * shake * np.sin(np.pi * np.clip(u / length, 0, 1))
        elif variant == "lean":
            length = min(rng.uniform(2.0, 8.0), 0.3 * total)
            out[s] += sign * np.sin(np.pi * np.clip(u / length, 0, 1)) ** 0.7
        else:
            length = rng.uniform(0.6, 2.5)
            inside = (u > 0) & (u < length)
            if inside.any():
                wall = world.q[s][inside][0]
                moved = np.where(inside, world.q[s] - wall, 0.0)
                out[s] += moved / max(1e-9, np.abs(moved).max()) * abs(sign)
    share = max(1e-3, np.mean(out**2) ** 0.5)
    return Effect("contact", variant, "joint", lambda parts, amount: amount * per_joint(world, base, size) * out, notes={"rms_share": share})


LOADS = {f.__name__: f for f in (
    end_stop, elastic_spring, gravity_phase, torque_ripple, cable_elasticity, inertia, joint_coupling, contact)}
