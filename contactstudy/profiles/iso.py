"""Reference profiles of ISO/TS 16281 for the life of roller bearings."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contactstudy import checks
from contactstudy.checks import FloatArray
from contactstudy.profiles.base import Shape
from contactstudy.profiles.logarithmic import logarithmic_drop

SHORT = 2.5
"""Length over diameter up to which a cylindrical roller is crowned all along."""


@dataclass(frozen=True, repr=False)
class IsoCylindrical(Shape):
    """Reference profile of a cylindrical roller.

    For ``length <= 2.5 D``: ``drop = 0.00035 D ln(1 / (1 - (2 x / length)**2))``. For a longer roller: straight for
    ``|x| <= (length - 2.5 D) / 2``, then ``drop = 0.0005 D ln(1 / (1 - ((2 |x| - length + 2.5 D) / (2.5 D))**2))``.

    Parameters
    ----------
    diameter : float
        Diameter ``D`` of the roller, metres. The length taken is the effective one, without corners.

    Raises
    ------
    InvalidInputError
        If the diameter is not positive.

    Notes
    -----
    The short profile is Lundberg's for a Hertz pressure of 3000 MPa between a steel roller and a flat steel raceway.
    The two branches differ in their amplitude: at ``length = 2.5 D`` the drop jumps by the factor 0.0005 / 0.00035.
    The drop is infinite at the very ends.

    References
    ----------
    ISO/TS 16281:2008, Rolling bearings - Methods for calculating the modified reference rating life for universally
    loaded bearings.

    Examples
    --------
    >>> import numpy as np
    >>> drop = IsoCylindrical(diameter=10e-3).drop(np.array([0.0, 4e-3]), length=10e-3)
    >>> (1e6 * drop).round(3).tolist()
    [0.0, 3.576]
    """

    diameter: float

    def __post_init__(self) -> None:
        """Check the diameter."""
        object.__setattr__(self, "diameter", checks.positive("diameter", self.diameter, "metres"))

    def drop(self, x: FloatArray, length: float) -> FloatArray:
        """Material removed (m) at distances `x` (m) from mid-length; infinite at the very ends."""
        crowned = SHORT * self.diameter
        if length <= crowned:
            return logarithmic_drop(0.00035 * self.diameter, 2 * np.asarray(x) / length)
        inside = np.maximum(2 * np.abs(x) - (length - crowned), 0.0)
        return logarithmic_drop(0.0005 * self.diameter, inside / crowned)


@dataclass(frozen=True, repr=False)
class IsoTapered(Shape):
    """Reference profile of a tapered roller: ``drop = 0.00045 D ln(1 / (1 - (2 x / length)**2))``.

    It is the departure from the cone. Add :class:`~contactstudy.profiles.Tapered` for a cone on a surface that is
    parallel to the axis.

    Parameters
    ----------
    diameter : float
        Mean diameter ``D`` of the roller, metres. The length taken is the effective one, without corners.

    Raises
    ------
    InvalidInputError
        If the diameter is not positive.

    References
    ----------
    ISO/TS 16281:2008, as for :class:`IsoCylindrical`.

    Examples
    --------
    >>> import numpy as np
    >>> drop = IsoTapered(diameter=10e-3).drop(np.array([0.0, 4e-3]), length=10e-3)
    >>> (1e6 * drop).round(3).tolist()
    [0.0, 4.597]
    """

    diameter: float

    def __post_init__(self) -> None:
        """Check the diameter."""
        object.__setattr__(self, "diameter", checks.positive("diameter", self.diameter, "metres"))

    def drop(self, x: FloatArray, length: float) -> FloatArray:
        """Material removed (m) at distances `x` (m) from mid-length; infinite at the very ends."""
        return logarithmic_drop(0.00045 * self.diameter, 2 * np.asarray(x) / length)
