"""Draws joints and the campaigns that they are recorded in."""
import dataclasses

import numpy as np

import motion
from forms.base import Setting
from plant import Joint

RATES_HZ = (100, 200, 250, 400, 500, 1000)
KNOWN_TO = {  # half width of a realistic 95 % interval, relative: least and most
    "mu_c": (0.005, 0.04), "a_j": (0.01, 0.05), "b_c": (0.03, 0.1), "c_c": (0.03, 0.12), "b_j": (0.03, 0.1), "c_j": (0.03, 0.12),
    "d": (0.02, 0.1), "gravity_nm": (0.004, 0.02), "inertia_kg_m2": (0.03, 0.1), "backlash_m": (0.02, 0.08), "p": (0.01, 0.05),
}
LEG_S = 6.0  # shorter, and little of constant speed is left between the corners
COMMON = 0.15  # how often a joint or campaign has by chance what a cause needs: so that having it tells nothing
RISING_RAD = np.radians(85)  # up to here the load rises with the angle
UNDECLARED = 0.05  # what counts where a model gives no confidence


def log_uniform(rng, low, high):
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def draw_joint(rng, wants):
    """A joint of any size; `wants` are the needs of what is to be put on top."""
    r2 = log_uniform(rng, 0.02, 0.09)
    r1 = r2 * rng.uniform(0.15, 0.6)
    gravity = log_uniform(rng, 0.3, 8.0)
    coulomb = r1 / r2 * gravity * rng.uniform(0.08, 0.5)
    mu = rng.uniform(0.05, 0.4) if rng.random() < 0.7 else rng.choice([0.0, rng.uniform(0.0, 0.02)])
    if "no_load_term" in wants:
        mu = 0.0
    if "load_term" in wants:
        mu = rng.uniform(0.1, 0.4)
    cable, own = rng.uniform(0.1, 0.5), rng.uniform(0.1, 0.4) * (rng.random() < 0.7)
    if "no_stribeck" in wants or ("stribeck" not in wants and rng.random() < COMMON):
        cable, own = 0.0, 0.0
    tilt = 1.0 if "equal_mu" in wants else rng.uniform(0.88, 1.08)
    v_cable, v_own = log_uniform(rng, 0.04, 0.15), log_uniform(rng, 0.15, 0.6)
    viscous = rng.uniform(0.1, 0.6)  # of the Coulomb friction, at 1 rad/s

    def one(sense, size, tilt):
        force = size * coulomb / r1
        return {
            "mu_c": mu * tilt, "a_j": sense * force, "b_c": sense * force * cable, "c_c": sense / (v_cable * r2), "b_j": sense * force * own,
            "c_j": sense / v_own, "d": force * viscous * rng.uniform(0.7, 1.3),
        }

    friction = {"up": one(1, 1.0, 1.0), "down": one(-1, rng.uniform(0.4, 1.2), tilt)}
    arm_m = rng.uniform(0.08, 0.3)
    inertia = gravity / 9.81 * arm_m * rng.uniform(1.0, 1.4)
    if "no_inertia" in wants or ("inertia" not in wants and rng.random() < COMMON):
        inertia = 0.0
    kind = rng.choice(wants["curves"]) if "curves" in wants else rng.choice(["sign", "linear", "arctan"], p=[0.1, 0.35, 0.55])
    backlash_rad = log_uniform(rng, 0.001, 0.004) if "narrow" in wants else log_uniform(rng, 0.008, 0.04)
    return Joint(r1, r2, r2 * backlash_rad, gravity, inertia, friction, (str(kind), rng.uniform(1.2, 3.5)))


@dataclasses.dataclass
class Campaign:
    trials: list
    rate_hz: float
    lowpass_hz: float
    order: int
    running_clock: bool
    encoder_rad: float
    low_rad: float
    high_rad: float


