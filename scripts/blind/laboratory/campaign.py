"""A campaign: motions followed on a fine clock, a second joint, temperature and noise where there are any."""
import dataclasses

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.ndimage import gaussian_filter1d
from scipy.signal import lfilter

from draw import Unfit, digits, log_uniform, pick, uniform
from motions import REFERENCE_HZ, followed, moves, sines
from styles import reference
from world import World

RATES_HZ = (50, 100, 200, 250, 500, 1000, 2000)
SECONDS = (30, 620)  # of a campaign, as told
RECORDED_S = (30, 605)
SAMPLES = (5000, 118000)
CUT_S = 0.32  # at either end of a trial: a recording starts and ends in motion, without the smoothing's edges


@dataclasses.dataclass
class Campaign:
    """Motions on a fine clock, and how they are recorded."""

    world: World  # on the fine clock
    trials: list  # what the campaign says of each
    rests: bool
    rate_hz: float  # of the recording
    fine: int  # steps of the fine clock per sample
    lowpass_hz: float
    span: float
    speed: float  # that is usual

    @property
    def seconds(self):
        return self.world.size / self.world.rate_hz


def record(rng, style, prismatic, causes):
    """The motions of a campaign in a style."""
    span = log_uniform(rng, 0.08, 0.4) if prismatic else uniform(rng, 0.5, 1.9)
    middle = uniform(rng, -0.1, 0.3) if prismatic else uniform(rng, -0.3, 1.6)
    speed = span * log_uniform(rng, 0.3, 1.3)
    told, rests = reference(rng, style, middle - span / 2, middle + span / 2, speed)
    seconds = sum(len(q) for q, _ in told) / REFERENCE_HZ
    if not SECONDS[0] <= seconds <= SECONDS[1]:
        raise Unfit("length")
    lowpass_hz = digits(log_uniform(rng, 2, 20), 2)
    enough = [f for f in RATES_HZ if SAMPLES[0] <= seconds * f <= SAMPLES[1] and lowpass_hz <= 0.18 * f]
    if not enough:
        raise Unfit("rate")
    rate_hz = float(rng.choice(enough))
    fine = 1 if rate_hz >= 200 else int(np.ceil(200 / rate_hz))
    fine_hz = rate_hz * fine
    level = uniform(rng, 0.2, 1)  # of the controller's imperfections
    parts = [one_trial(rng, q, fine_hz, span, level, 0.012 if style == "uniform" else 0.15) for q, _ in told]
    if min(len(q) for q in parts) < 1.5 * fine_hz:
        raise Unfit("short trial")
    seconds = sum(len(q) for q in parts) / fine_hz
    if not RECORDED_S[0] <= seconds <= RECORDED_S[1] or seconds * rate_hz < SAMPLES[0]:
        raise Unfit("length")
    world = joined(rng, parts, fine_hz, prismatic, causes)
    return Campaign(world, [about for _, about in told], rests, rate_hz, fine, lowpass_hz, span, speed)


def one_trial(rng, told, fine_hz, span, level, most):
    """A reference as it is followed, on the fine clock."""
    t = np.arange(len(told)) / REFERENCE_HZ
    fine_t = np.arange(int((len(told) - 1) / REFERENCE_HZ * fine_hz)) / fine_hz
    q = followed(rng, CubicSpline(t, told)(fine_t), fine_hz, span, level, most)
    cut = int(CUT_S * fine_hz)
    return q[cut:-cut]


def joined(rng, parts, fine_hz, prismatic, causes):
    """All trials end to end, with pauses between them on the campaign's clock."""
    pause = log_uniform(rng, 0.5, 40)
    clocks, walls, numbers, at = [], [], [], 0.0
    for i, q in enumerate(parts):
        t = np.arange(len(q)) / fine_hz
        clocks.append(t)
        walls.append(at + t)
        numbers.append(np.full(len(q), i))
        at += t[-1] + pause * uniform(rng, 0.5, 1.5)
    wall = np.concatenate(walls)
    v = [np.gradient(q) * fine_hz for q in parts]
    a = [np.gradient(x) * fine_hz for x in v]
    more = {}
    if "joint_coupling" in causes or rng.random() < 0.18:
        more |= second_joint(rng, parts, fine_hz)
    if rng.random() < (0.5 if "warm_up" in causes or "sensor_drift" in causes else 0.12):
        rise = uniform(rng, 4, 18) if rng.random() < 0.8 else 0.1
        more["temperature"] = uniform(rng, 18, 30) + rise * (1 - np.exp(-wall / (wall[-1] * uniform(rng, 0.2, 0.8))))
    columns = [np.concatenate(x) for x in (parts, v, a, clocks)]
    return World(*columns, wall, np.concatenate(numbers), fine_hz, prismatic=prismatic, **more)


def second_joint(rng, parts, fine_hz):
    """A second joint that goes its own way."""
    style = pick(rng, "sines", "moves")
    half, middle, speed = uniform(rng, 0.2, 0.9), uniform(rng, -0.3, 0.8), uniform(rng, 0.3, 1.2)
    angles = []
    for part in parts:
        seconds = len(part) / fine_hz + 0.1
        if style == "sines":
            f = np.exp(rng.uniform(np.log(0.06), np.log(0.5), 3))
            q = sines(middle - half, middle + half, seconds, f, 1 / f**0.8, rng.uniform(0, 6.28, 3), fine_hz)
        else:
            q = moves(rng, middle - half, middle + half, seconds, speed, 2.0, "minjerk", fine_hz)
        angles.append(gaussian_filter1d(q[: len(part)], fine_hz * 0.02, mode="nearest"))
    speeds = [np.gradient(q) * fine_hz for q in angles]
    accelerations = [np.gradient(v) * fine_hz for v in speeds]
    names = ("other_q", "other_v", "other_a")
    return {n: np.concatenate(x) for n, x in zip(names, (angles, speeds, accelerations))}


def noise(rng, campaign):
    """Noise of the reading at the recording's rate, of any size, and what it is made of."""
    rate_hz = campaign.rate_hz
    kind = pick(rng, "white", "ar1", "mixed", "pinkish")
    hum = rate_hz >= 200 and rng.random() < 0.25
    hum_hz = 50 * (1 + 0.002 * rng.standard_normal())
    hum_size = uniform(rng, 0.3, 2)
    tau = log_uniform(rng, 0.003, 0.06)

    def correlated(count, tau):
        keep = np.exp(-1 / rate_hz / tau)
        return lfilter([np.sqrt(1 - keep * keep)], [1, -keep], rng.standard_normal(count + 500))[500:]

    parts = []
    for s in campaign.world.slices:
        count = len(range(0, s.stop - s.start, campaign.fine))
        part = rng.standard_normal(count)
        if kind == "ar1":
            part = correlated(count, tau)
        elif kind == "mixed":
            part = part + 0.6 * correlated(count, tau)
        elif kind == "pinkish":
            part = 0.8 * part
            for size, seconds in ((0.5, 0.004), (0.4, 0.02), (0.3, 0.08)):
                part = part + size * correlated(count, seconds)
        if hum:
            part = part + hum_size * np.sin(6.2832 * hum_hz * np.arange(count) / rate_hz + uniform(rng, 0, 6.28))
        parts.append(part)
    return np.concatenate(parts), kind + (" + 50 Hz hum" if hum else "")
