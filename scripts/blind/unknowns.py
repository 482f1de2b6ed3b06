"""Gaps from outside the library: things that joints do and that no effect id names.

UNKNOWNS: variant -> maker of a `Form`, as in `forms`.
"""
import numpy as np
from scipy.signal import lfilter

from forms.base import Form
from plant import strokes

UNKNOWNS = {}


def unknown(variant):
    def keep(maker):
        UNKNOWNS[variant] = maker
        return maker

    return keep


def lagging(x, rate_hz, settle_s):
    """x through a first-order lag that starts settled."""
    keep = np.exp(-1 / (rate_hz * settle_s))
    return lfilter([1 - keep], [1, -keep], x, zi=[keep * x[0]])[0]


def reversals(st):
    """Start of each stroke, its direction, and where the one before began."""
    starts, senses = strokes(st.joint.r2_m * st.q)
    return starts, senses, np.concatenate((starts[1:], [len(st.q)]))


@unknown("drag_by_position")
def _(rng, c):
    """A torque as position times speed: drag where the joint is bent, push where it is straight."""
    middle = rng.uniform(c.low_rad + 0.3 * c.width_rad, c.high_rad - 0.3 * c.width_rad)
    return Form("winch", lambda st: st.v / c.top_speed_rad_s * (st.q - middle) / c.width_rad, 3 * c.torque_span_nm)


@unknown("centrifugal")
def _(rng, c):
    """An unmodelled link's velocity torque: even in speed."""
    turn, phase = rng.uniform(1, 3), rng.uniform(0, 2 * np.pi)
    return Form("load", lambda st: (st.v / c.top_speed_rad_s) ** 2 * np.sin(turn * st.q + phase), 3 * c.joint.gravity_nm)


@unknown("relaxing_sheath")
def _(rng, c):
    """A spring in series with a damper: resists a move, then forgets it within seconds."""
    settle_s = rng.uniform(0.6, 5.0)
    return Form("winch", lambda st: (st.q - lagging(st.q, st.trial.rate_hz, settle_s)) / c.width_rad, 3 * c.torque_span_nm)


@unknown("ringing")
def _(rng, c):
    """A second mode, struck by each reversal and dying away."""
    hz, settle_s = rng.uniform(1.2, 2.6), rng.uniform(0.4, 1.2)

    def act(st):
        out = np.zeros(len(st.q))
        for start, sense, stop in zip(*reversals(st)):
            if start > 0:
                t = np.arange(len(st.q) - start) / st.trial.rate_hz
                out[start:] += sense * np.exp(-t / settle_s) * np.sin(2 * np.pi * hz * t)
        return out

    return Form("winch", act, c.torque_span_nm)


@unknown("clockwork")
def _(rng, c):
    """A disturbance periodic in time, in step with the start of every trial."""
    hz, phase, second = rng.uniform(0.25, 1.0), rng.uniform(0, 2 * np.pi), rng.uniform(0, 0.5)

    def act(st):
        turn = 2 * np.pi * hz * st.trial.t_s + phase
        return np.sin(turn) + second * np.sin(2 * turn)

    return Form("winch", act, c.torque_span_nm)


@unknown("braking_differs")
def _(rng, c):
    """Friction that is greater speeding up than slowing down."""
    soft = 0.15 * c.top_speed_rad_s * max(np.sqrt(np.mean(t.a**2)) for t in c.trials)
    return Form("winch", lambda st: st.sense * np.tanh(st.v * st.a / soft), c.torque_span_nm)


@unknown("remembered_extreme")
def _(rng, c):
    """A torque set by where the joint last turned round, until it turns again."""
    middle = (c.low_rad + c.high_rad) / 2
    back = rng.uniform(0.3, 1.0)

    def act(st):
        starts, senses, stops = reversals(st)
        held = np.zeros(len(st.q))
        for start, sense, stop in zip(starts, senses, stops):
            held[start:stop] = (st.q[start] - middle) / c.width_rad * (1.0 if sense > 0 else back)
        return lagging(held * np.sin(3 * held + 1), st.trial.rate_hz, 0.15)

    return Form("winch", act, c.torque_span_nm)


@unknown("dead_zone")
def _(rng, c):
    """A transmission that passes nothing until the torque leaves a zone about zero; noise comes after it."""
    shifted = rng.random() < 0.5

    def act(st, s):
        return np.sign(st.y) * np.maximum(0, np.abs(st.y) - s) if shifted else np.where(np.abs(st.y) < s, 0.0, st.y)

    return Form("strain", act, 0.3 * c.torque_span_nm, False)


@unknown("steps_by_direction")
def _(rng, c):
    """Coils that settle: torque in uneven steps over position, the steps elsewhere on the way back."""
    edges = [np.sort(rng.uniform(c.low_rad, c.high_rad, rng.integers(3, 7))) for _ in range(2)]
    levels = [rng.uniform(-1, 1, len(e) + 1) for e in edges]

    def act(st):
        up, down = (level[np.searchsorted(edge, st.q)] for edge, level in zip(edges, levels))
        return lagging(np.where(st.sense > 0, up, down), st.trial.rate_hz, 0.05)

    return Form("winch", act, c.torque_span_nm)


@unknown("stiction_by_rest")
def _(rng, c):
    """A break-away peak that has grown with the rest before it."""
    grow_s, travel_rad = rng.uniform(0.5, 2.0), c.width_rad * rng.uniform(0.02, 0.08)

    def act(st):
        slow = np.abs(st.v) < 0.02 * c.top_speed_rad_s
        edges = np.flatnonzero(np.diff(np.concatenate(([0], slow.astype(int), [0]))))
        out = np.zeros(len(st.q))
        for first, last in zip(edges[::2], edges[1::2]):
            rest_s = (last - first) / st.trial.rate_hz
            if last < len(out):
                gone = np.abs(st.q[last:] - st.q[last - 1])
                out[last:] = np.sign(st.v[last]) * -np.expm1(-rest_s / grow_s) * np.exp(-gone / travel_rad)
        return out

    return Form("winch", act, 2 * c.torque_span_nm)


@unknown("wrap_by_stroke")
def _(rng, c):
    """A cable that winds on in another layer every second stroke."""
    def act(st):
        odd = np.zeros(len(st.q))
        for k, (start, sense, stop) in enumerate(zip(*reversals(st))):
            odd[start:stop] = (k // 2) % 2
        return lagging(odd, st.trial.rate_hz, 0.1) * (0.5 + (st.q - c.low_rad) / c.width_rad)

    return Form("winch", act, c.torque_span_nm)


@unknown("friction_lags_speed")
def _(rng, c):
    """Friction film that follows the speed only after a second or so."""
    settle_s = rng.uniform(0.5, 2.0)

    def act(st):
        speed = np.abs(st.v) / c.top_speed_rad_s
        return st.sense * (lagging(speed, st.trial.rate_hz, settle_s) - speed)

    return Form("winch", act, 3 * c.torque_span_nm)


@unknown("wandering")
def _(rng, c):
    """A torque that wanders within seconds, otherwise in every trial."""
    settle_s = rng.uniform(0.3, 2.0)
    walks = {}
    for t in c.trials:
        before = int(5 * settle_s * t.rate_hz)
        walk = lagging(rng.normal(size=before + len(t.q)), t.rate_hz, settle_s)[before:]
        walks[t.name] = walk / walk.std()
    return Form("winch", lambda st: walks[st.trial.name], c.torque_span_nm)
