"""Plain textbook forms of every cause, each a list of shapes that are fitted together. For fairness only."""
import numpy as np

from joints import PARAMETERS
from plant import branches, winch_torque

SPEED_QUANTILES = (0.08, 0.15, 0.25, 0.4, 0.6)
TRANSITIONS = (0.004, 0.01, 0.02, 0.035, 0.05, 0.07, 0.1, 0.16, 0.25, 0.35)  # shares of the range
REACHES = (0.001, 0.0025, 0.005, 0.01, 0.018, 0.03, 0.05, 0.09)
WIDTHS = (-0.85, -0.7, -0.5, -0.35, -0.2, -0.1, 0.1, 0.2, 0.35, 0.6, 1.0, 1.5, 2.2, 3.2, 4.5, 6.5)  # relative changes
DELAYS_S = (-0.06, -0.02, 0.01, 0.03, 0.06, 0.12)
RAILS = (0.95, 0.88, 0.8, 0.7, 0.6, 0.5, 0.4)  # shares of the largest torque
CURVES = (
    lambda u: u, lambda u: np.arctan(4 * u) / np.arctan(4), lambda u: np.arctan(10 * u) / np.arctan(10),
    lambda u: np.asarray(u) ** 0.6, lambda u: np.asarray(u) ** 1.6,
)


class Textbook:
    """Shapes of torque in a campaign that the base knows."""

    def __init__(self, world, base, y):
        self.world, self.base, self.y = world, base, y
        self.q, self.v, self.a, self.speed = world.q, world.v, world.a, np.abs(world.v)
        self.low, self.high = self.q.min(), self.q.max()
        self.span = self.high - self.low
        self.one = np.ones(world.size)
        share = world.share(base)
        carried = 1 - base.down["mu_c"] - share * (base.up["mu_c"] - base.down["mu_c"])
        self.gain = base.r1_m / base.r2_m / carried  # reading by torque at the joint
        self.side = (2 * share - 1) / carried  # reading by friction that opposes the motion
        up, down = branches(base, self.speed)
        self.friction = (down + share * (up - down)) / carried
        self.progress = world.wall / max(world.wall[-1], 1e-9)

    def turns(self):
        """What acts where the motion turns."""
        world, base, y = self.world, self.base, self.y
        x, span = self.q * base.r2_m, self.span * base.r2_m
        with_share = lambda share: [winch_torque(world, base, share=share) - y]
        yield "reversal_transition", [with_share(world.passage(x, w * span, g)) for w in TRANSITIONS for g in CURVES]
        yield "presliding", [with_share(world.dahl(x, w * span)) for w in REACHES]
        if base.combination["kind"] != "sign":
            wider = lambda change: winch_torque(world, base.scaled({"joint.backlash_m": change})) - y
            yield "backlash_width", [[wider(change)] for change in WIDTHS]

    def frictions(self):
        """What friction does by speed, load, place and time."""
        speed, y = self.speed, self.y
        typical = np.quantile(speed[speed > 1e-3 * speed.max()], SPEED_QUANTILES)
        falls = [np.exp(-((speed / s) ** power)) for power in (1, 2) for s in typical]
        yield "stribeck", [[self.side * f] for f in falls]
        external = self.world.load if self.world.load is not None else 0
        load = self.base.gravity_nm * np.sin(self.q) + self.base.inertia_kg_m2 * self.a + external
        if np.ptp(load) > 0:
            carried = (np.abs(load), np.abs(y), np.maximum(load, 0), np.maximum(-load, 0))
            yield "load_dependent_friction", [[self.side * c] for c in carried]
        yield "friction_ripple", [self.waves(k, self.side) for k in self.wave_numbers()]
        yield "quadratic_viscous", [[self.side * speed**2]]
        warming = []
        for tau in (0.05, 0.12, 0.25, 0.5, 1.0):
            cold = np.exp(-self.progress / tau)
            warming += [[self.friction * cold], [self.side * speed * cold], [self.side * cold]]
        yield "warm_up", warming

    def wave_numbers(self):
        numbers = list(2 * np.pi / self.span * np.geomspace(1.0, 13, 30))
        drum = self.base.r2_m / self.base.r1_m
        if not self.world.prismatic and drum * self.span > 5:
            numbers.append(drum)
        return numbers

    def waves(self, k, size):
        return [size * np.cos(k * self.q), size * np.sin(k * self.q)]

    def loads(self):
        """What acts at the joint, and the cable's stretch."""
        q, y, gain, gravity = self.q, self.y, self.gain, self.base.gravity_nm
        if gravity != 0:
            tensions = (y, np.sign(y) * np.abs(y) ** 0.65, np.tanh(5 * y / np.abs(y).max()), y * np.abs(y))
            yield "cable_elasticity", [[gravity * gain * np.cos(q) * t] for t in tensions]
            if not self.world.prismatic:
                yield "gravity_phase", [[gain * np.cos(q)]]
        yield "inertia", [[gain * self.a]]
        middle = (self.low + self.high) / 2
        springs = [[gain * (q - rest)] for rest in (middle, self.low, self.high)]
        yield "elastic_spring", springs + [[gain * (q - middle), gain * (q - middle) ** 3]]
        stops = []
        for depth in (0.03, 0.06, 0.1, 0.15, 0.22):
            for power in (1, 2):
                for side, edge in ((1, self.high), (-1, self.low)):
                    stops.append([gain * np.maximum(side * (q - edge) + depth * self.span, 0) ** power])
        yield "end_stop", stops
        if self.world.other_q is not None and np.ptp(self.world.other_q) > 0:
            yield "joint_coupling", self.couplings()

    def couplings(self):
        """What a second joint may do."""
        q, v, a = self.world.other_q, self.world.other_v, self.world.other_a
        still = 0.1 * np.abs(v).max() + 1e-12
        shapes = [q - q.mean(), v, a, np.tanh(v / still), v**2, v * np.abs(v), v**2 * np.sin(q)]
        if not self.world.prismatic:
            shapes.append(np.sin(self.q + q) - np.sin(self.q))
        return [[self.gain * s] for s in shapes]

    def readings(self, drift_with_bias):
        """What the drum and the sensor do."""
        y = self.y
        yield "torque_ripple", [self.waves(k, 1.0) for k in self.wave_numbers()]
        yield "sensor_bias", [[self.one]]
        yield "sensor_gain", [[y]]
        yield "sensor_drift", self.drifts([self.one] if drift_with_bias else [])
        yield "time_delay", [[self.shifted(seconds) - y] for seconds in DELAYS_S]
        top = np.abs(y).max()
        clipped = []
        for share in RAILS:
            clipped.append([np.clip(y, -share * top, share * top) - y])
            if y.max() > 0:
                clipped.append([np.minimum(y, share * y.max()) - y])
            if y.min() < 0:
                clipped.append([np.maximum(y, share * y.min()) - y])
        yield "saturation", clipped

    def drifts(self, bias):
        """Zeros that walk: by time, by trial, by temperature."""
        w, trial, temperature = self.progress, self.world.trial, self.world.temperature
        settling = [np.exp(-w / tau) for tau in (0.08, 0.2, 0.5)]
        forms = [[w - w.mean()]] + [[s - s.mean()] for s in settling] + [[w]] + [[1 - s] for s in settling]
        forms = [form + bias for form in forms]
        knots = np.linspace(0, 1, 8)
        hats = [np.interp(w, knots, row) for row in np.eye(8)]
        forms.append([h - h.mean() for h in hats][:7] + bias)
        count = int(trial.max()) + 1
        if count >= 3:
            forms.append([(trial == i) - np.mean(trial == i) for i in range(count - 1)] + bias)
        if temperature is not None and np.ptp(temperature) > 1:
            forms.append([temperature - temperature.mean()] + bias)
        return forms

    def shifted(self, seconds):
        """The torque, later."""
        out = np.empty(self.world.size)
        for s in self.world.slices:
            t = np.arange(s.stop - s.start) / self.world.rate_hz
            out[s] = np.interp(t - seconds, t, self.y[s])
        return out


