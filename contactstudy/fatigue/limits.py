"""Endurance limits of a material, and the constants of the multiaxial criteria that follow from them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contactstudy import checks
from contactstudy.case.doubts import question_values
from contactstudy.errors import InvalidInputError

ROUNDING = 1e-9
"""Slope of Crossland's criterion below zero that rounding may make. Accuracy."""


@dataclass(frozen=True, kw_only=True)
class FatigueLimits:
    """Amplitudes that the material endures for ever under fully reversed loading.

    Parameters
    ----------
    bending : float
        Limit ``sigma_w`` of the normal stress in bending or push-pull, Pa.
    torsion : float
        Limit ``tau_w`` of the shear stress in torsion, Pa.

    Raises
    ------
    InvalidInputError
        If a limit is not positive, or their ratio is not between 1/2 and 1, where Dang Van's and Findley's criteria
        have a meaning (Crossland's asks for 1/sqrt(3) at least).

    Warns
    -----
    MagnitudeWarning
        If a limit is of a size that is mostly a mistake in the unit.

    Examples
    --------
    >>> limits = FatigueLimits(bending=500e6, torsion=300e6)
    >>> round(limits.dang_van_slope, 6), round(limits.crossland_slope, 6), round(limits.findley_slope, 6)
    (0.3, 0.067949, 0.204124)
    """

    bending: float
    torsion: float

    def __post_init__(self) -> None:
        """Check the limits."""
        for name in ("bending", "torsion"):
            object.__setattr__(self, name, checks.positive(name, getattr(self, name), "Pa"))
        if not 0.5 <= self.ratio < 1:
            raise InvalidInputError(
                "torsion", self.torsion, f"between half of the limit in bending and that limit, {self.bending:g} Pa"
            )
        question_values(bending=self.bending, torsion=self.torsion)

    @property
    def ratio(self) -> float:
        """Limit in torsion over limit in bending."""
        return self.torsion / self.bending

    @property
    def dang_van_slope(self) -> float:
        """``alpha = 3 (tau_w / sigma_w - 1/2)``: bending, shear s/2 and hydrostatic stress s/3, is on the limit."""
        return 3 * (self.ratio - 0.5)

    @property
    def crossland_slope(self) -> float:
        """``A = 3 tau_w / sigma_w - sqrt(3)``: bending, sqrt(J2) s/sqrt(3), hydrostatic s/3, is on the limit."""
        slope = 3 * self.ratio - np.sqrt(3)
        # Limits that von Mises' stress relates give zero up to rounding.
        if slope < -ROUNDING:
            raise InvalidInputError(
                "torsion",
                self.torsion,
                f"at least the limit in bending over sqrt(3), {self.bending / np.sqrt(3):g} Pa, for Crossland",
            )
        return float(max(slope, 0.0))

    @property
    def findley_slope(self) -> float:
        """``k`` for which bending and torsion are both on the limit: ``k / sqrt(1 + k**2) = 2 tau_w/sigma_w - 1``."""
        share = 2 * self.ratio - 1
        return float(share / np.sqrt(1 - share**2))

    @property
    def findley_limit(self) -> float:
        """``f = tau_w sqrt(1 + k**2)``, Pa: what Findley's sum reaches in torsion at the limit."""
        return float(self.torsion * np.sqrt(1 + self.findley_slope**2))