def draw_trajectory(rng, wants, jumps, low, high, length_s):
    """One command: (protocol, speed, command, its own length)."""
    fast = "fast" in wants or rng.random() < COMMON
    top_hz = max(log_uniform(rng, 0.4, 1.1) if fast else log_uniform(rng, 0.08, 0.6), 3 / length_s)
    slowest = 2.2 * (high - low) / length_s
    speed = log_uniform(rng, slowest, max(1.5 * slowest, rng.uniform(0.3, 1.2)))
    kinds = ["multi_sine", "cascade", "multi_sine", "moves"] if fast else ["sweep", "sweep", "sweep", "multi_sine", "cascade", "moves"]
    if "dwells" in wants:
        kinds = ["moves", "moves", "sweep"]
    if jumps and "curves" not in wants:  # a true jump needs reversals that an encoder sees: none within a tiny travel
        kinds = [k for k in kinds if k != "multi_sine"]
    kind = rng.choice(kinds)
    if kind == "sweep":
        return "uniform", speed, *motion.sweep(rng, length_s, low, high, speed)
    if kind == "moves":
        dwell = (0, 0) if jumps or ("dwells" not in wants and rng.random() < 0.4) else (0.3, 2.5)
        return "free", speed, *motion.moves(rng, length_s, low, high, 2 * speed if fast else speed, dwell)
    if kind == "cascade":
        return "cosine", speed, *motion.cascade(rng, length_s, low, high, top_hz)
    return "free", speed, *motion.multi_sine(rng, length_s, low, high, top_hz)


def draw_other(rng, wants, length_s):
    """A command of another joint; sometimes it rests."""
    middle, width = rng.uniform(-0.3, 0.8), rng.uniform(0.4, 1.4)
    if rng.random() < 0.2:
        return lambda t: np.full(len(t), middle)
    top_hz = log_uniform(rng, 0.4, 1.0) if "other_fast" in wants else log_uniform(rng, 0.05, 0.4)
    if rng.random() < 0.5:
        return motion.multi_sine(rng, length_s, middle - width / 2, middle + width / 2, max(top_hz, 3 / length_s))[0]
    return motion.moves(rng, length_s, middle - width / 2, middle + width / 2, width * top_hz * 3, (0.5, 3.0))[0]


def draw_sizes(rng, wants, jumps):
    """Rate, trajectories, repeats and seconds per trial."""
    while True:
        rate = float(rng.choice(RATES_HZ[2:] if jumps else RATES_HZ))
        total_s = log_uniform(rng, 30e3, 140e3) / rate
        total_s = min(total_s, 900.0)
        repeats = int(rng.choice([1, 2, 3], p=[0.1, 0.45, 0.45]))
        trajectories = int(rng.integers(2, 7))
        if rng.random() < 0.06:
            repeats, trajectories = 1, 1
        trials = repeats * trajectories
        if trials > 15 or trials in (2, 3) or total_s / trials < 8 or ("long" in wants and total_s < 200):
            continue
        return rate, trajectories, repeats, total_s / trials


def sweeps_of_use(plans):
    """Whether sweeps may be called uniform: at two speeds or more, every leg long enough, the load changing along it."""
    sweeps = [p for p in plans if p[2] == "uniform"]
    runs = [command(np.linspace(0, own_s, 200)) for *_, command, own_s, _ in sweeps]
    rising = all(q.max() < RISING_RAD and np.sin(q).std() > 0.1 for q in runs)
    return len({p[4] for p in sweeps}) > 1 and rising and all(np.ptp(q) / p[4] > LEG_S for q, p in zip(runs, sweeps))


