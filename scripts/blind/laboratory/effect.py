"""An effect: where it acts and by which law; the scales of a case by which effects are sized."""
import dataclasses
from typing import Callable

import numpy as np
from scipy.ndimage import gaussian_filter1d

from draw import log_uniform, pick, uniform, Unfit
from plant import branches


@dataclasses.dataclass
class Effect:
    """One form of an effect; it acts through the functions that it has."""

    variant: str
    start: float  # amount at which the search for a strength begins
    most: float  # the largest amount that is physical
    least: float = 1e-9
    mechanics: Callable | None = None  # (parts, amount): changes the parts of the formula
    reading: Callable | None = None  # (torque, amount): the torque that is read
    stretch: Callable | None = None  # (torque, amount): the angle by which the joint stays behind
    creep: Callable | None = None  # the part of that angle which the joint itself follows
    last: bool = False  # of the readings: after the others
    clips: bool = False
    bursts: int = 0


class Scales:
    """What a plant does in a campaign before anything is wrong with it."""

    def __init__(self, world, base, y, floor, lowpass_hz, rests):
        self.world, self.base, self.y = world, base, y
        self.floor, self.lowpass_hz, self.rests = floor, lowpass_hz, rests
        self.low, self.high = world.q.min(), world.q.max()
        self.span = self.high - self.low
        speed = np.abs(world.v)
        self.speeds = speed[speed > 1e-3 * np.max(speed)]
        self.fastest = self.speeds.max()
        self.seconds = sum(s.stop - s.start for s in world.slices) / world.rate_hz
        self.wall_seconds = world.wall[-1]
        self.trials = len(world.slices)
        self.turns = sum(len(runs) for runs in world.runs)
        self.ratio = base.r1_m / base.r2_m
        self.carried = 1 - (base.up["mu_c"] + base.down["mu_c"]) / 2
        self.gain = self.ratio / self.carried  # reading by torque at the joint
        up, down = branches(base, speed)
        self.friction = float(np.mean(up - down)) / 2
        self.reach = np.ptp(y)
        self.top = np.max(np.abs(y))
        external = world.load if world.load is not None else 0
        self.load = base.gravity_nm * np.sin(world.q) + base.inertia_kg_m2 * world.a + external
        self.load_reach = np.ptp(self.load)
        self.load_top = np.max(np.abs(self.load)) + 1e-12
        self.a_top, self.a_rms = np.max(np.abs(world.a)), np.std(world.a)


def smooth(world, x, seconds):
    """A Gaussian over each trial."""
    out = np.empty_like(x)
    for s in world.slices:
        out[s] = gaussian_filter1d(x[s], max(seconds * world.rate_hz, 0.5), mode="nearest")
    return out


def both_ways(parts, up, down):
    """Friction added against the motion of either direction."""
    parts.friction_up = parts.friction_up + up
    parts.friction_down = parts.friction_down - down


def wave(rng, scales, forms):
    """A function of the angle that repeats: (form, waves per unit of angle, function).

    At least one period lies in the range, none is faster than the low-pass at middling speed.
    """
    middling = np.quantile(scales.speeds, 0.5)
    fastest = 2 * np.pi * 0.5 * scales.lowpass_hz / max(middling, 1e-9)
    least = 2 * np.pi * 1.0 / scales.span
    if fastest < least * 1.2:
        raise Unfit("ripple above the low-pass")
    most = min(fastest, 2 * np.pi * 12 / scales.span)
    drum = scales.base.r2_m / scales.base.r1_m
    form = pick(rng, *forms)
    phase = uniform(rng, 0, 6.28)
    k = log_uniform(rng, least, most)
    if form == "drum_once" and not scales.world.prismatic and least * 0.9 < drum < most:
        k = drum
    second, third = uniform(rng, 0.15, 0.6), uniform(rng, 0, 0.3)
    k2 = k * uniform(rng, 1.3, 2.4) if form == "two_tones" else 0.0

    def function(q):
        x = k * q + phase
        if form == "harmonics":
            return np.sin(x) + second * np.sin(2 * k * q + 2.1 * phase) + third * np.sin(3 * k * q + 0.7 * phase)
        if form == "sawtooth":
            return np.tanh(3 * np.sin(x)) * 0.8 + 0.4 * np.cos(x)
        if form == "growing":
            return np.sin(x) * (0.4 + 1.2 * np.clip((q - scales.low) / scales.span, 0, 1))
        if form == "two_tones":
            return np.sin(x) + 0.7 * np.sin(k2 * q + 3 * phase)
        if form == "lumps":
            return np.exp(2.0 * (np.cos(x) - 1)) - 0.3
        return np.sin(x)

    return form, k, function
