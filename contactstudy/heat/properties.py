"""What a material does with heat."""

from __future__ import annotations

from dataclasses import dataclass

from contactstudy import checks
from contactstudy.case.doubts import question_values


@dataclass(frozen=True, kw_only=True)
class ThermalProperties:
    """Thermal properties of a material, independent of its temperature.

    Parameters
    ----------
    conductivity : float
        Thermal conductivity, W/(m K).
    density : float
        Density, kg/m3.
    specific_heat : float
        Heat capacity of a unit of mass, J/(kg K).

    Raises
    ------
    InvalidInputError
        If a value is not a positive finite number.

    Warns
    -----
    MagnitudeWarning
        If a value is of a size that is mostly a mistake in the unit.

    Examples
    --------
    >>> steel = ThermalProperties(conductivity=46.0, density=7850.0, specific_heat=470.0)
    >>> round(1e6 * steel.diffusivity, 2)
    12.47
    """

    conductivity: float
    density: float
    specific_heat: float

    def __post_init__(self) -> None:
        """Check the values."""
        units = {"conductivity": "W/(m K)", "density": "kg/m3", "specific_heat": "J/(kg K)"}
        checks.store(self, **{name: checks.positive(name, getattr(self, name), unit) for name, unit in units.items()})
        question_values(**{name: getattr(self, name) for name in units})

    @property
    def heat_capacity(self) -> float:
        """Heat capacity of a unit of volume, J/(m3 K)."""
        return self.density * self.specific_heat

    @property
    def diffusivity(self) -> float:
        """Thermal diffusivity ``kappa = lambda / (rho c)``, m2/s."""
        return self.conductivity / self.heat_capacity
