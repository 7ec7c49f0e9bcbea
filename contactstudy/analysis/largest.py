"""The largest value of a stress measure between the points where it was sampled, with its error.

The components of the stress are smooth, so polynomials through the points around the largest sample tell them in
between; the measure follows from them. What polynomials of a lower degree say tells the error of that.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from typing import NamedTuple

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.analysis.axes import axis_dimensions, positions, single_case
from contactstudy.analysis.measures import MEASURES, measure
from contactstudy.arrays.between import refined
from contactstudy.arrays.grid import ON_TOP
from contactstudy.arrays.peak_width import changes_within
from contactstudy.arrays.required import require
from contactstudy.arrays.variables import Variable, named, variable_of, without_error
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError

AROUND = 2
"""Points on either side of the largest sample that the polynomial goes through. Accuracy."""

SINGULAR = "the pressure is singular at an end, and so is the stress"

CLOSE = 0.5
"""Distance of points up to which polynomials follow the stresses, over the length on which the pressure above changes.
Accuracy: at 0.5 they miss up to 2 % more than they state, at 1 up to 8 %, at 1.5 up to 14 %."""

DOUBLED = 0.5
"""Part of the change from points twice as far apart that counts as error where the pressure is not known. Accuracy."""

POINTWISE = ("von_mises", "tresca", "maximum_shear", "hydrostatic")
"""Measures of the stress at one point."""


def largest(dataset: xr.Dataset, variable: str = "von_mises") -> xr.Dataset:
    """Largest value of a stress measure between the points where it is known, its error and its place.

    Parameters
    ----------
    dataset : Dataset
        A single case with the six stresses, from :func:`contactstudy.solve` or :func:`contactstudy.stress_field`.
    variable : {"von_mises", "tresca", "maximum_shear", "hydrostatic"}
        The measure.

    Returns
    -------
    Dataset
        ``peak_<variable>`` (Pa), its estimated error ``peak_<variable>_error``, and its place ``peak_<variable>_x``,
        ``_y``, ``_z`` in metres. A result of :func:`contactstudy.solve` has that of the von Mises stress already,
        wherever its points lie. The error has three parts: what polynomials of two degrees through the points differ
        by, the relative error of `peak_pressure` where that is settled, and on the top 2 %, what cells make of stresses
        there. It is infinite, with a `comment` that says why, where the largest sample lies at the edge of the points,
        beyond which the measure may be larger, where the points are too far apart for the pressure above them, or
        where the pressure is singular. Without `pressure` only the points are counted, and where they are as far apart
        as the stress changes the error is too small. Along an axis with one point the place is that point.

    Raises
    ------
    InvalidInputError
        If there is no such measure or a stress is missing, or there is more than one case.

    Examples
    --------
    >>> z = np.linspace(0.0, 2.0, 11)
    >>> stress = xr.Dataset({name: (("x", "y", "z"), np.zeros((1, 1, 11))) for name in MEASURES["von_mises"][0]},
    ...                     {"x": [0.0], "y": [0.0], "z": z})
    >>> stress["tau_yz"] = stress["tau_yz"] + xr.DataArray(z * np.exp(-z / 0.75), dims="z")
    >>> found = largest(stress, "maximum_shear")
    >>> round(float(found.peak_maximum_shear_z), 2), round(float(found.peak_maximum_shear), 4)
    (0.75, 0.2759)
    """
    checks.known_name("variable", variable, POINTWISE)
    names = list(MEASURES[variable][0])
    require(dataset, *names)
    one = single_case(dataset)
    if f"peak_{variable}_error" in one:
        return one[[name for name in one.data_vars if str(name).startswith(f"peak_{variable}")]].drop_attrs(deep=False)
    sampled = measure(one, variable)
    found = peak_between(one, names, sampled, lambda stresses: measure(stresses, variable))
    if "pressure" in one and found.place.get("z") == 0:
        # At the border of the contact a measure may have a kink, beside values that are much larger.
        more = found.value - float(sampled.max()) + ON_TOP * (float(abs(sampled).max()) - abs(found.value))
        found = found._replace(error=found.error + max(more, 0.0))
    base = variable_of(variable, measure(one, variable).attrs)
    return labelled_peak(variable, found, base)


class Peak(NamedTuple):
    """Largest value of a measure between the samples.

    Attributes
    ----------
    value, error : float
        The value and its estimated error, Pa.
    place : dict of str to float
        Where it is, by axis, metres.
    comment : str
        Why the error is infinite; empty if it is not.
    """

    value: float
    error: float
    place: dict[str, float]
    comment: str


def peak_between(
    one: xr.Dataset, names: list[str], sampled: xr.DataArray, evaluate: Callable[[xr.Dataset], xr.DataArray]
) -> Peak:
    """Largest value of a measure between the points where it is known.

    Parameters
    ----------
    one : Dataset
        A single case.
    names : list of str
        Stresses that the measure follows from; polynomials run through these.
    sampled : DataArray
        The measure on the samples. Dimensions of the stresses that it lacks are not interpolated.
    evaluate : callable
        From the stresses at other points to the measure there.

    Raises
    ------
    InvalidInputError
        If no sample is a number.

    Examples
    --------
    >>> x = np.linspace(-1.0, 1.2, 12)
    >>> bump = xr.Dataset({"height": ("x", 1 - x**2)}, {"x": x})
    >>> round(peak_between(bump, ["height"], bump.height, lambda data: data.height).value, 3)
    1.0
    """
    over = axis_dimensions(sampled)
    if np.isnan(sampled.values).all():
        raise InvalidInputError(str(sampled.name), "nan everywhere", "a field with at least one number")
    field = sampled.transpose(*over.values())
    at = np.unravel_index(int(np.nanargmax(field.values)), field.shape)
    places = {axis: np.asarray(positions(field, axis).values, dtype=np.float64) for axis in over}
    wide, narrow = (_between(one[names], evaluate, over, places, at, around) for around in (AROUND, 1))
    value, place = wide
    error = abs(value - narrow[0])
    comment = _without_limit(one, places, at)
    if comment:
        error = np.inf
    else:
        if "pressure" not in one:
            # Nothing else says whether the points are close enough.
            doubled, _ = _between(one[names], evaluate, over, places, at, AROUND, every=2)
            error = max(error, DOUBLED * abs(value - doubled))
        if "peak_pressure_error" in one:
            error += abs(value) * float(one["peak_pressure_error"] / one["peak_pressure"])
    found = dict(zip(over, place, strict=True))
    if "pressure" in one and found.get("z") == 0:
        error += ON_TOP * abs(value)
    return Peak(value, error, found, comment)


def labelled_peak(variable: str, found: Peak, base: Variable) -> xr.Dataset:
    """Peak of a measure as a Dataset, see :func:`largest`."""
    values = {f"peak_{variable}": found.value, f"peak_{variable}_error": found.error}
    values |= {f"peak_{variable}_{axis}": position for axis, position in found.place.items()}
    # The error's rule is that of any variable: it is told what the peak is.
    peak = variable_of(f"peak_{variable}", {"units": base.units, "long_name": f"largest {base.long_name}"})
    result = xr.Dataset(
        {
            name: named(name, xr.DataArray(number), peak if name.endswith("_error") else base)
            for name, number in values.items()
        }
    )
    if found.comment:
        result[f"peak_{variable}_error"].attrs["comment"] = found.comment
    return result


def settled_peak(result: xr.Dataset, value: float, error: float, place: tuple[float, float, float]) -> xr.Dataset:
    """Largest von Mises stress in the body as a Dataset, see :func:`largest`.

    Parameters
    ----------
    result : Dataset
        A case with `von_mises`, and `peak_pressure` with its error as far as they are known.
    value, error : float
        Largest stress under the pressure of its cells, and the error of that, Pa.
    place : tuple of float
        x, y and z, metres.
    """
    singular = "peak_pressure" in result and np.isinf(float(result["peak_pressure"]))
    if singular:
        found = Peak(np.inf, np.inf, dict.fromkeys("xyz", np.nan), SINGULAR)
    elif "peak_pressure_error" in result:
        of_pressure = float(result["peak_pressure_error"] / result["peak_pressure"])
        found = Peak(value, error + value * of_pressure, dict(zip("xyz", place, strict=True)), "")
    else:
        found = Peak(value, np.nan, dict(zip("xyz", place, strict=True)), "the error of the given cells is not known")
    labelled = labelled_peak("von_mises", found, variable_of("von_mises", result["von_mises"].attrs))
    return without_error(labelled, *(f"peak_von_mises_{axis}" for axis in "xyz"))


def _without_limit(one: xr.Dataset, places: dict[str, FloatArray], at: tuple[np.intp, ...]) -> str:
    """Why the largest sample says little about the largest value; empty if it does."""
    if "peak_pressure" in one and np.isinf(float(one["peak_pressure"])):
        return SINGULAR
    extent = _extent(one)
    for (axis, place), index in zip(places.items(), at, strict=True):
        on_body = axis == "z" and place[0] == 0 and index == 0
        if axis == "x":
            on_body = any(np.isclose(place[index], end, rtol=0, atol=1e-9 * np.ptp(place)) for end in extent)
        if place.size > 1 and index in (0, place.size - 1) and not on_body:
            return f"the largest sample lies at the edge of the points along {axis}"
    return _too_far_apart(
        one, places, {axis: float(places[axis][index]) for axis, index in zip(places, at, strict=True)}
    )


def _too_far_apart(one: xr.Dataset, places: dict[str, FloatArray], largest_at: dict[str, float]) -> str:
    """Say where points miss what the pressure does, below its highest peak or about the largest sample; else empty."""
    if not {"pressure", "x", "y"} <= {str(name) for name in one.variables} or one["y"].size < 2:
        return ""
    pressure, x = one["pressure"].transpose("x", "y").values, one["x"].values
    dy = float(one["y"][1] - one["y"][0])
    line = pressure.max(axis=1)
    seen = (x >= places["x"][0]) & (x <= places["x"][-1]) if "x" in places else np.ones(x.size, bool)
    if not line[seen].any():
        return ""
    peak = int(np.where(seen, line, -1.0).argmax())
    width = min(changes_within(pressure, x, dy, peak))
    wanted = [(peak, {"x": float(x[peak])})]
    # On the flank of that peak stresses change as they do below it.
    if "x" in largest_at and abs(largest_at["x"] - x[peak]) > 2 * width:
        wanted.append((int(np.abs(x - largest_at["x"]).argmin()), largest_at))
    for column, where in wanted:
        along, across = changes_within(pressure, x, dy, column)
        # Near to a free end the stresses change along x even where the pressure does not.
        from_end = min((abs(float(x[column]) - end) for end in _extent(one)), default=np.inf)
        scales = {"x": min(along, max(across, from_end)), "z": min(along, across)}
        for axis, scale in scales.items():
            apart = _apart(places[axis], where.get(axis, 0.5 * scale)) if axis in places else 0.0
            if apart > CLOSE * scale:
                return (
                    f"the points are {apart:.2g} m apart along {axis} where the pressure changes within {scale:.2g} m: "
                    f"take at most {CLOSE * scale:.2g} m"
                )
    return ""


def _apart(points: FloatArray, at: float) -> float:
    """Longest of the distances on either side of the point nearest to a position; 0 of a single point."""
    if points.size < 2:
        return 0.0
    nearest = int(np.abs(points - at).argmin())
    return float(np.diff(points)[max(nearest - 1, 0) : nearest + 1].max())


def _extent(one: xr.Dataset) -> tuple[float, ...]:
    """Return the ends of the cells along x, which are those of a body with ends; none if there are no cells."""
    if "x_bounds" not in one.coords:
        return ()
    bounds = one["x_bounds"].values
    return float(bounds.min()), float(bounds.max())


def _between(
    stresses: xr.Dataset,
    evaluate: Callable[[xr.Dataset], xr.DataArray],
    over: dict[str, str],
    places: dict[str, FloatArray],
    at: tuple[np.intp, ...],
    around: int,
    every: int = 1,
) -> tuple[float, list[float]]:
    """Largest value, and its place, of polynomials about the largest sample, with every point or `every` second."""
    window, fine, matrices = {}, [], []
    for (axis, dim), index in zip(over.items(), at, strict=True):
        numbers = np.arange(places[axis].size)[int(index) % every :: every]
        near = refined(places[axis][numbers], int(index) // every, around)
        window[dim] = numbers[near.window]
        fine.append(near.points)
        matrices.append(near.matrix)
    inside = stresses.isel(window)
    interpolated: dict[Hashable, tuple[tuple[Hashable, ...], FloatArray]] = {}
    coordinates: dict[Hashable, xr.DataArray] = {}
    for name, component in inside.items():
        ordered = component.transpose(*over.values(), ...)
        values = ordered.values
        for number, matrix in enumerate(matrices):
            values = np.moveaxis(np.tensordot(matrix, values, axes=(1, number)), 0, number)
        interpolated[name] = (ordered.dims, values)
        coordinates |= {dim: ordered[dim] for dim in ordered.dims if dim not in over.values() and dim in ordered.coords}
    found = evaluate(xr.Dataset(interpolated, coordinates)).transpose(*over.values()).values
    best = np.unravel_index(int(np.nanargmax(found)), found.shape)
    return float(found[best]), [float(points[index]) for points, index in zip(fine, best, strict=True)]
