"""Risk of fatigue after Lundberg and Palmgren, and after Ioannides and Harris, integrated over the stressed volume.

Sources: G. Lundberg, A. Palmgren, Dynamic capacity of rolling bearings, Acta Polytechnica, Mechanical Engineering
Series 1 (1947) no. 3, and Dynamic capacity of roller bearings, ibid. 2 (1952) no. 4; E. Ioannides, T. A. Harris, A new
fatigue life model for rolling bearings, Journal of Tribology 107 (1985) 367-378.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TypeVar

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.analysis import dimension_along, measure, positions
from contactstudy.analysis.axes import axis_dimensions
from contactstudy.analysis.reduced import reduced
from contactstudy.arrays.units import in_si, required_in_si
from contactstudy.arrays.variables import named
from contactstudy.checks import Array, IntArray
from contactstudy.errors import InvalidInputError
from contactstudy.fatigue.history import of_points
from contactstudy.fatigue.life import LifeExponents

CUT_OFF = 0.01
"""Part of the risk from sections whose history or depths are cut off, above which there is no result. Accuracy."""

FEWEST = 3
"""Positions along each axis from which half of them can tell an error; along x two make a risk."""

Given = TypeVar("Given", xr.Dataset, xr.DataArray)
"""What a risk is taken from."""

ALONG_X_AND_Z = (
    "of the positions along x and z alone: not of those along y, over which the measure is taken, or the pressure"
)
POSITIONS_ALONE = "from the distance of the positions alone: the result states no error of its pressure"


def _depths(stress: xr.DataArray) -> tuple[str, xr.DataArray]:
    """Dimension and positions along the depth, NaN where padded."""
    dim = dimension_along(stress, "z")
    if stress.sizes[dim] < 3:
        raise InvalidInputError("stress", dict(stress.sizes), "given at three or more depths")
    return dim, positions(stress, "z")


def _crest(stress: Array, depth: Array) -> tuple[Array, Array]:
    """Largest stress over the depth and where it is, by a parabola through the three points around it."""
    depth = np.broadcast_to(depth, stress.shape)
    filled = np.where(np.isnan(stress), -np.inf, stress)
    at = filled.argmax(axis=-1)

    def take(values: Array, step: int) -> Array:
        column = np.clip(at + step, 0, values.shape[-1] - 1)[..., None]
        return np.asarray(np.take_along_axis(values, column, axis=-1)[..., 0])

    (z1, z2, z3), (s1, s2, s3) = ([take(values, step) for step in (-1, 0, 1)] for values in (depth, filled))
    with np.errstate(divide="ignore", invalid="ignore"):
        left, right = (s2 - s1) / (z2 - z1), (s3 - s2) / (z3 - z2)
        curvature = (right - left) / (z3 - z1)
        top = 0.5 * (z1 + z2) - left / (2 * curvature)
        crest = s2 + (top - z2) * (left + curvature * (top - z1))
    inside = np.isfinite(crest) & (curvature < 0)
    known = np.isfinite(s2)
    return np.where(known, np.where(inside, crest, s2), np.nan), np.where(known, np.where(inside, top, z2), np.nan)


def _integral(density: Array, place: Array) -> Array:
    """Trapezoidal integral along the last axis; padded positions count nothing."""
    place = np.broadcast_to(place, density.shape)
    absent = np.isnan(density) | np.isnan(place)
    pieces = 0.5 * (density[..., 1:] + density[..., :-1]) * np.abs(np.diff(place, axis=-1))
    total = np.where(absent[..., 1:] | absent[..., :-1], 0.0, pieces).sum(axis=-1)
    return np.asarray(np.where(absent.all(axis=-1), np.nan, total))


def _along_axis(
    density: xr.DataArray, exponents: LifeExponents, theory: dict[str, str | float], cut: dict[str, xr.DataArray]
) -> xr.Dataset:
    """Risk along x, and integrated over x; `cut` says of sections what of their stress is cut off."""
    x = dimension_along(density, "x")
    if density.sizes[x] < 2:
        raise InvalidInputError("stress", dict(density.sizes), "given at two or more positions along x")
    density = density.compute()
    if (positions(density, "x").diff(x) <= 0).any():
        raise InvalidInputError("x", positions(density, "x").values, "increasing positions")
    risk = _over_x(density)
    for what, where in cut.items():
        part = _over_x(density.where(where, 0.0)) / risk.where(risk > 0)
        if (part > CUT_OFF).any():
            raise InvalidInputError(
                "stress",
                f"{what} in sections with {float(part.max()):.2g} of the risk",
                f"largest inside; at most {CUT_OFF:g} of the risk may be cut off",
                "solve with y over the whole passage, for example from -3 to 3 half-widths, and z from 0 to 2",
            )
    return xr.Dataset(
        {
            "risk_density": of_points("risk_density", density).assign_attrs(units=exponents.units(1)),
            "risk": named("risk", risk).assign_attrs(units=exponents.units(2), **theory),
        }
    )


def _over_x(density: xr.DataArray) -> xr.DataArray:
    """Integral of a density over x."""
    x = dimension_along(density, "x")
    pair = density, positions(density, "x")
    risk: xr.DataArray = xr.apply_ufunc(_integral, *pair, input_core_dims=[[x], [x]], dask="allowed")
    return risk.reset_coords(drop=True)


def _halves(size: int, axis: str) -> list[IntArray]:
    """Every second position; along x, over which is integrated, with the last one, and else of both kinds."""
    if axis == "x":
        return [np.unique(np.append(np.arange(0, size, 2), size - 1))]
    return [np.arange(start, size, 2) for start in (0, 1)]


def _error(given: Given, of: xr.DataArray, risk: xr.DataArray, risk_of: Callable[[Given], xr.DataArray]) -> Array:
    """Sum over the axes of what every second position would change; infinite where they are too few to tell."""
    error = np.zeros(risk.shape)
    for axis, dim in axis_dimensions(of).items():
        parts = _halves(of.sizes[dim], axis)
        if any(part.size < FEWEST for part in parts):
            return np.full(risk.shape, np.inf)
        changes = [np.abs(risk_of(given.isel({dim: part})).values - risk.values) for part in parts]
        error += np.maximum.reduce(changes)
    return error


def _with_error(
    result: xr.Dataset, error: Array, pressure: xr.DataArray | None = None, comment: str = POSITIONS_ALONE
) -> xr.Dataset:
    """Return a result with the error of its risk: of the positions, and of the pressure if that is known."""
    risk = result["risk"]
    stated = risk.copy(data=error)
    if pressure is not None:
        comment = "from the distance of the positions, and of the pressure"
        stated = stated + (risk * pressure).reset_coords(drop=True)
    stated = named("risk_error", stated.where(risk != 0, 0.0))
    return result.assign(risk_error=stated.assign_attrs(units=risk.attrs["units"], comment=comment))


def lundberg_palmgren(stress: xr.Dataset, exponents: LifeExponents | None = None) -> xr.Dataset:
    """Risk of fatigue after Lundberg and Palmgren, section by section along the roller.

    Each cross-section contributes ``tau_0**c z_0**(1 - h) dx``: its largest amplitude of the orthogonal shear, the
    depth where that is, and a volume as deep as that depth, per length of the raceway.

    Parameters
    ----------
    stress : Dataset
        `tau_yz` with the rolling direction y over the whole passage, at three or more depths and two or more x.
    exponents : LifeExponents, optional
        Default: those of roller bearings.

    Returns
    -------
    Dataset
        `risk_density` (along x), `risk` (its integral over x, to be compared by :func:`relative_life`) and
        `risk_error`, `shear_amplitude` (Pa) ``tau_0`` and `shear_depth` (m) ``z_0`` along x.

    Raises
    ------
    InvalidInputError
        If `tau_yz` or an axis is missing, there are too few positions, or the exponents are none; if the shear is
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
    chosen = LifeExponents() if exponents is None else exponents
    checks.instance("exponents", chosen, LifeExponents, "a LifeExponents")
    stress = required_in_si(stress, "tau_yz", argument="stress")
    stress = stress.assign(tau_yz=stress["tau_yz"].compute())  # once, not for every part of the positions
    amplitude, crest, at = _shear(stress)
    if ((crest > 0) & (at <= 0)).any():
        raise InvalidInputError(
            "stress",
            "orthogonal shear largest on the surface",
            "largest below it",
            "Lundberg and Palmgren's theory is not for such friction; Ioannides and Harris' is",
        )
    depths, dim = positions(amplitude, "z"), dimension_along(amplitude, "z")
    outside = (at <= depths.min(dim)) | (at >= depths.max(dim))
    cut = {"orthogonal shear largest at the first or last depth": outside, **_outside(stress, amplitude)}
    result = _along_axis(_of_shear(crest, at, chosen), chosen, {"theory": "Lundberg and Palmgren"}, cut).assign(
        shear_amplitude=of_points("shear_amplitude", crest.compute()),
        shear_depth=of_points("shear_depth", at.compute()),
    )

    def risk_of(part: xr.Dataset) -> xr.DataArray:
        return _over_x(_of_shear(*_shear(part)[1:], chosen).compute())

    return _with_error(
        result, _error(stress[["tau_yz"]], stress["tau_yz"], result["risk"], risk_of), _pressure(stress, chosen)
    )


