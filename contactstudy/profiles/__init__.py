"""Roller profiles: how much lower than the cylinder a roller's generatrix lies.

A profile is a small object with one method ``drop(x, length)``: the material removed, in metres and not negative, at
the distance `x` from mid-length of a roller of the given `length`. ``one + other`` adds two up. The
conventions with a sketch, and a table of all profiles with formulas and sources, are in docs/reference/profiles.md.

``length`` is the distance between the end faces, fillets included. A formula or drawing that counts over the
*effective* length, without the corners, goes into :class:`EffectiveLength`. A drop may be infinite at the very ends
(Lundberg, ISO/TS 16281): the roller does not touch there.
"""

from contactstudy.near_names import suggest
from contactstudy.profiles.base import Profile, Shape, Sum, local_radius
from contactstudy.profiles.corners import EffectiveLength
from contactstudy.profiles.crowned import FullCrown, PartialCrown
from contactstudy.profiles.ellipsoid import Ellipsoid, Sphere
from contactstudy.profiles.halves import Halves
from contactstudy.profiles.iso import IsoCylindrical, IsoTapered
from contactstudy.profiles.logarithmic import FujiwaraKawase, JohnsGohar, Lundberg
from contactstudy.profiles.measured import Measured
from contactstudy.profiles.straight import Cylinder, Tapered

__all__ = [
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

suggest(__name__, __all__)
