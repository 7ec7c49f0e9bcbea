"""Isotropic linear-elastic material."""

from __future__ import annotations

from dataclasses import dataclass

from contactstudy import checks
from contactstudy.errors import InvalidInputError


@dataclass(frozen=True)
class Material:
    """Isotropic linear-elastic material.

    Parameters
    ----------
    young : float
        Young's modulus, Pa.
    poisson : float
        Poisson's ratio, in (-1, 0.5].

    Raises
    ------
    InvalidInputError
        If a value is outside its range.

    Examples
    --------
    >>> steel = Material(young=210e9, poisson=0.3)
    >>> round(steel.shear_modulus / 1e9, 2), round(steel.plane_strain_modulus / 1e9, 2)
    (80.77, 230.77)
    """

    young: float
    poisson: float

    def __post_init__(self) -> None:
        """Check the constants."""
        object.__setattr__(self, "young", checks.positive("young", self.young, "Pa"))
        poisson = checks.finite("poisson", self.poisson)
        if not -1 < poisson <= 0.5:
            raise InvalidInputError("poisson", self.poisson, "in (-1, 0.5]")
        object.__setattr__(self, "poisson", poisson)

    @property
    def shear_modulus(self) -> float:
        """Shear modulus ``G = E / (2 (1 + nu))``, Pa."""
        return self.young / (2 * (1 + self.poisson))

    @property
    def plane_strain_modulus(self) -> float:
        """Plane-strain modulus ``E* = E / (1 - nu**2)``, Pa: the contact modulus against a rigid roller."""
        return self.young / (1 - self.poisson**2)


def contact_modulus(body: Material, roller: Material | None) -> float:
    """Contact modulus ``E*``, Pa: ``1 / E* = (1 - nu1**2) / E1 + (1 - nu2**2) / E2``; None stands for a rigid roller.

    Examples
    --------
    >>> steel = Material(young=210e9, poisson=0.3)
    >>> round(contact_modulus(steel, None) / contact_modulus(steel, steel), 9)
    2.0
    """
    if roller is None:
        return body.plane_strain_modulus
    return 1 / (1 / body.plane_strain_modulus + 1 / roller.plane_strain_modulus)