def _shear(stress: xr.Dataset) -> tuple[xr.DataArray, xr.DataArray, xr.DataArray]:
    """Amplitude of the orthogonal shear, its largest over the depth, and where that is."""
    amplitude = measure(stress, "orthogonal_shear_amplitude")
    dim, depths = _depths(amplitude)
    crest, at = reduced(_crest, [(amplitude, [dim]), (depths, [dim])], 2)
    return amplitude, crest, at


def _of_shear(crest: xr.DataArray, at: xr.DataArray, exponents: LifeExponents) -> xr.DataArray:
    """Lundberg and Palmgren's density of the risk: none where nothing is loaded, wherever its largest may be."""
    return (crest**exponents.stress * at.where(at > 0) ** (1 - exponents.depth)).where(crest != 0, 0.0)


def _pressure(stress: xr.Dataset, exponents: LifeExponents) -> xr.DataArray | None:
    """Relative error of a risk from that of the largest pressure, where a result states it."""
    if not {"peak_pressure", "peak_pressure_error"} <= set(stress.variables):
        return None
    peak, error = stress["peak_pressure"], stress["peak_pressure_error"]
    # At a singular end the stress has no limit.
    return exponents.stress * (error / peak.where(np.isfinite(peak), 1.0)).where(np.isfinite(peak), np.inf)


