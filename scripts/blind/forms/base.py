"""What every form is made of."""
import dataclasses
from collections.abc import Callable

FORMS = {}


@dataclasses.dataclass
class Setting:
    """What a form may be drawn to fit: the joint, its campaign and the torques in it."""

    joint: object
    trials: list
    low_rad: float
    high_rad: float
    top_speed_rad_s: float
    length_s: float  # of the whole campaign on its clock, pauses included
    torque_low_nm: float
    torque_high_nm: float

    @property
    def torque_span_nm(self):
        return self.torque_high_nm - self.torque_low_nm

    @property
    def width_rad(self):
        return self.high_rad - self.low_rad

    @property
    def ratio(self):
        return self.joint.r1_m / self.joint.r2_m


@dataclasses.dataclass
class Form:
    hook: str
    act: Callable
    largest: float  # physical limit of the strength
    linear: bool = True
    sized: bool = True  # False: its size is drawn, the floor is chosen to fit the strength wanted
    warm: Callable = None  # of what depends on warmth: 1 cold, 0 warm; a thermometer may show it


def form(effect, variant):
    def keep(maker):
        FORMS.setdefault(effect, {})[variant] = maker
        return maker

    return keep
