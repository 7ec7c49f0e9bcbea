"""Ends of a contact that are cuts: where a part of a result was selected along the roller's axis."""

from __future__ import annotations

import numpy as np
import xarray as xr

from contactstudy.analysis.axes import cell_size, dimension_along, increasing, positions
from contactstudy.analysis.provenance import INPUTS_ATTRIBUTE, attribute, solved_case
from contactstudy.analysis.reduced import reduced
from contactstudy.arrays.units import required_in_si
from contactstudy.checks import Array
from contactstudy.errors import InvalidInputError

CUT = 0.01
"""Part of the load that is missing where a Dataset is a part of a contact. Accuracy."""

AT_END = 1e-6
"""Part of a cell by which its border may miss the end of the contact. Accuracy."""


def _cut(
    pressure: Array, load: Array, x: Array, dx: Array, dy: Array, start: float, stop: float
) -> tuple[Array, Array]:
    """Whether contacts (..., x, y) go on beyond the first and the last x."""
    known = np.broadcast_to(np.isfinite(x), pressure.shape[:-1])
    x, dx = (np.broadcast_to(each, known.shape) for each in (x, dx))
    carried = np.nansum(pressure * dx[..., :, None] * dy[..., None, :], axis=(-2, -1))
    apart = np.abs(np.diff(x, axis=-1) - 0.5 * (dx[..., 1:] + dx[..., :-1])) > AT_END * dx[..., 1:]
    pressed = pressure > 0
    # One that is cut along y, or of which cells were left out, carries less for that reason.
    short = (carried < (1 - CUT) * load) & ~pressed[..., [0, -1]].any(axis=(-2, -1)) & ~apart.any(axis=-1)

    def outermost(values: Array, *, first: bool) -> Array:
        last = known.sum(axis=-1, keepdims=True) - 1
        at = np.zeros_like(last) if first else np.maximum(last, 0)
        return np.asarray(np.take_along_axis(values, at, axis=-1)[..., 0])

    loaded = pressed.any(axis=-1)
    slack = AT_END * dx
    before, behind = x - 0.5 * dx > start + slack, x + 0.5 * dx < stop - slack
    first, last = (outermost(loaded & inside, first=at) for inside, at in ((before, True), (behind, False)))
    return (short & first).astype(np.float64), (short & last).astype(np.float64)


def cut_ends(dataset: xr.Dataset) -> tuple[xr.DataArray, xr.DataArray]:
    """Whether the contact goes on beyond the first and the last x, as in a part of a result: 1 if so, else 0.

    The pressure of a part carries less than the load, and reaches a border of the cells that is not the contact's end.
    A result of `solve` says where that is. Of others a contact begins at x = 0 or inside the cells, and where such a
    contact ends is not known.

    Parameters
    ----------
    dataset : Dataset
        With `pressure` on cells; without `normal_load` nothing is a cut.

    Raises
    ------
    InvalidInputError
        If there is no pressure, or a unit is not known.

    Examples
    --------
    >>> cells = {"x": [0.5, 1.5, 2.5], "y": [-1.0, 0.0, 1.0]}
    >>> pressure = xr.DataArray([[0, 2, 0], [0, 1, 0], [0, 1, 0]], dims=("x", "y"), coords=cells)
    >>> contact = xr.Dataset({"pressure": pressure, "normal_load": 4.0})
    >>> [[float(end) for end in cut_ends(each)] for each in (contact, contact.isel(x=[1, 2]), contact.isel(x=[0, 1]))]
    [[0.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
    """
    dataset = required_in_si(dataset, "pressure", normalized=True)
    pressure = dataset["pressure"]
    if "normal_load" not in dataset or pressure.sizes[dimension_along(pressure, "y")] < 2:
        return xr.DataArray(0.0), xr.DataArray(0.0)
    if pressure.attrs.get("units") == "1":
        return xr.DataArray(0.0), xr.DataArray(0.0)
    dataset = required_in_si(dataset, "normal_load")
    for axis in "xy":
        pressure = increasing(pressure, axis)
    x, y = dimension_along(pressure, "x"), dimension_along(pressure, "y")
    start, stop = _contact_range(dataset)
    arguments = [
        (pressure, [x, y]),
        (dataset["normal_load"], []),
        (positions(pressure, "x"), [x]),
        *((cell_size(pressure, axis) + 0.0 * positions(pressure, axis), [dim]) for axis, dim in (("x", x), ("y", y))),
        *((xr.DataArray(end), []) for end in (start, stop)),
    ]
    first, last = reduced(_cut, arguments, 2)
    return first, last


def _contact_range(dataset: xr.Dataset) -> tuple[float, float]:
    """First and last x of the contact, as far as they are known."""
    if "case" in attribute(dataset, INPUTS_ATTRIBUTE):
        try:
            return solved_case(dataset).contact_range
        except InvalidInputError:  # of another version
            pass
    return 0.0, np.inf
