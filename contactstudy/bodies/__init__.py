"""Elastic bodies: material, ends, a second body in its place, and the Hertz line contact."""

from typing import TYPE_CHECKING

from contactstudy.bodies import materials
from contactstudy.bodies.counterbody import Counterbody
from contactstudy.bodies.material import Material
from contactstudy.bodies.models import Body, FiniteLengthSpace, HalfSpace, QuarterSpace
from contactstudy.near_names import suggesting

__all__ = ["Body", "Counterbody", "FiniteLengthSpace", "HalfSpace", "Material", "QuarterSpace", "materials"]

if not TYPE_CHECKING:  # to a type checker, a module with __getattr__ has every name
    __getattr__ = suggesting(__name__, __all__)
