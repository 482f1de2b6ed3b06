"""Gaps that no effect of the library names: faults of machines as they happen."""
import numpy as np

from effect import Effect, by_segment, log_uniform
from frictions import lagged
from loads import per_joint


def fading_detent(world, base, rng, size):
    """Magnets that hold where it stands, less so when it moves on: torque by place that speed undoes."""
    span, slow = np.ptp(world.q), 0.15 * np.abs(world.v).max()
    wave = np.sin(2 * np.pi * rng.uniform(2, 5) * world.q / span + rng.uniform(0, 6)) * np.exp(-np.abs(world.v) / slow)
    return "joint", wave, ()


def cable_off_pulley(world, base, rng, size):
    """In the midst of the campaign the cable jumps to another groove: friction by place and direction is another one afterwards."""
    jump = rng.uniform(0.3, 0.7) * world.elapsed.max()
    after = world.elapsed > jump
    x = (world.q - world.q.min()) / np.ptp(world.q)
    return "friction", after * np.where(x > 0.5, 1.0, -0.7) * world.direction * np.abs(np.sin(2 * np.pi * x)), ("clock",)


def supply_sags(world, base, rng, size):
    """The drive draws, the bridge's supply falls, recovers late: readings shrink with what power was a moment before."""
    power = np.abs(world.v * world.a)
    sag = world.by_trial(lambda s: lagged(power[s], 0.6 * world.rate_hz))
    return "reading_times", -sag / max(1e-12, np.quantile(sag, 0.95)), ()


def resonant_speed(world, base, rng, size):
    """A belt or a string that swings at one speed alone: torque is lost around it."""
    v = np.abs(world.v)
    at = np.quantile(v, 0.98) * rng.uniform(0.35, 0.7)
    return "friction", np.exp(-(((v - at) / (0.12 * at)) ** 2)) * world.direction, ()


def viscoelastic(world, base, rng, size):
    """A sheath that relaxes: a spring whose force dies in a second or two."""
    tau = rng.uniform(0.5, 2.0)
    return "joint", world.q - world.by_trial(lambda s: lagged(world.q[s], tau * world.rate_hz)), ()


def remembers_extreme(world, base, rng, size):
    """Rubber that was stretched stays soft up to where it has been (Mullins): a force by the largest angle so far."""
    reach = world.by_trial(lambda s: np.maximum.accumulate(world.q[s]))
    inner = world.by_trial(lambda s: np.minimum.accumulate(world.q[s]))
    return "joint", (world.q - inner) * (1.0 - (reach - inner) / np.ptp(world.q)) * np.abs(world.q - reach) / np.ptp(world.q) ** 2, ()


def sticks_after_rest(world, base, rng, size):
    """Friction that grew while it stood (Rabinowicz), gone after a short way: by the time since it last moved slowly."""
    slow = np.abs(world.v) < 0.1 * np.quantile(np.abs(world.v), 0.9)

    def one(s):
        out, waited, q0 = np.zeros(s.stop - s.start), 0.0, world.q[s.start]
        way = 0.05 * np.ptp(world.q)
        for i in range(s.stop - s.start):
            if slow[s.start + i]:
                waited += 1 / world.rate_hz
                q0 = world.q[s.start + i]
            else:
                moved = abs(world.q[s.start + i] - q0)
                out[i] = np.log1p(5 * waited) * np.exp(-moved / way)
                if moved > 4 * way:
                    waited = 0.0
        return out * world.direction[s]

    return "friction", world.by_trial(one), ()


def string_vibrates(world, base, rng, size):
    """Each turn plucks the cable: it rings and dies away at its own frequency."""
    f = world.lowpass_hz * rng.uniform(0.3, 0.6)

    def one(s):
        d, t, out = world.direction[s], world.t[s], np.zeros(s.stop - s.start)
        for i in np.flatnonzero(np.diff(d)):
            u = np.maximum(0, t - t[i])
            out += d[i + 1] * (t > t[i]) * np.exp(-u * f / 1.5) * np.sin(2 * np.pi * f * u)
        return out

    return "friction", world.by_trial(one), ()


def friction_by_jerk(world, base, rng, size):
    """Rollers that skid when the drive changes its pull: friction by speeding up or slowing down."""
    push = np.sign(world.v) * np.sign(world.a)
    return "friction", world.by_trial(lambda s: lagged(push[s], 0.05 * world.rate_hz)) * world.direction, ()


def drag_by_place(world, base, rng, size):
    """A bush worn in the middle: the viscous drag is another one by place."""
    x = (world.q - world.q.min()) / np.ptp(world.q)
    return "friction", world.v / np.abs(world.v).max() * np.cos(2 * np.pi * rng.uniform(0.8, 1.6) * x), ()


def slip_stick_teeth(world, base, rng, size):
    """A ratchet: torque rises along each tooth and falls off it, teeth as passed since the last turn."""
    tooth = np.ptp(world.q) * rng.uniform(0.12, 0.25)

    def step(dx, direction, state):
        way = np.abs(dx)
        return direction * (np.mod(way, tooth) / tooth - 0.5), None

    return "friction", by_segment(world, step), ()


def mains_beat(world, base, rng, size):
    """A neighbour's machine on the same mains: a slow beat on the sensor's line that keeps the clock, not the motion."""
    f = log_uniform(rng, 0.4, 0.5 * world.lowpass_hz)
    beat = np.sin(2 * np.pi * f * world.elapsed + rng.uniform(0, 6)) * (1 + 0.5 * np.sin(2 * np.pi * 0.07 * world.elapsed))
    return "reading_plus", beat, ("clock",)


def centrifugal(world, base, rng, size):
    """A mass that slides out on its arm: torque by the square of the speed, and by place, whatever the direction."""
    x = (world.q - world.q.min()) / np.ptp(world.q)
    return "joint", (world.v / np.abs(world.v).max()) ** 2 * np.cos(np.pi * x + 0.4), ()


OUTSIDE = {f.__name__: f for f in (
    fading_detent, cable_off_pulley, supply_sags, resonant_speed, viscoelastic, remembers_extreme, sticks_after_rest, string_vibrates,
    friction_by_jerk, drag_by_place, slip_stick_teeth, mains_beat, centrifugal)}


def outside(name, world, base, rng, size):
    """One of them as an effect."""
    place, wave, needs = OUTSIDE[name](world, base, rng, size)
    scale = 1 / max(1e-12, float(np.std(wave)))
    if place == "joint":
        law = lambda parts, amount: amount * per_joint(world, base, size) * scale * wave
    elif place == "friction":
        law = lambda parts, amount: amount * size * scale * wave
    elif place == "reading_plus":
        place, law = "reading", lambda parts, y, amount: y + amount * size * scale * wave
    else:
        place, law = "reading", lambda parts, y, amount: y * (1 + 0.3 * amount * wave)
    return Effect("unknown", name, place, law, needs=needs)
