"""Styles of campaigns: which motions, how many trials, which of them again."""
import numpy as np
from scipy.ndimage import gaussian_filter1d

from draw import digits, log_uniform, uniform
from motions import REFERENCE_HZ, moves, sines, softened, trapezoidal_move, triangle

MOST_S = 560  # of a campaign, as told


def repeated(q, repeats, protocol, trajectory=None):
    """The same reference several times, named where it is not alone."""
    name = {"trajectory": trajectory} if repeats > 1 and trajectory else {}
    return [(q, {"protocol": protocol, "repeat": k + 1} | name) for k in range(repeats)]


class Range:
    """Where the joint may go, and the speed that is usual for it."""

    def __init__(self, low, high, speed):
        self.low, self.high, self.speed = low, high, speed
        self.span = high - low

    def part(self, rng):
        """A part of the range."""
        middle = uniform(rng, self.low + 0.35 * self.span, self.high - 0.35 * self.span)
        half = self.span * uniform(rng, 0.22, 0.5)
        return max(self.low, middle - half), min(self.high, middle + half)


def uniform_sweeps(rng, within):
    """Sweeps at three to seven constant speeds, each once to three times."""
    count = int(rng.integers(3, 8))
    repeats = int(rng.integers(1, 4))
    if repeats > 1:
        count = min(count, 15 // repeats)
    total = uniform(rng, 60, 560)
    factors = np.geomspace(1, log_uniform(rng, 4, 25), count)
    slowest = within.speed * uniform(rng, 0.3, 0.9) / factors[-1] * 1.6
    cycles = int(rng.integers(1, 3))
    rest_s = float(rng.choice([0, 0, 0.4, 1.0]))
    low = within.low + uniform(rng, 0, 0.06) * within.span
    high = within.high - uniform(rng, 0, 0.06) * within.span
    speeds = slowest * factors
    needed = repeats * sum(2 * (high - low) / s * cycles + 2 * rest_s for s in speeds)
    if needed > total:
        speeds = speeds * needed / total
    speeds = np.unique([digits(min(s, (high - low) / 2.5), 2) for s in speeds])
    trials = []
    for speed in speeds:
        q = triangle(low, high, speed, cycles, rest_s)
        q = gaussian_filter1d(q, max(REFERENCE_HZ * uniform(rng, 0.01, 0.05), 1), mode="nearest")
        trials += [(q, about | {"speed": float(speed)}) for q, about in repeated(q, repeats, "uniform")]
    order = rng.permutation(len(trials)) if rng.random() < 0.4 else np.arange(len(trials))
    return [trials[i] for i in order], rest_s > 0


def cosine_cascade(rng, within):
    """Whole periods of cosines, slow to fast, repeated up to four times."""
    low, high = within.part(rng)
    repeats = int(rng.integers(1, 5))
    total = uniform(rng, 60, 550) / repeats
    periods = np.sort([log_uniform(rng, 2, 40) for _ in range(int(rng.integers(2, 6)))])[::-1]
    shortest = np.pi * (high - low) / (2.2 * within.speed)
    periods = np.maximum(periods, shortest * (1 + 0.2 * np.arange(len(periods))[::-1]))
    if periods.sum() > total:
        periods = periods * min(1, total / periods.sum())
    waves = []
    for period in periods:
        angle = 2 * np.pi * np.arange(int(period * REFERENCE_HZ)) / REFERENCE_HZ / period
        waves.append(low + (high - low) * 0.5 * (1 - np.cos(angle)))
    q = softened(np.concatenate(waves), 0.02)
    while len(q) < 15 * REFERENCE_HZ:
        q = np.concatenate([q, q])
    return repeated(q, repeats, "cosine"), False


def sums_of_sines(rng, within):
    """Up to five sums of sines, some of them repeated."""
    count = int(rng.integers(1, 6))
    repeats = int(rng.choice([1, 2, 3])) if count <= 4 else 1
    return free_runs(rng, within, count, repeats, mixed=False), False


def no_repeats(rng, within):
    """Three to eight trials of which no two are alike."""
    count = int(rng.integers(3, 9))
    return free_runs(rng, within, count, 1, mixed=True), True


def free_runs(rng, within, count, repeats, mixed):
    """Sums of sines, each in a part of the range; mixed: among them moves and sweeps."""
    seconds = min(uniform(rng, 12, 90), MOST_S / (count * repeats))
    seconds = max(seconds, 32 / (count * repeats))
    trials = []
    for i in range(count):
        low, high = within.part(rng)
        tones = int(rng.integers(2, 6))
        lowest_hz = max(1.2 / seconds, 0.25 * within.speed / (high - low) * uniform(rng, 0.4, 1.3))
        frequencies_hz = lowest_hz * np.cumsum(rng.uniform(0.5, 1.3, tones))
        if mixed and rng.random() < 0.35:
            q = moves(rng, low, high, seconds, within.speed * uniform(rng, 0.3, 1), 1.5, "trap")
            q = softened(q, 0.03)
        elif mixed and rng.random() < 0.3:
            speed = max(within.speed * log_uniform(rng, 0.1, 0.8), 2.2 * (high - low) / seconds)
            q = triangle(low, high, speed, 20, 0.3)[: int(seconds * REFERENCE_HZ)]
            q = softened(q, 0.03)
        else:
            sizes = 1 / frequencies_hz ** uniform(rng, 0.5, 1.3)
            q = sines(low, high, seconds, frequencies_hz, sizes, rng.uniform(0, 6.28, tones))
        trials += repeated(q, repeats, "free", f"run{chr(97 + i)}")
    return trials


def pick_and_place(rng, within):
    """Moves from place to place with rests."""
    count = int(rng.integers(1, 7))
    repeats = int(rng.choice([1, 1, 2, 3])) if count <= 4 else 1
    seconds = max(min(uniform(rng, 15, 90), MOST_S / (count * repeats)), 34 / (count * repeats))
    shape = str(rng.choice(["minjerk", "trap"]))
    low, high = within.part(rng) if rng.random() < 0.5 else (within.low, within.high)
    speed = within.speed * uniform(rng, 0.35, 1.1)
    longest_rest_s = uniform(rng, 0.4, 3)
    trials = []
    for i in range(count):
        q = moves(rng, low, high, seconds, speed, longest_rest_s, shape)
        q = softened(q, uniform(rng, 0.012, 0.04))
        trials += repeated(q, repeats, "free", f"task{i + 1}")
    return trials, True


def single_long(rng, within):
    """One trial of one to nearly ten minutes."""
    seconds = log_uniform(rng, 60, 580)
    kind = str(rng.choice(["mixed", "sines", "picks"]))
    low, high = within.low, within.high
    if kind == "sines":
        tones = int(rng.integers(3, 8))
        frequencies_hz = within.speed / within.span * np.exp(rng.uniform(np.log(0.03), np.log(0.45), tones))
        q = sines(low, high, seconds, frequencies_hz, 1 / frequencies_hz**0.6, rng.uniform(0, 6.28, tones))
    elif kind == "picks":
        q = moves(rng, low, high, seconds, within.speed * uniform(rng, 0.3, 1), uniform(rng, 0.5, 4), "minjerk")
    else:
        q = of_everything(rng, within, seconds)
    return repeated(softened(q, 0.03), 1, "free"), kind != "sines"


def of_everything(rng, within, seconds):
    """Sweeps, cosines and moves in turn, each from the lower end and back to it."""
    low, high, speed = within.low, within.high, within.speed
    parts, count = [], 0
    while count < seconds * REFERENCE_HZ:
        kind = rng.random()
        if kind < 0.4:
            part = triangle(low, high, speed * log_uniform(rng, 0.08, 0.8), 1, uniform(rng, 0, 0.6))
        elif kind < 0.75:
            period = max(uniform(rng, 3, 15), np.pi * within.span / (2.2 * speed))
            cycles = int(rng.integers(1, 4))
            size = uniform(rng, 0.5, 1)
            angle = 2 * np.pi * np.arange(int(cycles * period * REFERENCE_HZ)) / REFERENCE_HZ / period
            part = low + size * within.span * 0.5 * (1 - np.cos(angle))
        else:
            between = moves(rng, low, high, uniform(rng, 6, 15), speed * 0.7, 1.2, "trap")
            there = trapezoidal_move(low, between[0], speed * 0.6, speed * 2)
            back = trapezoidal_move(between[-1], low, speed * 0.6, speed * 2)
            part = np.concatenate([there, between, back])
        parts.append(part)
        count += len(part)
    return np.concatenate(parts)[: int(seconds * REFERENCE_HZ)]


def periodic_short(rng, within):
    """Six to fifteen repeats of a few short periods."""
    count = int(rng.integers(6, 16))
    period = uniform(rng, 1.2, 5)
    cycles = int(rng.integers(2, 5))
    while period * cycles * count < 33:
        cycles += 1
    low, high = within.part(rng)
    harmonics = np.arange(1, int(rng.integers(1, 4)) + 1)
    phases = np.r_[0, rng.uniform(0, 6.28, len(harmonics) - 1)]
    t = np.arange(int(period * cycles * REFERENCE_HZ)) / REFERENCE_HZ
    q = sum(a * np.sin(2 * np.pi * h * t / period + p) for h, a, p in zip(harmonics, 1 / harmonics**1.5, phases))
    q = q / np.max(np.abs(q))
    half = (high - low) / 2
    fastest = np.max(np.abs(np.gradient(q))) * REFERENCE_HZ * half
    half *= min(1, 3 * within.speed / fastest)
    q = (low + high) / 2 + half * q
    protocol = str(rng.choice(["free", "cosine"]))
    return repeated(q, count, protocol, "cycle" if protocol == "free" else None), False


def chirps(rng, within):
    """Sines that grow faster, and smaller where they must."""
    count = int(rng.integers(1, 5))
    seconds = max(min(uniform(rng, 20, 120), MOST_S / count), 34 / count)
    low, high = within.part(rng)
    same = rng.random() < 0.5
    trials, drawn = [], None
    for i in range(count):
        if drawn is None or not same:
            first = uniform(rng, 0.03, 0.1)
            drawn = (first, min(uniform(rng, 0.4, 1.5), 1.6), bool(rng.random() < 0.5))
        first, last, exponential = drawn
        t = np.arange(int(seconds * REFERENCE_HZ)) / REFERENCE_HZ
        if exponential:
            rate = np.log(last / first)
            cycles = first * seconds / rate * (np.exp(t / seconds * rate) - 1)
        else:
            cycles = first * t + (last - first) * t**2 / 2 / seconds
        phase = 2 * np.pi * cycles
        frequency = np.gradient(phase) * REFERENCE_HZ / 2 / np.pi
        half = np.minimum((high - low) / 2, 2.5 * within.speed / (2 * np.pi * frequency))
        about = {"protocol": "free", "repeat": i + 1 if same else 1}
        if same and count > 1:
            about["trajectory"] = "sweep"
        trials.append(((low + high) / 2 - half * np.cos(phase), about))
    return trials, False


STYLES = {
    "uniform": uniform_sweeps, "cosine": cosine_cascade, "sumsines": sums_of_sines, "pick_place": pick_and_place,
    "single_long": single_long, "periodic_short": periodic_short, "no_repeats": no_repeats, "chirp": chirps,
}


def reference(rng, style, low, high, speed):
    """(reference, what the campaign says of it) of every trial at REFERENCE_HZ, and whether the joint rests in them."""
    return STYLES[style](rng, Range(low, high, speed))
