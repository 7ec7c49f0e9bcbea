"""Roller profiles: drop of a roller's generatrix below the cylinder (docs/reference/profiles.md).

A profile has one method ``drop(x, length)``: the material removed, in metres and not negative, at the distance `x` from
mid-length of a roller of the given `length`, fillets included. ``first + second`` is their sum.
"""

from contactstudy.profiles.base import EffectiveLength, Halves, Profile, Shape, Sum, local_radius
from contactstudy.profiles.geometric import Chamfer, Cylinder, Ellipsoid, FullCrown, PartialCrown, Sphere, Tapered
from contactstudy.profiles.logarithmic import FujiwaraKawase, IsoCylindrical, IsoTapered, JohnsGohar, Lundberg
from contactstudy.profiles.measured_profile import Measured

__all__ = [
    "Chamfer",
    "Cylinder",
    "EffectiveLength",
    "Ellipsoid",
    "FujiwaraKawase",
    "FullCrown",
    "Halves",
    "IsoCylindrical",
    "IsoTapered",
    "JohnsGohar",
    "Lundberg",
    "Measured",
    "PartialCrown",
    "Profile",
    "Shape",
    "Sphere",
    "Sum",
    "Tapered",
    "local_radius",
]
