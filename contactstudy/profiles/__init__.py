"""Roller profiles: how much lower than the cylinder a roller's generatrix lies.

A profile is a small object with one method ``drop(x, length)``: the material removed, in metres and not negative, at
the distance `x` from mid-length of a roller of the given `length`. ``one + other`` adds two up. The
conventions with a sketch, and a table of all profiles with formulas and sources, are in docs/reference/profiles.md.

``length`` is the distance between the end faces, fillets included. A formula or drawing that counts over the
*effective* length, without the corners, goes into :class:`EffectiveLength`. A drop may be infinite at the very ends
(Lundberg, ISO/TS 16281): the roller does not touch there.
"""

from contactstudy.profiles.base import Profile, Shape, Sum, local_radius
from contactstudy.profiles.combinations import EffectiveLength, Halves
from contactstudy.profiles.crowned import Ellipsoid, FullCrown, PartialCrown, Sphere
from contactstudy.profiles.logarithmic import FujiwaraKawase, IsoCylindrical, IsoTapered, JohnsGohar, Lundberg
from contactstudy.profiles.measured import Measured
from contactstudy.profiles.straight import Chamfer, Cylinder, Tapered

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
