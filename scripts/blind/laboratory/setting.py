"""All of a case but what is wrong: a joint, its campaign, its sensors, and what is known of it."""
import dataclasses

import numpy as np

from absorb import Absorber
from campaign import Campaign, noise, record
from draw import Unfit, digits, log_uniform, uniform
from joints import NEED_GRAVITY, draw_base, draw_inertia
from plant import Base, winch_torque
from world import World

MOST_COUNTS = 400000  # of an encoder, a turn
ENCODER_FLOORS = 0.5  # what its steps may leave of a perfect model
DRUM_M = 0.01  # on which a slide's encoder turns
BASE_FLOORS = (0.1, 0.85)  # the most that a model misses the joint by
COARSE_SAMPLES = 25000


@dataclasses.dataclass
class Setting:
    """A joint, its campaign, its sensors and its model."""

    campaign: Campaign
    logged: World  # at the recording's rate
    base: Base  # the model handed over
    truth: Base  # the joint as it is
    y: np.ndarray  # torque by the model
    true_y: np.ndarray  # torque of the joint without what is wrong
    order: int  # of the low-pass
    noise: np.ndarray
    noise_kind: str
    step: float  # of the converter, 0 without
    floor: float
    widths: dict  # by name: half of the declared interval, as a share of the value
    declared: bool
    absorber: Absorber
    coarse: int  # steps of the fine clock per sample of the absorber's
    base_error: float = 0.0  # floors
    angle: np.ndarray | None = None  # as read
    counts: float | None = None  # of the encoder, a turn
    encoder_error: float = 0.0  # floors

    def thinned(self, torque):
        """As the absorber has it: low-passed and thinned."""
        world, campaign = self.campaign.world, self.campaign
        low = world.low(torque, campaign.lowpass_hz, self.order)
        return world.every(low, self.coarse)[:: self.absorber.stride]


def rms(x):
    return float(np.sqrt(np.mean(np.square(x))))


def draw_setting(rng, style, causes, effects, stale, loaded):
    """A joint and its campaign in which the causes can show; `loaded`: whether a measured load may act."""
    prismatic = style != "uniform" and rng.random() < 0.14 and not set(causes) & NEED_GRAVITY
    campaign = record(rng, style, prismatic, causes)
    world = campaign.world
    needed = [*effects, *(c for c in stale if c != "inertia")]
    base = draw_base(rng, campaign, needed, 0.04 if style == "uniform" else 0.08)
    if "inertia" in stale and base.inertia_kg_m2 == 0:
        base.inertia_kg_m2 = draw_inertia(rng, prismatic, base.gravity_nm, (0.012, 0.035), (0.01, 0.06))
    check_base(base, style, stale)
    if rng.random() < 0.07 and loaded:
        world.load = measured_load(rng, world, base)
    if style == "uniform" and (np.ptp(np.sin(world.q)) < 0.35 or len({t["speed"] for t in campaign.trials}) < 3):
        raise Unfit("uniform sweeps need a changing load and speeds")
    order = int(rng.choice([4, 4, 4, 2, 3]))
    y = winch_torque(world, base)
    if not np.all(np.isfinite(y)):
        raise Unfit("no number")
    logged = world.thinned(campaign.fine)
    noises = draw_noise(rng, campaign, logged, y, order)
    setting = draw_model(rng, campaign, logged, base, y, order, noises)
    draw_encoder(rng, setting)
    return setting


def check_base(base, style, stale):
    if style == "uniform" and base.gravity_nm == 0:
        raise Unfit("uniform sweeps need a load")
    if "backlash_width" in stale and base.combination["kind"] == "sign":
        raise Unfit("no clearance in the model")
    if "stribeck_level" in stale and base.up["b_c"] == 0:
        raise Unfit("no Stribeck friction in the model")


def measured_load(rng, world, base):
    """A load at the joint that the campaign records."""
    size = (base.gravity_nm or 1.0) * uniform(rng, 0.1, 0.5) * (5 if world.prismatic else 1)
    load = np.zeros(world.size)
    for s in world.slices:
        load[s] = size * np.sin(6.2832 * world.t[s] * uniform(rng, 0.02, 0.2) + uniform(rng, 0, 6.28))
    return load


def draw_noise(rng, campaign, logged, y, order):
    """(noise, its kind, step of the converter, floor): a floor of 0.2 to 1.4 % of the range of torque."""
    reading = campaign.world.every(y, campaign.fine)
    added, kind = noise(rng, campaign)
    low = np.std(logged.low(added, campaign.lowpass_hz, order))
    loud = np.std(added) / low
    size = min(log_uniform(rng, 0.002, 0.014), 0.07 / loud) * np.ptp(y)
    added = added * size / low
    step, seen = 0.0, added
    if rng.random() < 0.3:
        step = digits(np.std(added) * uniform(rng, 0.3, 2.5), 2)
        seen = np.round((reading + added) / step) * step - reading
    floor = rms(logged.low(seen, campaign.lowpass_hz, order))
    return added, kind, step, floor


