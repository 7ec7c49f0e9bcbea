"""Lubricants: viscosity and density under pressure, viscosity at a temperature."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from contactstudy import checks
from contactstudy.arrays.engineering import format_quantity
from contactstudy.checks import BoolArray, FloatArray
from contactstudy.errors import InvalidInputError

ROELANDS_PRESSURE = 1.962e8  # Reference pressure of Roelands' law, Pa. Physics.
ROELANDS_VISCOSITY = 6.31e-5  # Viscosity of every oil at the negative pole of Roelands' law, Pa s. Physics.
DENSITY_PRESSURE, DENSITY_GAIN = 5.9e8, 1.34  # Constants of Dowson and Higginson's density, Pa and 1. Physics.
BARUS_PRESSURE = 0.5e9  # Pressure to which Barus' law holds, Pa. Physics.
MAX_LOG_VISCOSITY = 25.0  # Logarithm of the viscosity ratio above which an oil is solid. Physics.
KELVIN = 273.15  # 0 degrees Celsius in kelvin. Physics.


@dataclass(frozen=True, kw_only=True)
class Lubricant:
    """A lubricant at the temperature of the inlet, Newtonian unless a shear stress limits it.

    Parameters
    ----------
    viscosity : float
        Dynamic viscosity ``eta0`` at ambient pressure, Pa s.
    pressure_viscosity : float
        Pressure-viscosity coefficient ``alpha`` at ambient pressure, 1/Pa.
    viscosity_law : str
        "roelands", or "barus" for ``eta0 exp(alpha p)``, which holds to some 0.5 GPa: above, `solve_film` warns.
    roelands_exponent : float, optional
        Exponent ``z`` of Roelands' law; default: from `viscosity` and `pressure_viscosity`.
    density_law : str
        "dowson-higginson", or "constant".
    density : float, optional
        Density at ambient pressure, kg/m3; for the kinematic viscosity only.
    temperature_viscosity : float, optional
        ``beta = -d(ln eta)/dT``, 1/K; for the thermal reduction of the film.
    conductivity : float, optional
        Thermal conductivity, W/(m K); for the thermal reduction of the film.
    eyring_stress : float, optional
        Stress ``tau0`` of Ree-Eyring's law, Pa; for the traction.
    limiting_shear : float, optional
        Limiting shear stress over the pressure; for the traction.

    Raises
    ------
    InvalidInputError
        If a value is not positive, or a law is unknown.

    Examples
    --------
    >>> oil = Lubricant(viscosity=0.034, pressure_viscosity=20.5e-9)
    >>> round(float(oil.viscosity_at(1e9)), 1), round(float(oil.density_ratio(1e9)), 3)
    (30134.9, 1.214)
    """

    viscosity: float = field(metadata=checks.number(checks.positive, "Pa s"))
    pressure_viscosity: float = field(metadata=checks.number(checks.positive, "1/Pa"))
    viscosity_law: str = "roelands"
    roelands_exponent: float | None = field(default=None, metadata=checks.number(checks.positive))
    density_law: str = "dowson-higginson"
    density: float | None = field(default=None, metadata=checks.number(checks.positive, "kg/m3"))
    temperature_viscosity: float | None = field(default=None, metadata=checks.number(checks.positive, "1/K"))
    conductivity: float | None = field(default=None, metadata=checks.number(checks.positive, "W/(m K)"))
    eyring_stress: float | None = field(default=None, metadata=checks.number(checks.positive, "Pa"))
    limiting_shear: float | None = field(default=None, metadata=checks.number(checks.positive))

    def __post_init__(self) -> None:
        checks.store_numbers(self)
        checks.known_name("viscosity_law", self.viscosity_law, ("roelands", "barus"))
        checks.known_name("density_law", self.density_law, ("dowson-higginson", "constant"))
        if self.viscosity_law == "roelands" and self.viscosity <= ROELANDS_VISCOSITY:
            allowed = f"above {ROELANDS_VISCOSITY:g} Pa s with viscosity_law = 'roelands'"
            hint = "viscosities are in Pa s: 30 mPa s is 0.03"
            raise InvalidInputError("viscosity", self.viscosity, allowed, hint)

    def __repr__(self) -> str:
        alpha = f"{1e9 * self.pressure_viscosity:.3g} 1/GPa"
        laws = f"{self.viscosity_law}, {self.density_law} density"
        return f"Lubricant(eta0 = {format_quantity(self.viscosity, 'Pa s')}, alpha = {alpha}, {laws})"

    @property
    def exponent(self) -> float:
        """Exponent ``z`` of Roelands' law: the given exponent, or ``alpha p_r / (ln eta0 + 9.67)``."""
        if self.roelands_exponent is not None:
            return self.roelands_exponent
        return float(self.pressure_viscosity * ROELANDS_PRESSURE / np.log(self.viscosity / ROELANDS_VISCOSITY))

    def log_viscosity(self, pressure: FloatArray | float) -> FloatArray:
        """Logarithm of the viscosity over the ambient viscosity, at pressures in Pa (0 below zero)."""
        p = np.maximum(pressure, 0.0)
        if self.viscosity_law == "barus":
            return np.asarray(self.pressure_viscosity * p)  # eq. (406)
        z, scale = self.exponent, ROELANDS_PRESSURE  # eq. (407)
        return np.asarray(self.pressure_viscosity * scale / z * ((1 + p / scale) ** z - 1))

    def viscosity_at(self, pressure: FloatArray | float) -> FloatArray:
        """Dynamic viscosity at pressures in Pa, Pa s."""
        # The bound prevents an overflow of the viscosity and its powers.
        return np.asarray(self.viscosity * np.exp(np.minimum(self.log_viscosity(pressure), 400.0)))

    def law_holds(self, pressure: FloatArray | float) -> BoolArray:
        """Whether the viscosity law holds at pressures in Pa, by Roelands up to solidification."""
        if self.viscosity_law == "barus":
            return np.asarray(np.asarray(pressure) <= BARUS_PRESSURE)
        return np.asarray(self.log_viscosity(pressure) <= MAX_LOG_VISCOSITY)

    def density_ratio(self, pressure: FloatArray | float) -> FloatArray:
        """Density at pressures in Pa over the ambient density."""
        p = np.maximum(pressure, 0.0)
        if self.density_law == "constant":
            return np.ones_like(p)
        return np.asarray((DENSITY_PRESSURE + DENSITY_GAIN * p) / (DENSITY_PRESSURE + p))  # eq. (408)

    def density_ratio_slope(self, pressure: FloatArray | float) -> FloatArray:
        """Return the derivative of :meth:`density_ratio`, 1/Pa; zero below zero."""
        p = np.maximum(pressure, 0.0)
        if self.density_law == "constant":
            return np.zeros_like(p)
        slope = (DENSITY_GAIN - 1) * DENSITY_PRESSURE / (DENSITY_PRESSURE + p) ** 2
        return np.asarray(slope * (np.asarray(pressure) >= 0))

    @property
    def kinematic_viscosity(self) -> float:
        """Kinematic viscosity at ambient pressure, m2/s."""
        if self.density is None:
            raise InvalidInputError("lubricant.density", None, "a number (kg/m3) for the kinematic viscosity")
        return self.viscosity / self.density

    @classmethod
    def from_kinematic(
        cls,
        temperature: float,
        *,
        viscosities: dict[float, float],
        density: float,
        pressure_viscosity: float,
        **properties: float | str,
    ) -> Lubricant:
        """Lubricant at a temperature, from two kinematic viscosities of a data sheet (ASTM D341).

        Parameters
        ----------
        temperature : float
            Temperature of the inlet, degrees Celsius.
        viscosities : dict
            Two kinematic viscosities, mm2/s, by temperature, degrees Celsius: ``{40: 220.0, 100: 19.0}``.
        density : float
            Density at that temperature, kg/m3.
        pressure_viscosity : float
            Pressure-viscosity coefficient at that temperature, 1/Pa.
        **properties
            Further parameters of the lubricant.

        Returns
        -------
        Lubricant
            With `temperature_viscosity`.

        Raises
        ------
        InvalidInputError
            If `viscosities` are not two values above 2 mm2/s that decrease with temperature.

        Examples
        --------
        >>> grade = {40: 220.0, 100: 19.0}
        >>> oil = Lubricant.from_kinematic(70.0, viscosities=grade, density=870.0, pressure_viscosity=20e-9)
        >>> round(1e6 * oil.kinematic_viscosity, 1), round(oil.temperature_viscosity, 4)
        (51.7, 0.0396)
        """
        density = checks.positive("density", density, "kg/m3")
        viscosity, slope = walther(viscosities, checks.finite("temperature", temperature, "degrees Celsius"))
        arguments: dict[str, Any] = {"temperature_viscosity": slope, "density": density, **properties}
        return cls(viscosity=1e-6 * viscosity * density, pressure_viscosity=pressure_viscosity, **arguments)

    @classmethod
    def preset(cls, name: str, temperature: float) -> Lubricant:
        """Return an oil of the table `OILS` at a temperature between 30 and 100 degrees Celsius.

        Viscosities follow Vogel's law through the table's three values; pressure-viscosity coefficients are linear.

        Raises
        ------
        InvalidInputError
            If the oil is unknown, or the temperature lies outside its table.

        Examples
        --------
        >>> Lubricant.preset("heavy machine oil", 60.0)
        Lubricant(eta0 = 0.034 Pa s, alpha = 20.5 1/GPa, roelands, dowson-higginson density)
        """
        viscosities, pressure_viscosities = OILS[checks.known_name("name", name, OILS)]
        theta = checks.finite("temperature", temperature, "degrees Celsius")
        lowest, highest = OIL_TEMPERATURES[0], OIL_TEMPERATURES[-1]
        if not lowest <= theta <= highest:
            raise InvalidInputError("temperature", theta, f"from {lowest:g} to {highest:g} degrees Celsius", SOURCE)
        temperatures, log_viscosities = np.array(OIL_TEMPERATURES), np.log(viscosities)
        # ln eta = A + B / (theta - C), through three points.
        ratio = (log_viscosities[0] - log_viscosities[1]) / (log_viscosities[1] - log_viscosities[2])
        ratio *= (temperatures[2] - temperatures[1]) / (temperatures[1] - temperatures[0])
        c = (ratio * temperatures[0] - temperatures[2]) / (ratio - 1)
        b = (log_viscosities[0] - log_viscosities[1]) / (1 / (temperatures[0] - c) - 1 / (temperatures[1] - c))
        log_viscosity = log_viscosities[0] + b * (1 / (theta - c) - 1 / (temperatures[0] - c))
        return cls(
            viscosity=float(np.exp(log_viscosity)),
            pressure_viscosity=1e-9 * float(np.interp(theta, temperatures, pressure_viscosities)),
            temperature_viscosity=float(b / (theta - c) ** 2),
        )

    def replaced(self, **values: float | str | None) -> Lubricant:
        """Return the lubricant with other values."""
        return replace(self, **values)  # type: ignore[arg-type]


