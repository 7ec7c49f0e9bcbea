"""Risk of fatigue over the stressed volume, and relative life: ratio of two lives of the same survival probability.

``ln(1/S) = const N**e risk`` for the probability S to survive N passages; the constant belongs to material and
lubrication. G. Lundberg, A. Palmgren, Dynamic capacity of rolling bearings, Acta Polytechnica, Mechanical Engineering
Series 1 (1947) no. 3, and 2 (1952) no. 4; E. Ioannides, T. A. Harris, A new fatigue life model for rolling bearings,
Journal of Tribology 107 (1985) 367-378.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.analysis import dimension_along, measure, positions
from contactstudy.analysis.axes import axis_dimensions, reduce_dims
from contactstudy.arrays.variables import ERROR_KIND, NOT_ESTIMATED, in_si, name_array, require, require_in_si
from contactstudy.checks import Array
from contactstudy.errors import InvalidInputError
from contactstudy.fatigue.history import label_points, rolling_dimension


@dataclass(frozen=True, kw_only=True)
class LifeExponents:
    """Exponents of the life theories; the defaults are Lundberg and Palmgren's for roller bearings.

    A line contact's risk per length goes with ``p0**(c - h + 1)``, and its load with ``p0**2``: life falls with the
    load to the power ``(c - h + 1) / (2 e)``, which is 4 for rollers.

    Parameters
    ----------
    stress : float
        Exponent ``c`` of the stress.
    depth : float
        Exponent ``h`` of the depth.
    weibull : float
        Slope ``e`` of the Weibull distribution of lives: 9/8 for line contact, 10/9 for point contact.

    Raises
    ------
    InvalidInputError
        If an exponent is not positive.

    Examples
    --------
    >>> exponents = LifeExponents()
    >>> round((exponents.stress - exponents.depth + 1) / (2 * exponents.weibull), 9)
    4.0
    """

    stress: float = field(default=31 / 3, metadata=checks.number(checks.positive))
    depth: float = field(default=7 / 3, metadata=checks.number(checks.positive))
    weibull: float = field(default=9 / 8, metadata=checks.number(checks.positive))

    def __post_init__(self) -> None:
        checks.store_numbers(self)

    def units(self, lengths: int) -> str:
        """Return the unit of the integral of ``stress**c / depth**h`` over 1 or 2 lengths."""
        return f"Pa**{self.stress:.6g} m**{lengths - self.depth:.6g}"


ROLLER_BEARINGS = LifeExponents()


def relative_life(risk: xr.Dataset, reference: xr.Dataset, exponents: LifeExponents = ROLLER_BEARINGS) -> xr.DataArray:
    """Life of one contact over the life of a reference, for the same probability to survive.

    Parameters
    ----------
    risk, reference : Dataset
        Results of :func:`lundberg_palmgren`, or both of :func:`ioannides_harris` with the same limit.
    exponents : LifeExponents
        Exponents of both risks.

    Returns
    -------
    DataArray
        ``(reference risk / risk)**(1/e)``; infinite without any risk, NaN if neither has a risk. Its coordinate
        `relative_life_error` follows from the errors of both risks; a `comment` marks a result without these errors.

    Raises
    ------
    InvalidInputError
        If a risk is missing, or the two were computed with different exponents, theories or limits.

    Examples
    --------
    >>> single, double = (xr.Dataset({"risk": xr.DataArray(value, attrs={"units": "1"})}) for value in (1.0, 2.0))
    >>> round(float(relative_life(double, single)), 6) == round(0.5 ** (8 / 9), 6)
    True
    """
    checks.instance("exponents", exponents, LifeExponents, "a LifeExponents")
    for name, dataset in (("risk", risk), ("reference", reference)):
        require(dataset, "risk", argument=name)
    units = [dataset["risk"].attrs.get("units") for dataset in (risk, reference)]
    if units[0] != units[1]:
        raise InvalidInputError("reference", units[1], f"computed with the same exponents, {units[0]}")
    for name in ("theory", "fatigue_limit"):
        value, reference_value = (dataset["risk"].attrs.get(name) for dataset in (risk, reference))
        if value is not None is not reference_value and value != reference_value:
            allowed = f"computed as risk was, {name} = {value}"
            raise InvalidInputError("reference", f"{name} = {reference_value}", allowed)
    risks, references = risk["risk"], reference["risk"]
    # Without risk the life is infinite, unless the reference has no risk.
    ratio = (references / risks.where(risks > 0)).where((risks != 0) | (references == 0), np.inf)
    life = name_array("relative_life", ratio ** (1 / exponents.weibull))
    if not all("risk_error" in dataset for dataset in (risk, reference)):
        return life.assign_attrs({ERROR_KIND: NOT_ESTIMATED})
    relative_error = risk["risk_error"] / risks.where(risks > 0)
    reference_error = reference["risk_error"] / references.where(references > 0)
    # The longest life within the errors; infinite if the risk may be zero.
    max_factor = ((1 + reference_error) / (1 - relative_error).clip(0.0)) ** (1 / exponents.weibull)
    error = (life * (max_factor - 1)).reset_coords(drop=True)
    return life.assign_coords(relative_life_error=name_array("relative_life_error", error))


MAX_TRUNCATED_RISK = 0.01  # Maximum fraction of the risk from sections with a truncated history or depth


def _depth_positions(stress: xr.DataArray) -> tuple[str, xr.DataArray]:
    """Dimension and positions along the depth, NaN where padded."""
    dim = dimension_along(stress, "z")
    if stress.sizes[dim] < 3:
        raise InvalidInputError("stress", dict(stress.sizes), "given at three or more depths")
    return dim, positions(stress, "z")


def _find_maximum(stress: Array, depth: Array) -> tuple[Array, Array]:
    """Largest stress over the depth and the depth of this maximum, by a parabola through the three nearest points."""
    finite_stress = np.where(np.isnan(stress), -np.inf, stress)
    index = finite_stress.argmax(axis=-1)[..., None]
    points = np.stack([np.broadcast_to(depth, stress.shape), finite_stress])
    columns = (np.clip(index + step, 0, stress.shape[-1] - 1) for step in (-1, 0, 1))
    (z1, s1), (z2, s2), (z3, s3) = (np.take_along_axis(points, column[None], axis=-1)[..., 0] for column in columns)
    with np.errstate(divide="ignore", invalid="ignore"):
        slope_before, slope_after = (s2 - s1) / (z2 - z1), (s3 - s2) / (z3 - z2)
        curvature = (slope_after - slope_before) / (z3 - z1)
        position = 0.5 * (z1 + z2) - slope_before / (2 * curvature)
        maximum = s2 + (position - z2) * (slope_before + curvature * (position - z1))
    is_inside = np.isfinite(maximum) & (curvature < 0)
    maximum, position = np.where(np.isfinite(s2), np.where(is_inside, (maximum, position), (s2, z2)), np.nan)
    return maximum, position


def _integrate(density: Array, position: Array) -> Array:
    """Trapezoidal integral along the last axis without padded positions."""
    position = np.broadcast_to(position, density.shape)
    areas = 0.5 * (density[..., 1:] + density[..., :-1]) * np.abs(np.diff(position, axis=-1))
    is_empty = (np.isnan(density) | np.isnan(position)).all(axis=-1)
    return np.asarray(np.where(is_empty, np.nan, np.nansum(areas, axis=-1)))


def _integrate_risk(
    density: xr.DataArray,
    exponents: LifeExponents,
    theory: Mapping[str, str | float],
    truncated_sections: dict[str, xr.DataArray],
) -> xr.Dataset:
    """Risk along x, and its integral over x; `truncated_sections` maps reasons to masks of the sections."""
    x = dimension_along(density, "x")
    if density.sizes[x] < 2:
        raise InvalidInputError("stress", dict(density.sizes), "given at two or more positions along x")
    if (positions(density, "x").diff(x) <= 0).any():
        raise InvalidInputError("x", positions(density, "x").values, "increasing positions")
    risk = _sum_over_x(density)
    for name, mask in truncated_sections.items():
        fraction = _sum_over_x(density.where(mask, 0.0)) / risk.where(risk > 0)
        if (fraction > MAX_TRUNCATED_RISK).any():
            value = f"{name} in sections with {float(fraction.max()):.2g} of the risk"
            allowed = f"largest inside; at most {MAX_TRUNCATED_RISK:g} of the risk may be cut off"
            hint = "solve with y over the whole passage, for example from -3 to 3 half-widths, and z from 0 to 2"
            raise InvalidInputError("stress", value, allowed, hint)
    return xr.Dataset(
        {
            "risk_density": label_points("risk_density", density).assign_attrs(units=exponents.units(1)),
            "risk": name_array("risk", risk).assign_attrs(units=exponents.units(2), **theory),
        }
    )


def _sum_over_x(density: xr.DataArray) -> xr.DataArray:
    """Integral of a density over x."""
    x = dimension_along(density, "x")
    risk: xr.DataArray = xr.apply_ufunc(_integrate, density, positions(density, "x"), input_core_dims=[[x], [x]])
    return risk.reset_coords(drop=True)


def _estimate_error(
    field: xr.DataArray, risk: xr.DataArray, compute_risk: Callable[[xr.DataArray], xr.DataArray]
) -> xr.DataArray:
    """Error of a risk: sum over the axes of the change with every second position; infinite with too few positions."""
    error = np.zeros(risk.shape)
    for axis, dim in axis_dimensions(field).items():
        subsets = [np.arange(start, field.sizes[dim], 2) for start in (0, 1)]
        if axis == "x":  # the integral over x includes the last position
            subsets = [np.unique(np.append(subsets[0], field.sizes[dim] - 1))]
        # Every second position must leave at least three positions.
        if any(indices.size < 3 for indices in subsets):
            return xr.full_like(risk, np.inf)
        subset_risks = [compute_risk(field.isel({dim: indices})).values for indices in subsets]
        error += np.abs(subset_risks - risk.values).max(axis=0)
    return risk.copy(data=error)


def _assign_error(result: xr.Dataset, error: xr.DataArray, comment: str) -> xr.Dataset:
    """Return a result with the error of its risk; zero for a risk of zero."""
    risk = result["risk"]
    risk_error = name_array("risk_error", error.where(risk != 0, 0.0))
    return result.assign(risk_error=risk_error.assign_attrs(units=risk.attrs["units"], comment=comment))


def lundberg_palmgren(stress: xr.Dataset, exponents: LifeExponents = ROLLER_BEARINGS) -> xr.Dataset:
    """Risk of fatigue after Lundberg and Palmgren, section by section along the roller.

    Each cross-section contributes ``tau_0**c z_0**(1 - h) dx``, with its largest amplitude ``tau_0`` of the orthogonal
    shear at the depth ``z_0``; the stressed volume per length of the raceway is proportional to ``z_0``.

    Parameters
    ----------
    stress : Dataset
        `tau_yz` with the rolling direction y over the whole passage, at three or more depths and two or more x.
    exponents : LifeExponents
        Exponents; default: of roller bearings.

    Returns
    -------
    Dataset
        `risk_density` (along x), `risk` (its integral over x, to be compared by :func:`relative_life`) and
        `risk_error`, `shear_amplitude` (Pa) ``tau_0`` and `shear_depth` (m) ``z_0`` along x.

    Raises
    ------
    InvalidInputError
        If `tau_yz` or an axis is missing, positions are too few, or `exponents` has a wrong kind; if the shear is
        largest at the first or last position along y or z, so that more than 1 % of the risk is cut off.

    Examples
    --------
    >>> y, z = xr.DataArray([-2.0, -1, 0, 1, 2], dims="y"), xr.DataArray([0.25, 0.5, 0.75], dims="z")
    >>> shear = (y * (y**2 - 4) / 3 * (1 - (z - 0.5) ** 2)).expand_dims(x=[0.0, 2.0]).assign_coords(y=y, z=z)
    >>> result = lundberg_palmgren(xr.Dataset({"tau_yz": shear}))
    >>> result.shear_amplitude.values.round(9).tolist(), result.shear_depth.values.round(9).tolist()
    ([1.0, 1.0], [0.5, 0.5])
    >>> round(float(result.risk / 0.5 ** (1 - 7 / 3)), 9)
    2.0
    """
    checks.instance("exponents", exponents, LifeExponents, "a LifeExponents")
    stress = require_in_si(stress, "tau_yz", argument="stress")
    rolling_dim = rolling_dimension(stress["tau_yz"])
    shear = stress["tau_yz"].compute()  # once for all subsets of the positions
    amplitude, max_amplitude, depth = _shear_maximum(shear)
    if ((max_amplitude > 0) & (depth <= 0)).any():
        hint = "Lundberg and Palmgren's theory excludes such friction; use Ioannides and Harris'"
        raise InvalidInputError("stress", "orthogonal shear largest on the surface", "largest below it", hint)
    depths, dim = positions(amplitude, "z"), dimension_along(amplitude, "z")
    y = positions(shear, "y")
    inner_shear = shear.where((y > y.min(rolling_dim)) & (y < y.max(rolling_dim)))
    inner_amplitude = 0.5 * (inner_shear.max(rolling_dim) - inner_shear.min(rolling_dim))
    at_border = ((amplitude == amplitude.max(dim)) & (inner_amplitude < amplitude)).any(dim)
    truncated_sections = {
        "orthogonal shear largest at the first or last depth": (depth <= depths.min(dim)) | (depth >= depths.max(dim)),
        "orthogonal shear largest at the first or last y": at_border,
    }
    density = _shear_risk(max_amplitude, depth, exponents)
    result = _integrate_risk(density, exponents, {"theory": "Lundberg and Palmgren"}, truncated_sections).assign(
        shear_amplitude=label_points("shear_amplitude", max_amplitude), shear_depth=label_points("shear_depth", depth)
    )

    def compute_risk(subset: xr.DataArray) -> xr.DataArray:
        return _sum_over_x(_shear_risk(*_shear_maximum(subset)[1:], exponents))

    error = _estimate_error(shear, result["risk"], compute_risk)
    comment = "from the distance of the positions alone: the result states no error of its pressure"
    if {"peak_pressure", "peak_pressure_error"} <= set(stress.variables):
        comment = "from the distance of the positions, and of the pressure"
        peak = stress["peak_pressure"]
        # At a singular end the stress is unbounded.
        ratio = (stress["peak_pressure_error"] / peak.where(np.isfinite(peak), 1.0)).where(np.isfinite(peak), np.inf)
        error = error + (result["risk"] * (exponents.stress * ratio)).reset_coords(drop=True)
    return _assign_error(result, error, comment)


def _shear_maximum(shear: xr.DataArray) -> tuple[xr.DataArray, xr.DataArray, xr.DataArray]:
    """Amplitude of the orthogonal shear, its maximum over the depth, and the depth of the maximum."""
    amplitude = measure(shear.to_dataset(name="tau_yz"), "orthogonal_shear_amplitude")
    dim, depths = _depth_positions(amplitude)
    max_amplitude, depth = reduce_dims(_find_maximum, [(amplitude, [dim]), (depths, [dim])], 2)
    return amplitude, max_amplitude, depth


def _shear_risk(peak: xr.DataArray, depth: xr.DataArray, exponents: LifeExponents) -> xr.DataArray:
    """Lundberg and Palmgren's density of the risk; zero in unloaded sections."""
    return (peak**exponents.stress * depth.where(depth > 0) ** (1 - exponents.depth)).where(peak != 0, 0.0)


