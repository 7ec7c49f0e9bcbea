"""Losses of a film: traction over the slide-roll ratio, rolling moment, power, thermal reduction."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.variables import describe, labelled_cells
from contactstudy.bodies.lubricant import Lubricant
from contactstudy.case.case import Case
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError


def film_traction(
    case: Case, result: xr.Dataset, slide_roll_ratios: Sequence[float] | FloatArray, *, boundary_friction: float = 0.12
) -> xr.Dataset:
    """Compute traction and losses, at slide-roll ratios, of the film of the case's entrainment speed.

    The film forms in the inlet: it equals the film of pure rolling times `thermal_reduction`.

    Parameters
    ----------
    case : Case
        The case, with its lubricant. Its `eyring_stress` and `limiting_shear` limit the shear stress where given;
        without both the lubricant is Newtonian.
    result : Dataset
        Result of `solve_film` for the case.
    slide_roll_ratios : sequence of float
        Differences of the speeds over their mean, increasing.
    boundary_friction : float
        Coefficient of friction of asperities in contact.

    Returns
    -------
    Dataset
        Over `slide_roll_ratio`: `traction_y` (x, y) on the body, for stresses and heat, `traction_coefficient`,
        `power_loss` of sliding and rolling, `thermal_reduction` if the lubricant has `temperature_viscosity` and
        `conductivity`; `rolling_force` and `rolling_moment`, about the roller's axis.

    Raises
    ------
    InvalidInputError
        If the case has no lubricant, or the result is not of a film.

    Examples
    --------
    >>> from contactstudy import HalfSpace, Lubricant, Material, Roller, Sliding, profiles, solve_film
    >>> body = HalfSpace(material=Material(210e9, 0.3))
    >>> roller = Roller(radius=5e-3, length=0.3e-3, profile=profiles.Lundberg(amplitude=0.4e-6))
    >>> oil = Lubricant.preset("heavy machine oil", 60.0).replaced(eyring_stress=5e6, limiting_shear=0.08)
    >>> motion = Sliding(body_speed=1.0, roller_speed=1.0)
    >>> case = Case(body=body, roller=roller, max_pressure=1.5e9, motion=motion, lubricant=oil)
    >>> curve = film_traction(case, solve_film(case, accuracy=0.1), [0.0, 0.01, 0.1])
    >>> [round(float(value), 3) for value in curve.traction_coefficient]
    [0.0, 0.037, 0.044]
    """
    checks.instance("case", case, Case, "a Case")
    lubricant = case.lubricant
    if lubricant is None:
        raise InvalidInputError("case.lubricant", None, "a Lubricant(...) for the traction of a film")
    if "film_thickness" not in result:
        raise InvalidInputError("result", f"{len(result)} variables", "a result of solve_film, with film_thickness")
    slide_rolls = checks.coordinates("slide_roll_ratios", slide_roll_ratios)
    friction = checks.not_negative("boundary_friction", boundary_friction)
    pressure, grid = labelled_cells("result.pressure", result["pressure"], extent=case.body.extent)
    height = np.nan_to_num(result["film_thickness"].transpose("x", "y").values, nan=np.inf)
    asperities = np.zeros_like(pressure)
    if "asperity_pressure" in result:
        asperities = result["asperity_pressure"].transpose("x", "y").values
    fluid_pressure = np.maximum(pressure - asperities, 0.0)
    area = grid.weights * grid.cell_area
    speed, load = abs(float(result["entrainment_speed"])), float(result["normal_load"])
    traction = np.stack(
        [
            np.sign(ratio)
            * (
                np.where(fluid_pressure > 0, shear_stress(lubricant, fluid_pressure, abs(ratio) * speed / height), 0.0)
                + friction * asperities
            )
            for ratio in slide_rolls
        ]
    )
    traction_force = (area * traction).sum(axis=(1, 2))
    film = np.where(np.isfinite(height), height, 0.0)
    slope_forces = 0.5 * (film[:, 1:] + film[:, :-1]) * np.diff(fluid_pressure, axis=1)  # eq. (415)
    rolling_force = 0.5 * abs(float((grid.widths[:, None] * slope_forces).sum()))
    variables: dict[str, object] = {
        "traction_y": (("slide_roll_ratio", "x", "y"), np.sign(float(result["entrainment_speed"])) * traction),
        "traction_coefficient": (("slide_roll_ratio",), traction_force / load),
        "power_loss": (("slide_roll_ratio",), np.abs(traction_force * slide_rolls) * speed + 2 * rolling_force * speed),
        "rolling_force": rolling_force,
        "rolling_moment": rolling_force * case.roller.radius,
    }
    if lubricant.temperature_viscosity is not None and lubricant.conductivity is not None:
        loading = lubricant.viscosity * lubricant.temperature_viscosity * speed**2 / lubricant.conductivity
        pressure_ratio = case.hertz_max_pressure / (2 * case.modulus)
        variables["thermal_reduction"] = (
            ("slide_roll_ratio",),
            [thermal_reduction(pressure_ratio, loading, float(ratio)) for ratio in slide_rolls],
        )
    curve = xr.Dataset(variables, coords={**result["pressure"].coords, "slide_roll_ratio": slide_rolls})
    return describe(curve, "traction of a lubricated contact")


def shear_stress(oil: Lubricant, pressure: FloatArray, shear_rate: FloatArray) -> FloatArray:
    """Shear stress, Pa, at pressures, Pa, and shear rates, 1/s: Newtonian, Ree-Eyring, and limited, eq. (416)."""
    stress = np.minimum(oil.viscosity_at(pressure) * shear_rate, checks.MAX_MAGNITUDE)
    if oil.eyring_stress is not None:
        stress = oil.eyring_stress * np.arcsinh(stress / oil.eyring_stress)
    if oil.limiting_shear is not None:
        stress = np.minimum(stress, oil.limiting_shear * pressure)
    return np.asarray(stress)


def thermal_reduction(pressure_ratio: float, loading: float, slide_roll_ratio: float) -> float:
    """Film with the heat of shear in the inlet over the isothermal film (Gupta, Cheng, Zhu 1992), eq. (414).

    From the largest pressure over E' and the `loading` ``eta0 beta um**2 / k``.
    """
    inlet_heating = 1 + 0.213 * (1 + 2.23 * abs(slide_roll_ratio) ** 0.83) * loading**0.64
    return float((1 - 13.2 * pressure_ratio * loading**0.42) / inlet_heating)