def draw_model(rng, campaign, logged, base, y, order, noises):
    """The joint as it is: the model, moved within what it declares, or within 2 % where it declares nothing."""
    *sensor, floor = noises
    world, lowpass_hz = campaign.world, campaign.lowpass_hz
    names = base.names()
    declared = rng.random() < 0.6
    widths = {n: uniform(rng, 0.01, 0.05) if declared else 0.05 for n in names}
    sd = {n: w / 2 for n, w in widths.items()}
    changes = {}
    for n in names:
        spread, most = (sd[n], 1.8 * sd[n]) if declared else (0.012, 0.02)
        changes[n] = float(np.clip(rng.standard_normal() * spread, -most, most))
    coarse = coarse_step(campaign)
    independent = max(2 * lowpass_hz * campaign.seconds, 60)
    absorber = Absorber(world.thinned(coarse), base, lowpass_hz, order, floor, sd, independent)
    known = (floor, widths, declared, absorber, coarse)
    setting = Setting(campaign, logged, base, base, y, y, order, *sensor, *known)
    error = rms(setting.thinned(winch_torque(world, base.scaled(changes)) - y)) / floor
    most = uniform(rng, *BASE_FLOORS)
    if error > most:
        changes = {n: change * most / error for n, change in changes.items()}
    setting.truth = base.scaled(changes)
    setting.true_y = winch_torque(world, setting.truth)
    setting.base_error = rms(setting.thinned(setting.true_y - y)) / floor
    if setting.base_error > 1:
        raise Unfit("base error")
    return setting


def coarse_step(campaign):
    """Steps of the fine clock that still show what the low-pass lets through."""
    rate_hz, lowpass_hz = campaign.world.rate_hz, campaign.lowpass_hz
    step = max(1, int(rate_hz / max(10 * lowpass_hz, 40)))
    while campaign.world.size / step > COARSE_SAMPLES and rate_hz / (step + 1) > 6 * lowpass_hz:
        step += 1
    return step


def draw_encoder(rng, setting):
    """An encoder that shows the motion well enough to evaluate the model; in a fifth of the cases one without steps."""
    world, logged, campaign = setting.campaign.world, setting.logged, setting.campaign
    counts = None if rng.random() < 0.2 else digits(log_uniform(rng, 500, 100000), 3)
    turn = 2 * np.pi * DRUM_M if world.prismatic else 2 * np.pi
    exact = world.every(world.q, campaign.fine)
    angle, error = exact, 0.0
    for _ in range(6):
        if counts is None:
            angle = exact
            break
        step = turn / counts
        angle = np.round(exact / step) * step
        seen = torque_by_reading(setting, angle, step)
        off = seen - world.every(setting.y, campaign.fine)
        error = rms(logged.low(off, campaign.lowpass_hz, setting.order)) / setting.floor
        if error < ENCODER_FLOORS:
            break
        counts = counts * 3
        if counts > MOST_COUNTS:
            counts = None
    setting.angle, setting.counts = angle, counts
    setting.encoder_error = 0.0 if counts is None else error


def torque_by_reading(setting, angle, step):
    """What the model says of angles read in steps; wiggles of less than a step at rest are no turns."""
    logged, base, prismatic = setting.logged, setting.base, setting.campaign.world.prismatic
    rate_hz, lowpass_hz = setting.campaign.rate_hz, setting.campaign.lowpass_hz
    cutoff_hz = min(max(4 * lowpass_hz, 8), 0.35 * rate_hz)
    q = logged.low(angle, cutoff_hz, 2)
    v = logged.rate_of(q)
    a = logged.rate_of(logged.low(v, cutoff_hz, 2))
    clocks = (logged.t, logged.wall, logged.trial, rate_hz)
    read = World(q, v, a, *clocks, prismatic=prismatic, load=logged.load)
    if base.combination["kind"] == "sign":
        return winch_torque(read, base)
    held = np.concatenate([play(angle[s], 0.75 * step) for s in logged.slices])
    share = World(held, held, held, *clocks, prismatic=prismatic).share(base)
    return winch_torque(read, base, share=share)


def play(x, width):
    """What a fork of that half-width drags along."""
    held, out = x[0], []
    for value in x.tolist():
        if value > held + width:
            held = value - width
        elif value < held - width:
            held = value + width
        out.append(held)
    return np.array(out)
