"""Puts a case together: a joint, its motions, what is wrong with it at the strength asked for, the model handed over, the answer."""
import dataclasses
import itertools

import numpy as np
from scipy.optimize import lsq_linear

from effect import log_uniform
from frictions import FRICTIONS
from identified import identify
from joints import NOISES, STALE, draw_base, draw_span, jacobian, known, may_be, noise, stale
from loads import LOADS
from motions import record, smooth
from outside import outside
from plant import World, torque
from readings import READINGS
from rivals import Absorber, leaves

EFFECTS = FRICTIONS | LOADS | READINGS
STRENGTHS = {"effect": (0.3, 12.0), "stale": (0.5, 12.0), "unknown": (0.7, 12.0), "pair": (1.0, 10.0), "triple": (1.2, 10.0)}  # floors, net
DRAWS = 20  # of an option
IDENTIFIED = 0.3  # of the models: identified by tautline, where the program is given
OFF = 1.5  # floors: the most that such a model misses the joint as it was
DEFAULT = 0.05  # within which a base parameter moves that declares no confidence
CLOSE = 0.25  # floors: a rival that leaves no more than this beyond the true cause's textbook form cannot be told from it
NOISE_OVER_ROUNDING = 0.5  # at least: what the encoder's steps leave of a perfect model must not stand alone
UNKNOWN_LEFT = 0.6  # of a gap from outside the library: the least that any one cause leaves
OWN_LEFT = 0.7  # of a gap: the most that a textbook form of its own cause leaves
SEVERAL_LEFT = 0.7  # floors: the least that any one cause leaves of a pair or three
SAME_THING = {"load_dependent_friction": "load_coefficient", "load_coefficient": "load_dependent_friction", "stribeck_level": "stribeck"}
HOLDS_CONSTANT = {"sensor_bias": {"elastic_spring", "sensor_drift", "joint_coupling"}}


class Rejected(Exception):
    """A draw that is no fair question."""


@dataclasses.dataclass
class Case:
    world: World
    style: str
    base: object  # the model handed over
    confidence: dict | None  # name to (low, high)
    recorded: np.ndarray
    encoder: float
    clocked: bool
    answer: dict
    written: dict | None = None  # the model file, where tautline identified it


