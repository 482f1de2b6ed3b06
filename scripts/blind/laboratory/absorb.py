"""What remains of a gap once the base has moved within its confidence and chosen shapes have been fitted, in floors.

Least squares of low-passed, thinned torque, weighted as so many independent samples as the low-pass leaves. A parameter
of the base pays for moving (a standard deviation of its confidence costs as much as one of the noise in one of those
samples) and never moves by more than two.
"""
import numpy as np
from scipy.optimize import lsq_linear

from plant import jacobian

MOST_ROWS = 3500
TIGHT = 0.15  # floors: what a standard deviation of a parameter costs where shapes are only chosen among
BURST_S = (0.4, 0.8, 1.5, 3, 6)


class Column:
    """A shape: weighted, and with what the base can do of it taken out."""

    __slots__ = ("weighted", "apart")

    def __init__(self, weighted, apart):
        self.weighted, self.apart = weighted, apart


class Absorber:
    """The base's columns in a campaign, and what they and further shapes leave of a gap."""

    def __init__(self, world, base, lowpass_hz, order, floor, sd, independent):
        self.world, self.base = world, base
        self.lowpass_hz, self.order, self.floor, self.independent = lowpass_hz, order, floor, independent
        self.names, columns, self.y = jacobian(world, base)
        self.stride = max(1, int(np.ceil(world.size / MOST_ROWS)))
        self.base_columns = self.low(columns).T
        self.rows = len(self.base_columns)
        self.rate_hz = world.rate_hz / self.stride
        self.weight = np.sqrt(independent / self.rows) / floor
        count = len(self.names)
        weighted = self.base_columns * self.weight * np.array([sd[n] for n in self.names])
        tight = np.eye(count) * np.sqrt(1 + independent * TIGHT**2)
        self.directions, _ = np.linalg.qr(np.vstack([weighted, tight]))
        self.base_rows = np.vstack([weighted, np.eye(count)])

    def low(self, x):
        """Low-passed and thinned."""
        return self.world.low(x, self.lowpass_hz, self.order)[..., :: self.stride]

    def columns(self, x):
        """Columns of low-passed, thinned torques, one a row."""
        x = np.atleast_2d(x) * self.weight
        apart = np.hstack([x, np.zeros((len(x), len(self.names)))])
        apart = apart - (apart @ self.directions) @ self.directions.T
        return [Column(w, a) for w, a in zip(x, apart)]

    def left(self, gap, shapes=()):
        """RMS that remains of a gap, the base within its bounds, the shapes free."""
        p, k = len(self.names), len(shapes)
        design = np.zeros((self.rows + p, p + k + 1))
        design[:, :p] = self.base_rows
        for i, c in enumerate(shapes):
            design[: self.rows, p + i] = c.weighted / (np.linalg.norm(c.weighted) + 1e-12) * np.sqrt(self.independent)
        design[: self.rows, -1] = gap.weighted
        triangle = np.linalg.qr(design, mode="r")
        matrix, target = triangle[:, :-1], triangle[:, -1]
        x = np.linalg.lstsq(matrix, target, rcond=1e-10)[0]
        if np.any(np.abs(x[:p]) > 2):
            bounds = np.r_[np.full(p, 2.0), np.full(k, np.inf)]
            method = "trf" if k and np.linalg.cond(matrix) > 1e9 else "bvls"
            x = lsq_linear(matrix, target, bounds=(-bounds, bounds), method=method, lsq_solver="exact").x
        rest = design[: self.rows, -1] - design[: self.rows, :-1] @ x
        return float(np.sqrt(rest @ rest / self.independent))

    def net(self, torque):
        """RMS of a low-passed, thinned torque after the base has absorbed what it may."""
        return self.left(self.columns(torque)[0])


def space(columns):
    """Orthonormal directions of columns; None without any."""
    if not columns:
        return None
    matrix = np.array([c.apart for c in columns]).T
    size = np.linalg.norm(matrix, axis=0)
    matrix = matrix[:, size > 1e-9] / size[size > 1e-9]
    if matrix.shape[1] == 0:
        return None
    u, values, _ = np.linalg.svd(matrix, full_matrices=False)
    return u[:, values > 1e-6 * values[0]]


def without(q, x):
    """x without its part in the space q."""
    return x if q is None else x - q @ (q.T @ x)


def bursts(absorber, gap, others, most):
    """So many half-cosine pushes, each where it takes most of what the others leave."""
    rows = absorber.rows
    lengths = [int(s * absorber.rate_hz) for s in BURST_S if 4 <= s * absorber.rate_hz < rows / 4]
    found = []
    rest = without(space(others), gap.apart)
    for _ in range(most):
        best_one = None
        for length in lengths:
            shape = np.hanning(length + 2)[1:-1]
            shape = shape / np.linalg.norm(shape)
            match = np.abs(np.convolve(rest[:rows], shape[::-1], mode="same"))
            middle = int(np.argmax(match))
            if best_one is None or match[middle] > best_one[0]:
                best_one = (match[middle], middle, length)
        if best_one is None:
            break
        _, middle, length = best_one
        first = middle - (length - 1) // 2
        begin, end = max(first, 0), min(first + length, rows)
        push = np.zeros(rows)
        push[begin:end] = np.hanning(length + 2)[1:-1][begin - first : end - first]
        found += absorber.columns(push / absorber.weight)
        rest = without(space([*others, *found]), gap.apart)
    return found


def best(absorber, gap, forms, others=()):
    """(what remains, columns) of the form that leaves least, fitted with others."""
    if not forms:
        return np.inf, []
    others = list(others)
    q = space(others)
    target = without(q, gap.apart)
    costs = []
    for columns in forms:
        matrix = without(q, np.array([c.apart for c in columns]).T)
        size = np.linalg.norm(matrix, axis=0)
        matrix = matrix[:, size > 1e-7]
        cost = target @ target
        if matrix.shape[1]:
            u = np.linalg.qr(matrix / np.linalg.norm(matrix, axis=0))[0]
            cost -= np.sum((u.T @ target) ** 2)
        costs.append(cost)
    nearest = np.argsort(costs)[:2]
    left = [absorber.left(gap, list(forms[i]) + others) for i in nearest]
    k = int(np.argmin(left))
    return left[k], list(forms[nearest[k]])


def fit(absorber, gap, forms, causes, pushes=8):
    """(what remains, columns of each cause) once causes are fitted together, in turn."""
    chosen, left = {}, None
    for _ in range(3 if len(causes) > 1 else 1):
        for cause in causes:
            others = [c for k in causes if k != cause for c in chosen.get(k, [])]
            if cause == "contact":
                columns = bursts(absorber, gap, others, pushes)
                remains = absorber.left(gap, columns + others)
            else:
                remains, columns = best(absorber, gap, forms.get(cause, []), others)
                if not columns:
                    continue
            chosen[cause] = columns
            left = remains
    chosen = {c: chosen.get(c, []) for c in causes}
    return (absorber.left(gap) if left is None else left), chosen