def _truncated_fraction(excess: Array, depth: Array, exponents: LifeExponents) -> Array:
    """Fraction of a section's risk above the first depth (uniform excess) and below the last depth (exponential)."""
    last_index = np.maximum(np.isfinite(depth).sum(axis=-1, keepdims=True) - 1, 1)
    indices = np.concatenate([np.zeros_like(last_index), last_index - 1, last_index], axis=-1)
    first_excess, previous_excess, last_excess = np.moveaxis(np.take_along_axis(excess, indices, axis=-1), -1, 0)
    first_depth, previous_depth, last_depth = np.moveaxis(np.take_along_axis(depth, indices, axis=-1), -1, 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        decay = np.log(np.maximum(previous_excess / last_excess, 1.0))
        integral_below = np.where(last_excess > 0, last_excess * (last_depth - previous_depth) / decay, 0.0)
        # The mean depth changes by the same fraction as the integral and enters with the exponent `depth`.
        fraction = (1 + exponents.depth) * (first_excess * first_depth + integral_below) / _integrate(excess, depth)
    return np.where(np.isnan(fraction), 0.0, fraction)


def ioannides_harris(
    stress: xr.DataArray, limit: float = 0.0, exponents: LifeExponents = ROLLER_BEARINGS
) -> xr.Dataset:
    """Risk of fatigue after Ioannides and Harris: the excess over a fatigue limit, over the stressed volume.

    ``risk = integral of (sigma - sigma_u)**c / z'**h dx dz`` where the stress exceeds its limit, per length of the
    raceway. ``z'`` is the mean depth of the excess in each cross-section, weighted with the integrand's numerator.

    Parameters
    ----------
    stress : DataArray
        A measure of the passage along x and z, Pa, at three or more depths and two or more x: for example
        ``analysis.measure(result, "orthogonal_shear_amplitude")``, or ``dang_van(...).dang_van``.
    limit : float
        Limit ``sigma_u`` of the same measure, below which no point fails, Pa.
    exponents : LifeExponents
        Exponents; default: of roller bearings.

    Returns
    -------
    Dataset
        `risk_density`, `risk` and `risk_error` as of :func:`lundberg_palmgren`, and `mean_depth` (m) ``z'`` along x,
        NaN in sections below the limit. The error covers the distance of the positions along x and z, and the risk
        above the first and below the last depth, not the distance along y and the error of the pressure. The risk
        grows with about the 10th power of the stress: halve the distance along y to find its effect.

    Raises
    ------
    InvalidInputError
        If the measure is no DataArray along x and z, extends along y, or has too few positions; if it is
        largest at the last depth, or at a first one below the top, so that more than 1 % of the risk is cut off.

    Examples
    --------
    >>> z = xr.DataArray([0.0, 0.5, 1.0], dims="z")
    >>> stress = xr.DataArray([[0.0, 2.0, 0.0]] * 2, dims=("x", "z"), coords={"x": [0.0, 3.0], "z": z})
    >>> result = ioannides_harris(stress, limit=1.0, exponents=LifeExponents(stress=1, depth=1, weibull=1))
    >>> float(result.risk), result.mean_depth.values.tolist()
    (3.0, [0.5, 0.5])
    """
    checks.instance("exponents", exponents, LifeExponents, "a LifeExponents")
    checks.instance("stress", stress, xr.DataArray, "a DataArray along x and z")
    if stress.attrs.get("units") != "1":  # a utilisation is dimensionless
        stress = in_si("stress", stress, "Pa")
    threshold = checks.not_negative("limit", limit, "Pa")
    if "y" in axis_dimensions(stress):
        hint = "take the largest or the amplitude along y"
        raise InvalidInputError("stress.dims", stress.dims, "without the rolling direction", hint)
    stress = stress.compute()
    dim, depths = _depth_positions(stress)
    is_outer = (depths == depths.max(dim)) | ((depths == depths.min(dim)) & (depths > 0))
    sections = {"a measure largest at the first or last depth": stress.where(is_outer).max(dim) >= stress.max(dim)}

    def compute_risks(stress: Array, depth: Array) -> tuple[Array, ...]:
        """Return density of the risk, weighted mean depth of the excess, and truncated fraction of the risk."""
        excess = np.clip(stress - threshold, 0.0, None) ** exponents.stress
        volume, depth_moment = _integrate(excess, depth), _integrate(excess * depth, depth)
        with np.errstate(divide="ignore", invalid="ignore"):
            mean_depth = depth_moment / volume
            density = np.where(volume > 0, volume / mean_depth**exponents.depth, volume)
        fraction = _truncated_fraction(np.nan_to_num(excess), np.broadcast_to(depth, excess.shape), exponents)
        return density, mean_depth, fraction

    def compute_sections(field: xr.DataArray) -> tuple[xr.DataArray, ...]:
        dimension, depth_positions = _depth_positions(field)
        return reduce_dims(compute_risks, [(field, [dimension]), (depth_positions, [dimension])], 3)

    density, mean_depth, truncated_fraction = compute_sections(stress)
    theory: dict[str, str | float] = {"theory": "Ioannides and Harris", "fatigue_limit": threshold}
    result = _integrate_risk(density, exponents, theory, sections)
    if stress.attrs.get("units") == "1":
        for name in ("risk", "risk_density"):
            result[name].attrs["units"] = result[name].attrs["units"].split(maxsplit=1)[1]
    error = _estimate_error(stress, result["risk"], lambda field: _sum_over_x(compute_sections(field)[0]))
    error = error + _sum_over_x(density * truncated_fraction)
    comment = "of the positions along x and z alone, without the error of the positions along y and of the pressure"
    return _assign_error(result.assign(mean_depth=label_points("mean_depth", mean_depth)), error, comment)
