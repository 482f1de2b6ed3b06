"""Ways through a reversal: K~ that passes, or elements that bend before they slide."""
import numpy as np

from forms.base import Form, form
from plant import share_by_sign, share_over_clearance


def from_curve(g):
    act = lambda st, s: share_over_clearance(st.joint.r2_m * st.q, st.joint.backlash_m, g)
    return Form("share", act, 1, False, False)


@form("reversal_transition", "smoothstep")
def _(rng, c):
    return from_curve(lambda u: u * u * (3 - 2 * u))


@form("reversal_transition", "power")
def _(rng, c):
    n = rng.choice([rng.uniform(0.3, 0.6), rng.uniform(1.6, 2.5)]) if c.joint.curve[0] == "linear" else rng.uniform(0.4, 1.5)
    return from_curve(lambda u: u**n)


@form("reversal_transition", "arctan")
def _(rng, c):
    p = rng.uniform(1.2, 3.5)
    return from_curve(lambda u: np.arctan(2 * p * u) / np.arctan(2 * p))


def bristle(x, rate_of):
    """K~ of an elastic element: z from -1 to 1, dz = dx rate(z sense), started slid."""
    senses = 2 * share_by_sign(x) - 1
    steps = np.abs(np.diff(x, prepend=x[0]))
    z, out = senses[0], np.empty(len(x))
    for i, (step, sense) in enumerate(zip(steps.tolist(), senses.tolist())):
        z += sense * step * rate_of(z * sense)
        z = min(1.0, max(-1.0, z))
        out[i] = z
    return (out + 1) / 2


@form("presliding", "dahl")
def _(rng, c):
    slip_rad = c.width_rad * np.exp(rng.uniform(np.log(0.003), np.log(0.03)))
    return Form("share", lambda st, s: bristle(st.q, lambda z: (1 - z) / slip_rad), 1, False, False)


@form("presliding", "dahl_exponent")
def _(rng, c):
    slip_rad, power = c.width_rad * np.exp(rng.uniform(np.log(0.004), np.log(0.03))), rng.uniform(1.4, 2.2)
    return Form("share", lambda st, s: bristle(st.q, lambda z: ((1 - z) / 2) ** power * 2 / slip_rad), 1, False, False)


@form("presliding", "lugre")
def _(rng, c):
    """Bristles that bend less far the faster they are swept."""
    slip_rad, speed = c.width_rad * np.exp(rng.uniform(np.log(0.004), np.log(0.03))), c.top_speed_rad_s * rng.uniform(0.2, 1.0)

    def act(st, s):
        local = np.cumsum(np.abs(np.diff(st.q, prepend=st.q[0])) * (1 + np.abs(st.v) / speed)) / slip_rad
        signed = np.cumsum(np.diff(local, prepend=0.0) * np.sign(np.diff(st.q, prepend=st.q[0])))
        return bristle(signed, lambda z: 1 - z)

    return Form("share", act, 1, False, False)


@form("presliding", "iwan")
def _(rng, c):
    """Five elastic elements in parallel, each slipping at its own displacement."""
    slips = c.width_rad * np.exp(rng.uniform(np.log(0.002), np.log(0.04), 5))
    weights = rng.dirichlet(np.full(5, 2.0))

    def act(st, s):
        return sum(w * share_over_clearance(st.q, 2 * d, lambda u: u) for w, d in zip(weights, slips))

    return Form("share", act, 1, False, False)