def _outside(stress: xr.Dataset, amplitude: xr.DataArray) -> dict[str, xr.DataArray]:
    """Sections whose largest shear amplitude is that of the first or the last position along y."""
    shear = stress["tau_yz"]
    rolling, depth = dimension_along(shear, "y"), dimension_along(shear, "z")
    border = positions(shear, "y")
    at_border = (border == border.min(rolling)) | (border == border.max(rolling))
    inside = shear.where(~at_border)
    held = 0.5 * (inside.max(rolling) - inside.min(rolling))
    crest = amplitude == amplitude.max(depth)
    return {"orthogonal shear largest at the first or last y": (crest & (held < amplitude)).any(depth)}


def _risk_of_sections(stress: Array, depth: Array, limit: float, exponents: LifeExponents) -> tuple[Array, Array]:
    """Integral over the depth of what exceeds the limit, over the stress-weighted mean depth."""
    excess = np.clip(stress - limit, 0.0, None) ** exponents.stress
    volume, moment = _integral(excess, depth), _integral(excess * depth, depth)
    with np.errstate(divide="ignore", invalid="ignore"):
        mean = moment / volume
        density = np.where(volume > 0, volume / mean**exponents.depth, volume)
    return density, mean


def _beyond(stress: Array, depth: Array, limit: float, exponents: LifeExponents) -> tuple[Array, Array]:
    """Part of a section's risk above the first depth, as if uniform, and below the last one, as if it fell on so."""
    excess = np.nan_to_num(np.clip(stress - limit, 0.0, None) ** exponents.stress)
    depth = np.broadcast_to(depth, excess.shape)
    last = np.maximum(np.isfinite(depth).sum(axis=-1, keepdims=True) - 1, 1)

    def at(values: Array, place: IntArray) -> Array:
        return np.asarray(np.take_along_axis(values, place, axis=-1)[..., 0])

    ends = [(at(excess, place), at(depth, place)) for place in (np.zeros_like(last), last - 1, last)]
    (head, first), (before, above), (tail, below) = ends
    with np.errstate(divide="ignore", invalid="ignore"):
        below_last = np.where(tail > 0, tail * (below - above) / np.log(np.maximum(before / tail, 1.0)), 0.0)
        # The mean depth moves as well, by a part as large.
        part = (1 + exponents.depth) * (head * first + below_last) / _integral(excess, depth)
    return np.where(np.isnan(part), 0.0, part), np.zeros(part.shape)