def walther(viscosities: dict[float, float], temperature: float) -> tuple[float, float]:
    """Kinematic viscosity at a temperature (C), mm2/s, and the fall of its logarithm with the temperature, 1/K."""
    # ASTM D341, ``log10 log10(nu + 0.7) = A - B log10 T``, nu in mm2/s and T in kelvin, through two points: eq. (409).
    if not isinstance(viscosities, dict) or len(viscosities) != 2:
        raise InvalidInputError("viscosities", viscosities, "two kinematic viscosities (mm2/s) by temperature (C)")
    (lower_temperature, high_viscosity), (upper_temperature, low_viscosity) = sorted(
        (checks.finite("viscosities", key), checks.positive("viscosities", value)) for key, value in viscosities.items()
    )
    if not (high_viscosity > low_viscosity >= 2 and lower_temperature > -KELVIN):
        allowed = "falling with the temperature, at least 2 mm2/s"
        raise InvalidInputError("viscosities", viscosities, allowed, "the range of ASTM D341")
    double_logarithms = [np.log10(np.log10(viscosity + 0.7)) for viscosity in (high_viscosity, low_viscosity)]
    log_temperatures = [np.log10(celsius + KELVIN) for celsius in (lower_temperature, upper_temperature)]
    b = (double_logarithms[0] - double_logarithms[1]) / (log_temperatures[1] - log_temperatures[0])
    kelvin = temperature + KELVIN
    logarithm = 10 ** (double_logarithms[0] + b * log_temperatures[0] - b * np.log10(kelvin))
    viscosity = 10**logarithm - 0.7
    return float(viscosity), float((viscosity + 0.7) / viscosity * logarithm * np.log(10) * b / kelvin)


OIL_TEMPERATURES = (30.0, 60.0, 100.0)  # Temperatures of `OILS`, degrees Celsius
SOURCE = "G. W. Stachowiak, A. W. Batchelor, Engineering Tribology, table 2.3"  # Source of `OILS`
OILS = {  # viscosities, Pa s, and pressure-viscosity coefficients, 1/GPa, at these temperatures
    "heavy machine oil": ((0.153, 0.034, 0.0091), (23.7, 20.5, 15.8)),
    "heavier machine oil": ((0.250, 0.0505, 0.0126), (25.0, 21.3, 17.6)),
    "cylinder oil": ((0.810, 0.135, 0.0268), (34.0, 28.0, 22.0)),
    "spindle oil": ((0.0186, 0.0063, 0.0024), (20.0, 16.0, 13.0)),
    "light machine oil": ((0.045, 0.012, 0.0039), (28.0, 20.0, 16.0)),
    "medicinal white oil": ((0.107, 0.0233, 0.0064), (29.6, 22.8, 17.8)),
}
