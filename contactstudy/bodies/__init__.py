"""Elastic bodies: material, ends, a second body in its place, and the Hertz line contact."""

from contactstudy.bodies import materials
from contactstudy.bodies.counterbody import Counterbody
from contactstudy.bodies.material import Material
from contactstudy.bodies.models import Body, FiniteLengthSpace, HalfSpace, QuarterSpace
from contactstudy.near_names import suggest

__all__ = ["Body", "Counterbody", "FiniteLengthSpace", "HalfSpace", "Material", "QuarterSpace", "materials"]

suggest(__name__, __all__)
