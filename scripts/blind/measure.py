"""How strong an effect is: low-passed, and after the base has absorbed what its confidence lets it."""
import numpy as np
from scipy.optimize import lsq_linear
from scipy.signal import butter, sosfiltfilt

from plant import drive

KEPT_PER_CUTOFF = 5  # samples kept per period of the low-pass's corner: above its Nyquist rate
FOLDS = 4
STRETCHES = 24  # into which a lone trial is cut, its folds taking turns


class Ruler:
    """The campaign's low-pass; cuts every trial to the samples that count, at a rate that is enough for it."""

    def __init__(self, trials, joint, lowpass_hz, order):
        self.sos = {t.name: butter(order, lowpass_hz, fs=t.rate_hz, output="sos") for t in trials}
        self.kept = {}
        for t in trials:
            passed = np.flatnonzero(np.abs(t.q - t.q[0]) * joint.r2_m >= joint.backlash_m)
            first = int(passed[0]) if len(passed) else 0
            self.kept[t.name] = slice(first, None, max(1, int(t.rate_hz / (KEPT_PER_CUTOFF * lowpass_hz))))
        self.trials = trials

    def lowpass(self, trial, y):
        return sosfiltfilt(self.sos[trial.name], y)

    def cut(self, series):
        """A list of one array per trial -> one low-passed array of all kept samples."""
        return np.concatenate([self.lowpass(t, y)[self.kept[t.name]] for t, y in zip(self.trials, series)])

    def folds(self):
        """The fold of every kept sample: by trial, by stretches of time when there is but one."""
        sizes = [len(t.q[self.kept[t.name]]) for t in self.trials]
        if len(sizes) == 1:
            return np.arange(sizes[0]) * STRETCHES // sizes[0] % FOLDS
        return np.concatenate([np.full(n, i % FOLDS) for i, n in enumerate(sizes)])


def rms(x):
    return float(np.sqrt(np.mean(np.square(x))))


def record_all(joint, trials, forms=(), noise=None):
    """The torque of every trial."""
    return [drive(joint, t, forms, None if noise is None else noise[i])[0] for i, t in enumerate(trials)]


def jacobian(joint, ruler, forms=()):
    """Names of the base's parameters and d(low-passed torque) / d(relative change of each)."""
    names, columns = [], []
    for name, value in joint.values().items():
        if value == 0:
            continue
        step = 1e-3
        up = record_all(joint.altered({name: value * (1 + step)}), ruler.trials, forms)
        down = record_all(joint.altered({name: value * (1 - step)}), ruler.trials, forms)
        names.append(name)
        columns.append(ruler.cut([(u - d) / (2 * step) for u, d in zip(up, down)]))
    return names, np.column_stack(columns)


class Absorber:
    """Least squares on the base's columns, each coefficient within bounds, further columns free."""

    def __init__(self, columns, low, high):
        self.q, self.r = np.linalg.qr(columns)
        self.low, self.high = low, high

    def beside(self, free):
        """The same with some further columns that may take any size; their part outside the base's span is all that is new."""
        if not len(free):
            return self
        free = np.column_stack(free)
        shared = self.q.T @ free
        q, r = np.linalg.qr(free - self.q @ shared)
        both = Absorber.__new__(Absorber)
        both.q = np.column_stack([self.q, q])
        both.r = np.block([[self.r, shared], [np.zeros((len(r), len(self.r))), r]])
        wide = np.full(free.shape[1], np.inf)
        both.low, both.high = np.concatenate([self.low, -wide]), np.concatenate([self.high, wide])
        return both

    def fit(self, target):
        return lsq_linear(self.r, self.q.T @ target, (self.low, self.high), method="bvls", max_iter=200).x

    def left(self, target):
        """RMS of what the base cannot absorb of the target."""
        inside = self.q.T @ target
        p = lsq_linear(self.r, inside, (self.low, self.high), method="bvls", max_iter=200).x
        outside = target @ target - inside @ inside
        return float(np.sqrt(max(0.0, outside + np.sum((self.r @ p - inside) ** 2)) / len(target)))


def held_out_shrink(ruler, columns, low, high, forms, gap, noise):
    """1 - gap after / gap before with the true form, its size and the base fitted on noisy trials and judged on others, without noise.

    `forms` are the true columns at true size, `gap` is truth - model without noise, `noise` the low-passed noise.
    """
    fold = ruler.folds()
    matrix = np.column_stack([columns, *forms])
    left = np.empty_like(gap)
    for k in range(FOLDS):
        seen = fold != k
        if seen.all():
            continue
        p = Absorber(columns[seen], low, high).beside([f[seen] for f in forms]).fit((gap + noise)[seen])
        left[~seen] = (gap - matrix @ p)[~seen]
    return 1 - rms(left) / rms(gap)