def ioannides_harris(stress: xr.DataArray, limit: float = 0.0, exponents: LifeExponents | None = None) -> xr.Dataset:
    """Risk of fatigue after Ioannides and Harris: what exceeds a fatigue limit, over the stressed volume.

    ``risk = integral of (sigma - sigma_u)**c / z'**h dx dz`` where the stress exceeds its limit, per length of the
    raceway. ``z'`` is the mean depth of that in each cross-section, weighted with the integrand's numerator.

    Parameters
    ----------
    stress : DataArray
        A measure of the passage along x and z, Pa, at three or more depths and two or more x: for example
        ``analysis.measure(result, "orthogonal_shear_amplitude")``, ``dang_van(...).dang_van``, or the largest von Mises
        stress along y.
    limit : float
        ``sigma_u`` below which nothing fails, of the same measure, Pa.
    exponents : LifeExponents, optional
        Default: those of roller bearings.

    Returns
    -------
    Dataset
        `risk_density` (along x), `risk` (its integral over x, to be compared by :func:`relative_life`) and
        `risk_error`, and `mean_depth` (m) ``z'`` along x, NaN where nothing exceeds the limit. The error counts the
        positions along x and z, and what lies above the first and below the last depth; not the positions along y, over
        which the measure was taken, nor the pressure. Halve the distance along y to see what it changes: the risk grows
        with the stress to the power of some 10.

    Raises
    ------
    InvalidInputError
        If the measure is no DataArray along x and z, still extends along y, or there are too few positions; if it is
        largest at the last depth, or at a first one below the top, so that more than 1 % of the risk is cut off.

    Examples
    --------
    >>> z = xr.DataArray([0.0, 0.5, 1.0], dims="z")
    >>> stress = xr.DataArray([[0.0, 2.0, 0.0]] * 2, dims=("x", "z"), coords={"x": [0.0, 3.0], "z": z})
    >>> result = ioannides_harris(stress, limit=1.0, exponents=LifeExponents(stress=1, depth=1, weibull=1))
    >>> float(result.risk), result.mean_depth.values.tolist()
    (3.0, [0.5, 0.5])
    """
    chosen = LifeExponents() if exponents is None else exponents
    checks.instance("exponents", chosen, LifeExponents, "a LifeExponents")
    checks.instance("stress", stress, xr.DataArray, "a DataArray along x and z")
    if stress.attrs.get("units") != "1":  # a utilisation has none
        stress = in_si("stress", stress, "Pa")
    threshold = checks.not_negative("limit", limit, "Pa")
    if any(str(dim) == "y" or str(dim).startswith("y_") for dim in stress.dims):
        raise InvalidInputError(
            "stress.dims", stress.dims, "without the rolling direction", "take the largest or the amplitude along y"
        )
    theory: dict[str, str | float] = {"theory": "Ioannides and Harris", "fatigue_limit": threshold}
    stress = stress.compute()
    dim, depths = _depths(stress)
    outer = (depths == depths.max(dim)) | ((depths == depths.min(dim)) & (depths > 0))
    outside = stress.where(outer).max(dim) >= stress.max(dim)

    def sections(part: xr.DataArray) -> tuple[xr.DataArray, ...]:
        along, places = _depths(part)
        of = partial(_risk_of_sections, limit=threshold, exponents=chosen)
        return reduced(of, [(part, [along]), (places, [along])], 2)

    density, mean = sections(stress)
    result = _along_axis(density, chosen, theory, {"a measure largest at the first or last depth": outside})
    if stress.attrs.get("units") == "1":
        for name in ("risk", "risk_density"):
            result[name].attrs["units"] = result[name].attrs["units"].split(maxsplit=1)[1]
    error = _error(stress, stress, result["risk"], lambda part: _over_x(sections(part)[0]))
    of = partial(_beyond, limit=threshold, exponents=chosen)
    beyond, _ = reduced(of, [(stress, [dim]), (depths, [dim])], 2)
    error = error + _over_x(density * beyond).values
    return _with_error(result.assign(mean_depth=of_points("mean_depth", mean)), error, comment=ALONG_X_AND_Z)