def build(kind, options, rng, binary=None):
    """A case; each option is a list of causes, (family, id) with family effect, stale or outside.

    Draws again what is no fair question: an option `DRAWS` times at most, several causes from all options in turn.
    """
    for attempt in range(DRAWS * len(options)):
        option = options[attempt % len(options) if kind in ("pair", "triple") else attempt // DRAWS]
        try:
            return draw(kind, option, rng, attempt, binary)
        except (Rejected, np.linalg.LinAlgError):
            continue
    raise RuntimeError(f"no fair question in {DRAWS} draws of each of {options}")


def make(family, name, world, base, rng, size):
    if family == "stale":
        return stale(name, base, rng)
    if family == "outside":
        return outside(name, world, base, rng, size)
    return EFFECTS[name](world, base, rng, size)


@dataclasses.dataclass
class Setting:
    """A joint, its campaign, its sensors: all but what is wrong."""

    joint: str
    span: object
    base: object
    style: str
    repeats: int
    world: World
    y0: np.ndarray  # torque without any effect
    size: float  # a tenth of its range: the unit of amounts
    encoder: float
    rounding: float  # what the encoder's steps leave of a perfect model
    noise: float
    floor: float


def setting(names, rng):
    joint = "prismatic" if rng.random() < 0.2 else "revolute"
    if not all(may_be(n, joint) for _, n in names):
        joint = "revolute"
    span = draw_span(rng, joint)
    base = draw_base(rng, joint, span, [f"{n}_effect" if (f, n) == ("effect", "inertia") else n for f, n in names])
    style, rate, repeats, trials = record(span, rng)
    lowpass = round(min(log_uniform(rng, 4, 25), rate / 6), 1)
    if any(n == "joint_coupling" for _, n in names) or rng.random() < 0.12:
        give_other(trials, rng)
    world = World(trials, rate, lowpass, int(rng.choice([2, 4, 4])))
    if world.kept.sum() < 150:
        raise Rejected("too short")
    y0 = torque(world, base)
    size = 0.1 * np.ptp(world.judged(y0))
    if not np.isfinite(size) or size <= 0:
        raise Rejected("no torque")
    least = size * 10 * log_uniform(rng, 1e-3, 0.03)
    encoder = 2 * span.half / log_uniform(rng, 300, 100_000)
    rounding = rms(world.judged(torque(world.as_read(encoder), base) - y0))
    noise_rms = max(least, NOISE_OVER_ROUNDING * rounding)
    return Setting(joint, span, base, style, repeats, world, y0, size, encoder, rounding, noise_rms, float(np.hypot(noise_rms, rounding)))


@dataclasses.dataclass
class Handed:
    """The model handed over: by how much each parameter may move, what it misses of the joint as it was."""

    model: object
    bounds: np.ndarray
    off: np.ndarray
    confidence: dict | None = None
    written: dict | None = None


def identified_model(s, parameters, noises, clocked, rng, binary):
    """What tautline makes of a second campaign."""
    reference = Case(s.world, s.style, s.base, None, s.y0 + s.noise * noise(s.world, rng, noises), s.encoder, clocked, {"floor_nm": s.floor})
    found = identify(binary, reference, np.random.default_rng(rng.integers(2**31)))
    if found is None:
        raise Rejected("not identified")
    model, written, widths = found
    off = s.world.judged(torque(s.world, model) - s.y0)
    if rms(off) > OFF * s.floor:
        raise Rejected("identification missed")
    return Handed(model, np.array([widths.get(n, DEFAULT) for n in parameters]), off, written=written)


def drawn_model(s, parameters, columns, declared, rng):
    """The joint as it was, moved by what an identification would not have known."""
    sd, moved = known(s.world, parameters, columns, s.floor, rng)
    if not declared:
        moved = np.clip(moved, -0.02, 0.02)
    moved *= min(1.0, s.floor / max(1e-300, rms(columns @ moved)))  # an identification misses its own campaign by no more
    if any(n.endswith("c_j") and m <= -1 for n, m in zip(parameters, moved)):
        raise Rejected("a rate of the other sign")  # which no model has
    bounds = 1.96 * sd if declared else np.full(len(parameters), DEFAULT)
    values = s.base.values()
    confidence = {n: (values[n] * (1 + m - b), values[n] * (1 + m + b)) for n, m, b in zip(parameters, moved, bounds)}
    model = s.base.changed({n: values[n] * (1 + m) for n, m in zip(parameters, moved)})
    return Handed(model, bounds, columns @ moved, confidence if declared else None)


def draw(kind, names, rng, attempt, binary):
    s = setting(names, rng)
    world, base = s.world, s.base
    causes = [make(family, name, world, base, rng, s.size) for family, name in names]
    parameters, columns = jacobian(world, base)
    declared = rng.random() > 0.15
    clocked = any("clock" in c.needs for c in causes) or rng.random() < 0.4
    noises = str(rng.choice(NOISES, p=[0.35, 0.3, 0.15, 0.2]))
    if rng.random() < IDENTIFIED and binary:
        handed = identified_model(s, parameters, noises, clocked, rng, binary)
    else:
        handed = drawn_model(s, parameters, columns, declared, rng)
    target = [log_uniform(rng, *STRENGTHS[kind]) for _ in causes]
    amounts = [tune(world, base, s.y0, c, columns, handed.bounds, s.floor * x) for c, x in zip(causes, target)]
    reached = [net(world, base, s.y0, c, x, columns, handed.bounds)[0] / s.floor for c, x in zip(causes, amounts)]
    if any(abs(np.log(r / x)) > 0.3 for r, x in zip(reached, target)):
        raise Rejected("strength not reached")
    y = torque(world, base, list(zip(causes, amounts)))
    gap = world.judged(y - s.y0)
    added = s.noise * noise(world, rng, noises)
    recorded = railed(s, causes, amounts, y, added)
    answer = explain(kind, names, causes, amounts, world, base, s.y0, gap, parameters, columns, handed.bounds, s.floor, clocked)
    answer |= {
        "floor_nm": s.floor, "style": s.style, "rate_hz": world.rate_hz, "lowpass_hz": world.lowpass_hz, "repeats": s.repeats,
        "trials": len(world.trials), "samples": len(world.q), "noise": noises, "joint": s.joint, "attempts": attempt + 1,
        "declared_confidence": handed.confidence is not None or handed.written is not None, "base": "identified" if handed.written else "drawn",
        "base_off_over_floor": rms(handed.off) / s.floor, "encoder_steps_in_range": 2 * s.span.half / s.encoder,
        "rounding_over_floor": s.rounding / s.floor, "shrink_true_form": None,
    }
    if kind not in ("none", "unknown") and not {"contact", "saturation"} & {n for _, n in names}:
        own = [world.judged(torque(world, base, [(c, x)]) - s.y0) for c, x in zip(causes, amounts)]
        answer["shrink_true_form"] = shrink(world, gap, columns, handed.bounds, handed.off, world.judged(added), own)
    return Case(world, s.style, handed.model, handed.confidence, recorded, s.encoder, clocked, answer, handed.written)


def railed(s, causes, amounts, y, added):
    """The reading with its noise, which does not cross a rail."""
    if "saturation" not in [c.id for c in causes]:
        return y + added
    inner = torque(s.world, s.base, [(c, x) for c, x in zip(causes, amounts) if c.id != "saturation"])
    return np.where(np.abs(y - inner) > 1e-9 * s.size, y + 0.02 * added, y + added)


def rms(x):
    return float(np.sqrt(np.mean(np.square(x))))


def give_other(trials, rng):
    """A second joint that goes its own way."""
    for t in trials:
        n = len(t.t_s)
        rate = 1 / (t.t_s[1] - t.t_s[0])
        f = rng.uniform(0.08, 0.3, 2) + 1.0 / t.t_s[-1]
        angle = 0.5 * np.sin(2 * np.pi * f[0] * t.t_s + rng.uniform(0, 6)) + 0.3 * np.sin(2 * np.pi * f[1] * t.t_s + rng.uniform(0, 6))
        angle = smooth(angle, min(0.1, 0.1 * n / rate), rate)
        t.other = np.column_stack([angle, np.gradient(angle) * rate])


def net(world, base, y0, cause, amount, columns, bounds):
    """RMS of a cause's torque after and before the base has absorbed what its confidence lets it."""
    gap = world.judged(torque(world, base, [(cause, amount)]) - y0)
    return Absorber(columns, bounds, gap).left(), rms(gap)


def tune(world, base, y0, cause, columns, bounds, wanted):
    """The amount at which a cause's net strength is the one wanted."""
    x, best = min(1.0, 0.5 * cause.most), None
    for _ in range(10):
        got = net(world, base, y0, cause, x, columns, bounds)[0]
        if not np.isfinite(got) or got <= 0:
            raise Rejected("no torque of its own")
        best = x
        ratio = wanted / got
        if abs(np.log(ratio)) < 0.05:
            break
        following = min(cause.most, x * np.clip(ratio, 0.05, 20))
        if following == x:
            break
        x = following
    return best


def explain(kind, names, causes, amounts, world, base, y0, gap, parameters, columns, bounds, floor, clocked):
    """The answer: right verdicts, strengths, and what could not be told from the truth."""
    own = [world.judged(torque(world, base, [(c, x)]) - y0) for c, x in zip(causes, amounts)]
    each = []
    for i, d in enumerate(own):
        others = np.column_stack([o for k, o in enumerate(own) if k != i]) if len(own) > 1 else None
        each.append(Absorber(columns, bounds, d).left(others) / floor)
    whole = Absorber(columns, bounds, gap).left() / floor if causes else 0.0
    answer = {
        "kind": kind, "effects": [n for _, n in names] if kind != "unknown" else [], "variants": [c.variant for c in causes],
        "families": [f for f, _ in names], "raw_over_floor": rms(gap) / floor if causes else 0.0, "net_over_floor": whole,
        "net_of_each_over_floor": each, "amounts": amounts, "notes": [c.notes for c in causes], "indistinguishable": [], "where": [],
    }
    if kind == "none":
        return answer | {"accepted": [{"kind": "none", "effects": []}], "left_by_over_floor": {}}
    left = {n: v / floor for n, v in leaves(world, base, parameters, columns, bounds, gap, clocked).items()}
    answer["left_by_over_floor"] = {n: round(v, 3) for n, v in sorted(left.items(), key=lambda item: item[1])}
    best = min(left.values())
    if kind == "unknown":
        if best < UNKNOWN_LEFT * whole:
            raise Rejected("a cause of the library does for it")
        return answer | {"accepted": [{"kind": "unknown", "effects": []}]}
    if kind in ("pair", "triple"):
        if min(each) < 0.7 * STRENGTHS[kind][0]:
            raise Rejected("one hides the other")
        if best < max(SEVERAL_LEFT, 0.25 * whole):
            raise Rejected("one cause does for all")
        choices = [[n] + ([SAME_THING[n]] if n in SAME_THING else []) for _, n in names]
        kinds = ["several", "stale_parameters"] if all(family == "stale" for family, _ in names) else ["several"]
        return answer | {"accepted": [{"kind": k, "effects": sorted(c)} for k in kinds for c in itertools.product(*choices)]}
    name = names[0][1]
    mine = left.pop(name, 0.0)
    alike = {n: v for n, v in left.items() if n not in HOLDS_CONSTANT.get(name, ())}
    if mine > OWN_LEFT * max(whole, 0.4):
        raise Rejected("so far from every textbook form of its cause that it is another thing")
    if alike and min(alike.values()) < 0.8 * mine and mine > 0.3 and SAME_THING.get(name) != min(alike, key=alike.get):
        raise Rejected("another cause explains it better")
    answer["indistinguishable"] = sorted(n for n, v in alike.items() if v**2 - mine**2 < CLOSE**2)
    family = names[0][0]
    accepted = [{"kind": "stale_parameters" if family == "stale" else "effect", "effects": [name]}]
    twin = SAME_THING.get(name)
    if twin in answer["indistinguishable"]:
        accepted.append({"kind": "stale_parameters" if twin in STALE else "effect", "effects": [twin]})
    if family == "stale" and name == "inertia":
        accepted.append({"kind": "effect", "effects": [name]})
    return answer | {"accepted": accepted}


def shrink(world, gap, columns, bounds, off, added, own):
    """What the true form reaches: fitted with the base to three quarters of the trials (of the time, of a single one), judged on the rest."""
    truth = gap - off
    number = world.number[world.kept]
    fold = number % 4 if number.max() >= 3 else (4 * np.arange(len(number)) // len(number))
    after = np.zeros(len(gap))
    design = np.column_stack([columns, *own])
    scale = np.sqrt(np.mean(design**2, axis=0)) + 1e-300
    limits = np.concatenate([2 * bounds, np.full(len(own), np.inf)]) * scale
    for k in range(4):
        seen = fold != k
        x = lsq_linear(design[seen] / scale, (truth + added)[seen], (-limits, limits), method="trf" if design.shape[1] > 40 else "bvls").x
        after[~seen] = truth[~seen] - design[~seen] / scale @ x
    return float(1 - rms(after) / rms(truth))