def slow_waves(absorber, span):
    """Columns of ripples with less than one period in the range, by id."""
    book = Textbook(absorber.world, absorber.base, absorber.y)
    numbers = 2 * np.pi / span * np.array([0.5, 0.7, 0.85])
    sides = {"friction_ripple": 2 * absorber.world.share(absorber.base) - 1, "torque_ripple": 1.0}
    columns = lambda k, size: absorber.columns(absorber.low(np.array(book.waves(k, size))))
    return {name: [columns(k, size) for k in numbers] for name, size in sides.items()}


def parameter_forms(absorber):
    """Columns of the base's parameters that may be stale, by id."""
    column = lambda name: absorber.base_columns[:, absorber.names.index(name)]
    both = lambda key: [n for n in (f"friction.up.{key}", f"friction.down.{key}") if n in absorber.names]
    forms = {}
    for cause in ("gravity", "coulomb", "viscous", "load_coefficient"):
        key = PARAMETERS[cause][0]
        names = ([key] if key in absorber.names else []) if "." in key else both(key)
        if names:
            forms[cause] = [names]
    levels = [names for names in map(both, PARAMETERS["stribeck_level"]) if names]
    if levels:
        forms["stribeck_level"] = levels + ([levels[0] + levels[1]] if len(levels) == 2 else [])
    return {c: [absorber.columns(np.array([column(n) for n in names])) for names in f] for c, f in forms.items()}


def textbook(absorber, drift_with_bias):
    """id -> forms, each a list of columns; a contact has none here, its pushes are looked for."""
    book = Textbook(absorber.world, absorber.base, absorber.y)
    forms = {}
    for family in (book.turns(), book.frictions(), book.loads(), book.readings(drift_with_bias)):
        forms |= dict(family)
    size = absorber.world.size
    shapes = [np.broadcast_to(np.asarray(s, float), size) for f in forms.values() for one in f for s in one]
    columns = iter(absorber.columns(absorber.low(np.array(shapes))))
    known = {name: [[next(columns) for _ in one] for one in f] for name, f in forms.items()}
    return known | parameter_forms(absorber)
