"""The motion of a campaign, and the change of branch that follows from it."""
import numpy as np
from scipy.signal import butter, sosfiltfilt


class World:
    """The motion of a campaign, its trials end to end."""

    def __init__(self, q, v, a, t, wall, trial, rate_hz, prismatic=False, **more):
        self.q, self.v, self.a = q, v, a
        self.t, self.wall, self.trial = t, wall, trial  # clock of the trial, clock of the campaign, number of the trial
        self.rate_hz, self.prismatic = rate_hz, prismatic
        self.other_q, self.other_v, self.other_a = (more.get(f"other_{n}") for n in "qva")  # a second joint
        self.load, self.temperature = more.get("load"), more.get("temperature")
        self.size = len(q)
        count = int(trial.max()) + 1
        edges = np.searchsorted(trial, np.arange(count + 1))
        self.slices = [slice(edges[i], edges[i + 1]) for i in range(count)]
        self.runs = [self._runs_of(s) for s in self.slices]
        self.before = [self._before(runs) for runs in self.runs]
        self._shares = {}

    def _runs_of(self, s):
        """(first, end, direction) of every stretch of one direction; a rest belongs to the stretch before it."""
        step = np.diff(self.q[s])
        sign = np.sign(step)
        sign[np.abs(step) < 1e-9 * (np.ptp(self.q) + 1e-12)] = 0
        moving = np.flatnonzero(sign)
        if len(moving) == 0:
            return [(s.start, s.stop, 1)]
        signs = sign[moving]
        changes = np.flatnonzero(np.diff(signs) != 0) + 1
        starts = np.r_[0, moving[changes]]
        ends = np.r_[starts[1:], s.stop - s.start]
        directions = signs[np.r_[0, changes]]
        return [(s.start + int(i), s.start + int(j), int(d)) for i, j, d in zip(starts, ends, directions)]

    def _before(self, runs):
        """The direction that the trial found: that of its first motion over more than a tenth of the range."""
        last = runs[-1][1] - 1
        far = 0.1 * np.ptp(self.q)
        sustained = [d for i, j, d in runs if abs(self.q[min(j, last)] - self.q[i]) > far]
        return sustained[0] if sustained else runs[0][2]

    def thinned(self, step):
        """Every `step`-th sample of each trial, as a world of its own."""
        take = lambda x: None if x is None else self.every(x, step)
        names = ("other_q", "other_v", "other_a", "load", "temperature")
        more = {n: take(getattr(self, n)) for n in names}
        columns = [take(x) for x in (self.q, self.v, self.a, self.t, self.wall, self.trial)]
        return World(*columns, self.rate_hz / step, prismatic=self.prismatic, **more)

    def every(self, x, step):
        return np.concatenate([x[s][::step] for s in self.slices])

    def low(self, x, cutoff_hz, order):
        """Low-passed by trial, zero phase."""
        sos = butter(order, cutoff_hz / (self.rate_hz / 2), output="sos")
        out = np.empty_like(x, dtype=float)
        for s in self.slices:
            edge = min(s.stop - s.start - 1, int(3 * self.rate_hz / cutoff_hz))
            out[..., s] = sosfiltfilt(sos, x[..., s], axis=-1, padlen=edge)
        return out

    def rate_of(self, x):
        """The derivative by time."""
        out = np.empty_like(x)
        for s in self.slices:
            out[s] = np.gradient(x[s]) * self.rate_hz
        return out

    def passage(self, x, width, shape):
        """Share of the upward branch: at each turn a curve over the travel `width`.

        Where a turn interrupts it, the next one goes on from there. `shape` maps the progress of the travel to that of
        the share, both 0 to 1.
        """
        out = np.empty(self.size)
        width = max(width, 1e-12)
        for runs, before in zip(self.runs, self.before):
            place, share = float(before), (1.0 if before > 0 else 0.0)
            for i, j, direction in runs:
                left = 1.0 - direction * place
                end = 1.0 if direction > 0 else 0.0
                if left < 1e-9:
                    out[i:j] = end
                    place, share = float(direction), end
                    continue
                progress = np.minimum(2 * np.abs(x[i:j] - x[i]) / width / left, 1.0)
                out[i:j] = share + shape(progress) * (end - share)
                at_turn = progress[-1]
                if j < runs[-1][1]:
                    at_turn = min(2 * abs(x[min(j, self.size - 1)] - x[i]) / width / left, 1.0)
                share = share + float(shape(np.array(at_turn))) * (end - share)
                place = place + direction * left * at_turn
        return out

    def dahl(self, x, reach, exponent=1.0):
        """Share of the upward branch by Dahl's law with an exponent: dz/dx = (1 - z)^exponent / reach."""
        out = np.empty(self.size)
        for runs, before in zip(self.runs, self.before):
            z = float(before)
            for i, j, direction in runs:
                turn = min(j, runs[-1][1] - 1)
                travel = np.abs(np.r_[x[i:j], x[turn]] - x[i]) / reach
                left = 1 - direction * z
                if left < 1e-12:
                    remains = np.zeros_like(travel)
                elif abs(exponent - 1) < 1e-6:
                    remains = left * np.exp(-travel)
                elif exponent > 1:
                    remains = (left ** (1 - exponent) + (exponent - 1) * travel) ** (-1 / (exponent - 1))
                else:
                    remains = np.maximum(left ** (1 - exponent) - (1 - exponent) * travel, 0) ** (1 / (1 - exponent))
                filled = direction * (1 - remains)
                out[i:j] = filled[:-1]
                z = float(filled[-1])
        return (out + 1) / 2

    def share(self, base):
        """Share of the upward branch as the base has it."""
        curve = base.combination
        if curve["kind"] == "sign":
            return (self.v >= 0).astype(float)
        key = (base.backlash_m, base.r2_m, curve["kind"], curve.get("p"), curve.get("n"))
        if key not in self._shares:
            if len(self._shares) > 6:
                self._shares.clear()
            self._shares[key] = self.passage(self.q * base.r2_m, base.backlash_m, shape_of(curve))
        return self._shares[key]


def shape_of(combination):
    """Progress of the change of branch by progress of the travel, both 0 to 1."""
    kind = combination["kind"]
    if kind == "linear":
        return lambda u: u
    if kind == "arctan":
        p = combination["p"]
        return lambda u: np.arctan(2 * p * u) / np.arctan(2 * p)
    n = combination["n"]
    return lambda u: np.asarray(u) ** n
