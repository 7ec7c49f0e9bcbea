"""Elastic bodies: material, free ends, counterbody, the Hertz line contact; and lubricants."""

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
