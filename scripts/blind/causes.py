"""What a plant may have that its model lacks: one form of an effect, parameters that have moved, or a thing that no effect names."""
import dataclasses

import numpy as np

from campaign import log_uniform
from forms import FORMS, Form
from measure import record_all
from plant import DIRECTIONS
from unknowns import UNKNOWNS

STALE = ("gravity", "coulomb", "viscous", "backlash_width", "load_coefficient", "stribeck_level", "inertia")
TIES = ("bias", "coulomb_common", "gain", "load_common", "phase_small_range", "spring_small_range")

WANTS = {  # of joint and campaign, by id or id/variant
    "reversal_transition": {"curves": ("sign", "linear")},
    "presliding": {"curves": ("sign",)},
    "stribeck": {"no_stribeck": True},
    "load_dependent_friction": {"no_load_term": True},
    "load_dependent_friction/tension": {"both_sides": True},
    "quadratic_viscous": {"fast": True},
    "time_delay": {"fast": True},
    "inertia": {"fast": True, "no_inertia": True},
    "warm_up": {"long": True, "running_clock": True},
    "sensor_drift": {"long": True, "running_clock": True},
    "sensor_drift/each_trial": {"long": True, "zero_clock": True},
    "sensor_drift/by_order": {"long": True, "zero_clock": True},
    "joint_coupling": {"other": True},
    "joint_coupling/inertial": {"other": True, "other_fast": True},
    "stale backlash_width": {"curves": ("linear", "arctan")},
    "stale inertia": {"fast": True, "inertia": True},
    "stale viscous": {"fast": True},
    "stale load_coefficient": {"load_term": True},
    "stale stribeck_level": {"stribeck": True},
    "unknown/centrifugal": {"fast": True},
    "unknown/drag_by_position": {"fast": True},
    "unknown/braking_differs": {"fast": True},
    "unknown/friction_lags_speed": {"fast": True},
    "unknown/dead_zone": {"both_sides": True},
    "unknown/stiction_by_rest": {"dwells": True, "curves": ("linear", "arctan")},
    "tie/bias": {"equal_mu": True},
    "tie/coulomb_common": {"equal_mu": True},
    "tie/gain": {"equal_mu": True, "load_term": True},
    "tie/load_common": {"equal_mu": True, "load_term": True},
    "tie/phase_small_range": {"narrow": True},
    "tie/spring_small_range": {"narrow": True},
}
APART = (  # no two of one line in a pair: they act on the same thing
    {"reversal_transition", "presliding", "backlash_width"}, {"sensor_bias", "coulomb"}, {"sensor_gain", "load_coefficient", "gravity"},
    {"gravity_phase", "elastic_spring", "gravity"}, {"stribeck", "stribeck_level"}, {"load_dependent_friction", "load_coefficient"},
    {"sensor_bias", "elastic_spring"}, {"sensor_bias", "sensor_drift"}, {"sensor_bias", "joint_coupling"}, {"contact", "saturation"},
    {"warm_up", "sensor_drift"}, {"viscous", "quadratic_viscous"},
)


class Rejected(Exception):
    """This draw cannot show what it should; draw again."""


@dataclasses.dataclass
class Cause:
    """One cause: a form, or relative changes of the plant's parameters. `sized`: its size is to be solved for."""

    name: str
    variant: str
    form: Form = None
    changes: dict = None
    strength: float = 0.0

    @property
    def sized(self):
        return self.form is not None and self.form.sized

    def on(self, joint):
        """The plant's joint and the forms on it."""
        if self.form is None:
            values = joint.values()
            return joint.altered({n: values[n] * (1 + c) for n, c in self.changes.items()}), []
        return joint, [(self.form.hook, self.form.act, self.strength)]


def wants_of(kind, names, variants):
    """The needs of all causes together."""
    wants = {}
    for name, variant in zip(names, variants):
        key = f"stale {name}" if variant is None else name
        if kind == "tie":
            key = f"tie/{variant}"
        new = WANTS.get(f"{name}/{variant}", WANTS.get(key, {}))
        if "curves" in wants and "curves" in new:
            new = {**new, "curves": tuple(c for c in new["curves"] if c in wants["curves"])}
        wants.update(new)
    if "running_clock" in wants and "zero_clock" in wants:
        raise Rejected("two clocks")
    return wants


def may_pair(one, other):
    return one != other and not any(one in line and other in line for line in APART)


def stale_changes(rng, name):
    """What has moved, and by how much: 10 to 60 %. Returns a variant's name and the changes."""
    factor = float(log_uniform(rng, 0.1, 0.6) * rng.choice([-1, 1]))
    both = lambda *keys: {f"friction.{d}.{k}": factor for d in DIRECTIONS for k in keys}
    if name == "coulomb" and rng.random() < 0.5:
        direction = str(rng.choice(DIRECTIONS))
        return direction, {f"friction.{direction}.a_j": factor}
    return "all", {
        "gravity": {"dynamics.gravity_nm": factor}, "inertia": {"dynamics.inertia_kg_m2": factor}, "backlash_width": {"joint.backlash_m": factor},
        "viscous": both("d"), "load_coefficient": both("mu_c"), "stribeck_level": both("b_c", "b_j"), "coulomb": both("a_j"),
    }[name]


def tie(rng, variant, context):
    """A cause that a second one equals, and the names of both."""
    if variant == "bias":
        return Cause("sensor_bias", variant, FORMS["sensor_bias"]["constant"](rng, context)), "coulomb"
    if variant == "gain":
        return Cause("sensor_gain", variant, FORMS["sensor_gain"]["factor"](rng, context)), "load_coefficient"
    if variant == "phase_small_range":
        return Cause("gravity_phase", variant, FORMS["gravity_phase"]["at_joint"](rng, context)), "elastic_spring"
    if variant == "spring_small_range":
        return Cause("elastic_spring", variant, Form("load", lambda st: st.q - np.pi / 2, 4 * context.joint.gravity_nm)), "gravity_phase"
    factor = float(log_uniform(rng, 0.1, 0.6) * rng.choice([-1, 1]))
    if variant == "load_common":
        return Cause("load_coefficient", variant, changes={f"friction.{d}.mu_c": factor for d in DIRECTIONS}), "sensor_gain"
    up, down = (context.joint.friction[d]["a_j"] for d in DIRECTIONS)
    step = factor * min(abs(up), abs(down))
    return Cause("coulomb", variant, changes={"friction.up.a_j": step / up, "friction.down.a_j": step / down}), "sensor_bias"


def make_cause(rng, kind, name, variant, context):
    """The cause, and the name of the one that it ties with, if it is made to."""
    if kind == "tie":
        return tie(rng, variant, context)
    if variant is None:
        variant, changes = stale_changes(rng, name)
        return Cause(name, variant, changes=changes), None
    makers = UNKNOWNS if name == "unknown" else FORMS[name]
    return Cause(name, variant, makers[variant](rng, context)), None


def torques_with(causes, joint, trials, noise=None):
    """The recorded torque of every trial with these causes in the plant."""
    forms = []
    for cause in causes:
        joint, more = cause.on(joint)
        forms += more
    return record_all(joint, trials, forms, noise)