def draw_campaign(rng, joint, wants):
    jumps = joint.curve[0] == "sign"
    rate, trajectories, repeats, length_s = draw_sizes(rng, wants, jumps)
    width = np.radians(rng.uniform(35, 110))
    low = np.radians(rng.uniform(-30, 40))
    if "both_sides" in wants:
        low = -width * rng.uniform(0.3, 0.6)
    if "narrow" in wants:
        width = np.radians(rng.uniform(4, 8))
        low = np.radians(rng.uniform(65, 110)) - width / 2
    running = "running_clock" in wants or ("zero_clock" not in wants and rng.random() < 0.5)
    pause_s = rng.uniform(0.5, 30) if running else 0.5
    wobble, misplaced = rng.uniform(0.01, 0.06), rng.uniform(0.0002, 0.003)
    with_other = "other" in wants or rng.random() < 2 * COMMON
    plans = []
    for i in range(trajectories):
        share = 1.0 if i == 0 else rng.uniform(0.5, 1.0)
        at = low + width * (1 - share) * rng.random()
        protocol, speed, command, own_s = draw_trajectory(rng, wants, jumps, at, at + share * width, length_s)
        other = draw_other(rng, wants, own_s) if with_other else None
        plans += [(i, r, protocol, f"motion_{i}", speed, command, own_s, other) for r in range(1, repeats + 1)]
    if rng.random() < 0.4:
        plans.sort(key=lambda p: p[1])
    if not sweeps_of_use(plans):
        plans = [(i, r, "free" if p == "uniform" else p, *rest) for i, r, p, *rest in plans]
    trials, start_s = [], 0.0
    for i, repeat, protocol, name, speed, command, own_s, other in plans:
        names = (f"{name}_{repeat}", protocol, name, repeat, speed if protocol == "uniform" else None)
        trials.append(motion.record(rng, command, own_s, rate, start_s, names, wobble, misplaced, not jumps, other))
        start_s += own_s + pause_s * rng.uniform(0.7, 1.3)
    encoder_rad = log_uniform(rng, 5e-6, 8e-5)
    if jumps and "curves" not in wants:  # a true jump must be seen when it comes, or the best of models misses it
        encoder_rad *= 0.01
    lowpass_hz = float(np.round(log_uniform(rng, 3, 15), 1))
    return Campaign(trials, rate, lowpass_hz, int(rng.choice([2, 4, 4, 4])), running, encoder_rad, low, low + width)


def setting(joint, campaign, torques):
    """What forms may be drawn to fit."""
    trials = campaign.trials
    top = max(np.abs(t.v).max() for t in trials)
    length_s = trials[-1].elapsed_s[-1]
    low, high = min(y.min() for y in torques), max(y.max() for y in torques)
    return Setting(joint, trials, campaign.low_rad, campaign.high_rad, top, length_s, low, high)


@dataclasses.dataclass
class Known:
    """How well the model is known: true values, the model's offset from them and the interval, both relative to the truth."""

    values: dict
    offset: np.ndarray
    low: np.ndarray
    high: np.ndarray
    cost_nm: float  # RMS torque that the offsets cost
    given: bool  # whether the model declares its intervals

    def intervals(self):
        return {n: (v * (1 + l), v * (1 + h)) for (n, v), l, h in zip(self.values.items(), self.low, self.high)}


def declared(rng, joint, columns, names, floor_nm):
    """Offsets inside the interval, and small enough that the torque they cost stays near the floor or below."""
    values = joint.values()
    given = rng.random() < 0.8
    half = np.array([log_uniform(rng, *KNOWN_TO[n.rsplit(".", 1)[-1]]) for n in names]) if given else np.full(len(names), UNDECLARED)
    scatter = half if given else np.full(len(names), 0.02)
    offset = np.clip(rng.normal(0, 1 / 1.96, len(names)), -0.95, 0.95) * scatter
    cost_nm = np.sqrt(np.mean((columns @ offset) ** 2))
    shrink = min(1.0, floor_nm * log_uniform(rng, 0.2, 1.2) / cost_nm)
    if given:
        half = half * shrink
    offset = offset * shrink
    return Known({n: values[n] for n in names}, offset, offset - half, offset + half, shrink * cost_nm, given)
