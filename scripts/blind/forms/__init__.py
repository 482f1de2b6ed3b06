"""The effects of the library's list, each in forms of our own.

FORMS: effect id -> {variant: maker}. A maker draws its shape from `rng` and the case's `Setting` and returns a `Form`.
Linear forms give a shape of order 1 that is scaled by the strength (N m); the others take the strength themselves.
"""
from forms import friction, load, reversal, sensor, touch  # noqa: F401 (each adds its forms)
from forms.base import FORMS, Form, Setting  # noqa: F401
