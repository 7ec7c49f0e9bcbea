"""Isotropic linear-elastic material."""

from __future__ import annotations

from dataclasses import dataclass

from contactstudy import checks
from contactstudy.arrays.engineering import quantity
from contactstudy.arrays.html_table import html_table
from contactstudy.bodies.words import material_rows
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

    See Also
    --------
    contactstudy.materials : Some materials, each with its source.

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
        checks.store(self, young=checks.positive("young", self.young, "Pa"))
        poisson = checks.finite("poisson", self.poisson)
        if not -1 < poisson <= 0.5:
            raise InvalidInputError("poisson", self.poisson, "in (-1, 0.5]")
        checks.store(self, poisson=poisson)

    def __repr__(self) -> str:
        return f"Material(E = {quantity(self.young, 'Pa')}, nu = {self.poisson:g})"

    def _repr_html_(self) -> str:
        return html_table([("Material", material_rows(self))])

    @property
    def shear_modulus(self) -> float:
        """Shear modulus ``G = E / (2 (1 + nu))``, Pa."""
        return self.young / (2 * (1 + self.poisson))

    @property
    def plane_strain_modulus(self) -> float:
        """Plane-strain modulus ``E* = E / (1 - nu**2)``, Pa: the contact modulus against a rigid roller."""
        return self.young / (1 - self.poisson**2)


def contact_modulus(first: Material, second: Material | None = None) -> float:
    """Contact modulus ``1 / E* = (1 - nu1**2) / E1 + (1 - nu2**2) / E2`` of two bodies, Pa; the second rigid if None.

    Examples
    --------
    >>> steel = Material(young=210e9, poisson=0.3)
    >>> round(contact_modulus(steel, steel) / contact_modulus(steel), 6)
    0.5
    """
    own = first.plane_strain_modulus
    return own if second is None else 1 / (1 / own + 1 / second.plane_strain_modulus)
