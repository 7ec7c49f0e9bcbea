"""Elastic bodies: material, ends, a second body in its place, and the Hertz line contact."""

from contactstudy.bodies import materials
from contactstudy.bodies.lubricant import Lubricant
from contactstudy.bodies.material import Material
from contactstudy.bodies.models import Body, Counterbody, FiniteLengthSpace, HalfSpace, QuarterSpace

__all__ = [
    "Body",
    "Counterbody",
    "FiniteLengthSpace",
    "HalfSpace",
    "Lubricant",
    "Material",
    "QuarterSpace",
    "materials",
]
