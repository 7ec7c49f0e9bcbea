"""Stress measures and their largest values: at the samples, or between samples with an estimated error."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from functools import partial
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.analysis.axes import axis_dimensions, positions, single_case, without_coordinates
from contactstudy.arrays.grid import TOP_ERROR
from contactstudy.arrays.peaks import interpolate_about, variation_lengths
from contactstudy.arrays.variables import (
    STRESSES,
    Variable,
    name_array,
    require,
    require_in_si,
    variable_of,
    without_error,
)
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.stress import (
    hydrostatic,
    maximum_shear,
    orthogonal_shear_range,
    principal_stresses,
    tresca,
    von_mises,
)

NEIGHBOURS = 2  # Samples on either side of the largest one in the polynomial
# Largest distance of samples over the length on which the pressure above varies. Accuracy: the error exceeds the stated
# error by up to 2 % of the value at a ratio of 0.5, 8 % at 1, 14 % at 1.5
MAX_SPACING_RATIO = 0.5
SINGULAR = "the pressure is singular, and so is the stress"

Measure = Callable[[xr.Dataset], xr.DataArray]


def _principal_stress(stress: xr.Dataset, rank: int) -> xr.DataArray:
    """Principal stress of a rank, 1 the largest, Pa."""
    principal = principal_stresses(stress)["principal_stress"].sel(principal=rank, drop=True)
    return name_array(f"principal_stress_{rank}", principal)


# Measures of the stress at a point: components and function
POINTWISE: dict[str, tuple[tuple[str, ...], Measure]] = {
    "von_mises": (STRESSES, von_mises),
    "tresca": (STRESSES, tresca),
    "maximum_shear": (STRESSES, maximum_shear),
    "hydrostatic": (STRESSES[:3], hydrostatic),
    **{f"principal_stress_{rank}": (STRESSES, partial(_principal_stress, rank=rank)) for rank in (1, 2, 3)},
}
MEASURES: dict[str, tuple[tuple[str, ...], Measure]] = POINTWISE | {  # All measures: at a point, and of a rolling cycle
    name: (("tau_yz",), lambda stress, name=name: orthogonal_shear_range(stress)[name])
    for name in ("orthogonal_shear_range", "orthogonal_shear_amplitude")
}


def measure(dataset: xr.Dataset, name: str) -> xr.DataArray:
    """Return a variable of a result, or compute a stress measure from its components.

    Parameters
    ----------
    dataset : Dataset
        A result of :func:`contactstudy.solve` or of :func:`contactstudy.open_study`.
    name : str
        A variable of the Dataset; or `von_mises`, `tresca`, `maximum_shear`, `hydrostatic`, `principal_stress_1`
        (largest tension) to `principal_stress_3`, `orthogonal_shear_range`, `orthogonal_shear_amplitude`.

    Returns
    -------
    DataArray
        NaN in the padding of a study.

    Raises
    ------
    InvalidInputError
        If no variable and no measure has this name, or a component is missing.

    Examples
    --------
    >>> shear = xr.Dataset({name: ("z", [0.0]) for name in STRESSES} | {"tau_xy": ("z", [2.0])}, {"z": [0.0]})
    >>> measure(shear, "maximum_shear").values.round(6).tolist()
    [2.0]
    """
    require(dataset)
    checks.instance("variable", name, str, "a name")
    if name in dataset.data_vars:
        return dataset[name]
    checks.known_name("variable", name, {*map(str, dataset.data_vars), *MEASURES})
    components, function = MEASURES[name]
    stress = require_in_si(dataset, *components, normalized=True)[list(components)]
    is_missing = stress[components[0]].isnull().compute()
    if is_missing.all():
        raise InvalidInputError(name, "nan everywhere", "a field with at least one number")
    value = function(stress.fillna(0.0))
    is_padding = is_missing.all([dim for dim in is_missing.dims if dim not in value.dims])
    return value.where(~is_padding).assign_attrs(value.attrs)


def largest_sample(dataset: xr.Dataset, variable: str = "von_mises", *, along: str | None = None) -> xr.Dataset:
    """Return the largest sample of a variable and its position; with `along` in each cross-section.

    Parameters
    ----------
    dataset : Dataset
        A result of :func:`contactstudy.solve`, or of :func:`contactstudy.open_study`.
    variable : str
        A variable or a measure, see :func:`measure`: `pressure`, `von_mises`, `principal_stress_1` ...
    along : {"x", "y", "z"}, optional
        Axis of the result: the largest value in each section perpendicular to this axis. Default: one value.

    Returns
    -------
    Dataset
        ``largest_<variable>`` and its position ``largest_<variable>_x``, ``_y``, ``_z`` in metres, for the axes of the
        variable without `along`; along the parameters of a study too. NaN for cases without the variable.

    Raises
    ------
    InvalidInputError
        If no variable and no measure has this name, or it does not extend along the axes.

    Examples
    --------
    >>> stress = xr.DataArray([[1.0, 4.0], [3.0, 2.0]], dims=("x", "z"), coords={"x": [0, 1], "z": [0, 2]})
    >>> float(largest_sample(xr.Dataset({"tresca": stress}), "tresca").largest_tresca_z)
    2.0
    """
    array = measure(dataset, variable)
    axes = axis_dimensions(array)
    if along is not None:
        checks.known_name("along", along, ("x", "y", "z"))
        if along not in axes or len(axes) < 2:
            raise InvalidInputError("variable", variable, f"a field along {along} and another axis")
        del axes[along]
    if not axes:
        raise InvalidInputError("variable", variable, "a field along x, y or z")
    points = {axis: without_coordinates(positions(array, axis), dim) for axis, dim in axes.items()}
    array = without_coordinates(array, *axes.values())
    index = {dim: i.compute() for dim, i in array.fillna(-np.inf).argmax(list(axes.values())).items()}
    largest = array.isel(index)
    values = {f"largest_{variable}": largest} | {
        f"largest_{variable}_{axis}": points[axis].isel({dim: index[dim]}).where(largest.notnull())
        for axis, dim in axes.items()
    }
    specification = variable_of(variable, array.attrs)
    result = xr.Dataset({name: name_array(name, value, specification) for name, value in values.items()}).compute()
    result[f"largest_{variable}"].attrs["comment"] = "largest sample; unbounded near a singular end"
    return without_error(result, *values)


class Peak(NamedTuple):
    """Largest value of a measure."""

    value: float  # Pa
    error: float  # Pa, estimated
    position: dict[str, float]  # m, by axis
    comment: str = ""  # reason of an infinite or missing error


def peak(dataset: xr.Dataset, variable: str = "von_mises") -> xr.Dataset:
    """Return the largest value of a stress measure, its estimated error and its position.

    Parameters
    ----------
    dataset : Dataset
        A single case with the six stresses, from :func:`contactstudy.solve` or :func:`contactstudy.stress_field`.
    variable : str
        A measure of the stress at a point, see :func:`measure`.

    Returns
    -------
    Dataset
        ``peak_<variable>`` (Pa), its estimated error ``peak_<variable>_error``, and its position
        ``peak_<variable>_x``, ``_y``, ``_z`` in metres. For the von Mises stress of a result of
        :func:`contactstudy.solve` the largest in the body, independent of the samples; otherwise the largest between
        the samples. The error contains the difference of polynomials of two degrees, the relative error of
        `peak_pressure`, and on the top 2 % for the cells. It is infinite, with the reason in `comment`, if the largest
        sample lies at the edge of the samples, if these do not resolve the pressure above, or if the pressure is
        singular. Without `pressure` the error assumes that the samples resolve the stress.

    Raises
    ------
    InvalidInputError
        If no measure has this name, a stress is missing, or the Dataset contains more than one case.

    Examples
    --------
    >>> z = np.linspace(0.0, 2.0, 11)
    >>> stress = xr.Dataset({name: (("x", "y", "z"), np.zeros((1, 1, 11))) for name in STRESSES},
    ...                     {"x": [0.0], "y": [0.0], "z": z})
    >>> stress["tau_yz"] = stress["tau_yz"] + xr.DataArray(z * np.exp(-z / 0.75), dims="z")
    >>> shear = peak(stress, "maximum_shear")
    >>> round(float(shear.peak_maximum_shear_z), 2), round(float(shear.peak_maximum_shear), 4)
    (0.75, 0.2759)
    """
    checks.known_name("variable", variable, POINTWISE)
    components = list(POINTWISE[variable][0])
    require(dataset, *components)
    case = single_case(dataset)
    if f"peak_{variable}_error" in case:
        return case[[name for name in case.data_vars if str(name).startswith(f"peak_{variable}")]].drop_attrs(
            deep=False
        )
    samples = measure(case, variable)
    result = interpolated_peak(case, components, samples, lambda stresses: measure(stresses, variable))
    if "pressure" in case and result.position.get("z") == 0:
        # At the border of the contact a measure may have a kink, and nearby values may be much larger.
        excess = result.value - float(samples.max()) + TOP_ERROR * (float(abs(samples).max()) - abs(result.value))
        result = result._replace(error=result.error + max(excess, 0.0))
    return label_peak(variable, result, variable_of(variable, samples.attrs))


def interpolated_peak(case: xr.Dataset, components: list[str], samples: xr.DataArray, evaluate: Measure) -> Peak:
    """Return the largest value of a measure between its samples; only dimensions of the samples are interpolated."""
    dims = axis_dimensions(samples)
    if np.isnan(samples.values).all():
        raise InvalidInputError(str(samples.name), "nan everywhere", "a field with at least one number")
    field = samples.transpose(*dims.values())
    index = tuple(int(i) for i in np.unravel_index(int(np.nanargmax(field.values)), field.shape))
    axes = {axis: np.asarray(positions(field, axis).values, dtype=np.float64) for axis in dims}

    def find_maximum(neighbours: int, stride: int = 1) -> tuple[float, list[float]]:
        """Largest value, interpolated between samples or between every `stride`-th sample, and its position."""
        indices = [np.arange(axis.size)[i % stride :: stride] for axis, i in zip(axes.values(), index, strict=True)]
        nodes = [axis[axis_indices] for axis, axis_indices in zip(axes.values(), indices, strict=True)]
        nearby = case[components].isel(dict(zip(dims.values(), indices, strict=True))).transpose(*dims.values(), ...)
        interpolated_fields: dict[Hashable, Any] = {}
        coordinates: dict[Hashable, xr.DataArray] = {}
        for name, component in nearby.items():
            centre = [i // stride for i in index]
            points, stresses = interpolate_about(nodes, centre, component.values[None], neighbours)
            interpolated_fields[name] = (component.dims, stresses[0])
            coordinates |= {dim: component[dim] for dim in component.dims[len(dims) :] if dim in component.coords}
        values = evaluate(xr.Dataset(interpolated_fields, coordinates)).transpose(*dims.values()).values
        largest_index = np.unravel_index(int(np.nanargmax(values)), values.shape)
        return float(values[largest_index]), [float(axis[i]) for axis, i in zip(points, largest_index, strict=True)]

    value, position = find_maximum(NEIGHBOURS)
    error = abs(value - find_maximum(1)[0])
    comment = _explain_unbounded(case, axes, index)
    if comment:
        error = np.inf
    else:
        if "pressure" not in case:
            # Without a pressure the error is at least half of the change from samples twice as far apart.
            error = max(error, 0.5 * abs(value - find_maximum(NEIGHBOURS, stride=2)[0]))
        if "peak_pressure_error" in case:
            error += abs(value) * float(case["peak_pressure_error"] / case["peak_pressure"])
    peak_position = dict(zip(dims, position, strict=True))
    if "pressure" in case and peak_position.get("z") == 0:
        error += TOP_ERROR * abs(value)
    return Peak(value, error, peak_position, comment)


def label_peak(variable: str, peak: Peak, base: Variable) -> xr.Dataset:
    """Return a peak as a Dataset, see :func:`peak`."""
    values = {f"peak_{variable}": peak.value, f"peak_{variable}_error": peak.error}
    values |= {f"peak_{variable}_{axis}": position for axis, position in peak.position.items()}
    peak_variable = variable_of(f"peak_{variable}", {"units": base.units, "long_name": f"largest {base.long_name}"})
    peak_arrays = {
        name: name_array(name, xr.DataArray(value), peak_variable if name.endswith("_error") else base)
        for name, value in values.items()
    }
    if peak.comment:
        peak_arrays[f"peak_{variable}_error"].attrs["comment"] = peak.comment
    return xr.Dataset(peak_arrays)


def label_largest_stress(
    result: xr.Dataset, value: float, error: float, position: tuple[float, float, float]
) -> xr.Dataset:
    """Return the largest von Mises stress, its error and its position (x, y, z) as a Dataset, see :func:`peak`."""
    coordinates = dict(zip("xyz", position, strict=True))
    if "peak_pressure" in result and np.isinf(float(result["peak_pressure"])):
        largest_stress = Peak(np.inf, np.inf, dict.fromkeys("xyz", np.nan), SINGULAR)
    elif "peak_pressure_error" in result:
        relative_error = float(result["peak_pressure_error"] / result["peak_pressure"])
        largest_stress = Peak(value, error + value * relative_error, coordinates)
    else:
        largest_stress = Peak(value, np.nan, coordinates, "the error on the given cells is not estimated")
    labelled_peak = label_peak("von_mises", largest_stress, variable_of("von_mises", result["von_mises"].attrs))
    return without_error(labelled_peak, *(f"peak_von_mises_{axis}" for axis in "xyz"))


def _explain_unbounded(case: xr.Dataset, axes: dict[str, FloatArray], index: tuple[int, ...]) -> str:
    """Reason why the largest value may exceed the samples without limit; empty if none."""
    if "peak_pressure" in case and np.isinf(float(case["peak_pressure"])):
        return SINGULAR
    ends = cell_ends(case)
    for (axis, points), i in zip(axes.items(), index, strict=True):
        at_surface = axis == "z" and points[0] == 0 and i == 0
        if axis == "x":
            at_surface = any(np.isclose(points[i], end, rtol=0, atol=1e-9 * np.ptp(points)) for end in ends)
        if points.size > 1 and i in (0, points.size - 1) and not at_surface:
            return f"the largest sample lies at the edge of the points along {axis}"
    return _explain_unresolved(case, axes, {axis: float(axes[axis][i]) for axis, i in zip(axes, index, strict=True)})


def _explain_unresolved(case: xr.Dataset, axes: dict[str, FloatArray], sample: dict[str, float]) -> str:
    """Text on samples too coarse for the pressure above, at its peak or at the largest sample; empty if none."""
    if not {"pressure", "x", "y"} <= set(case.variables) or case["y"].size < 2:
        return ""
    pressure, x = case["pressure"].transpose("x", "y").values, case["x"].values
    dy = float(case["y"][1] - case["y"][0])
    axial = pressure.max(axis=1)
    in_range = (x >= axes["x"][0]) & (x <= axes["x"][-1]) if "x" in axes else np.ones(x.size, bool)
    if not axial[in_range].any():
        return ""
    column = int(np.where(in_range, axial, -1.0).argmax())
    variation_length = min(variation_lengths(pressure, x, dy, column))
    checked_columns = [(column, {"x": float(x[column])})]
    # On the flank of the peak the stresses vary as below the peak: check the largest sample only if it is farther away.
    if "x" in sample and abs(sample["x"] - x[column]) > 2 * variation_length:
        checked_columns.append((int(np.abs(x - sample["x"]).argmin()), sample))
    for column, location in checked_columns:
        length_x, length_y = variation_lengths(pressure, x, dy, column)
        # Near a free end the stresses vary along x even under a uniform pressure.
        end_distance = min((abs(float(x[column]) - end) for end in cell_ends(case)), default=np.inf)
        scales = {"x": min(length_x, max(length_y, end_distance)), "z": min(length_x, length_y)}
        for axis, scale in scales.items():
            points = axes.get(axis, np.zeros(1))
            nearest = int(np.abs(points - location.get(axis, 0.5 * scale)).argmin())
            distance = float(np.diff(points)[max(nearest - 1, 0) : nearest + 1].max(initial=0.0))
            if distance > MAX_SPACING_RATIO * scale:
                return (
                    f"the points are {distance:.2g} m apart along {axis}, the pressure varies within {scale:.2g} m: "
                    f"take at most {MAX_SPACING_RATIO * scale:.2g} m"
                )
    return ""


def cell_ends(case: xr.Dataset) -> tuple[float, ...]:
    """Return the ends of the cells along x, equal to the ends of a finite body; empty without cells."""
    if "x_bounds" not in case.coords:
        return ()
    bounds = case["x_bounds"].values
    return float(bounds.min()), float(bounds.max())
