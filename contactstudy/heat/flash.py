"""Flash temperature of a solved contact: heat from friction, its sharing, and the temperature of both surfaces."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.analysis.axes import single_case
from contactstudy.analysis.provenance import check_solved_for
from contactstudy.arrays.cells import labelled_cells
from contactstudy.arrays.grid import Grid
from contactstudy.arrays.units import required_in_si
from contactstudy.arrays.variables import describe
from contactstudy.caller import warn
from contactstudy.case.case import Case
from contactstudy.case.motion import Shift
from contactstudy.checks import FloatArray
from contactstudy.errors import ConvergenceWarning, InvalidInputError, TemperatureWarning
from contactstudy.heat.friction import FrictionalHeat, frictional_heat
from contactstudy.heat.moving_source import MovingBody, SourceOperator
from contactstudy.heat.partition import shared_heat
from contactstudy.heat.properties import ThermalProperties
from contactstudy.heat.spreading import Ends

LARGEST_MISMATCH = 1e-6
"""Difference of the surfaces' temperatures, over the largest, that counts as equal. Accuracy."""


class _Temperatures(NamedTuple):
    """Rises of the surfaces by name, heat into the body, and how well the surfaces' temperatures agree."""

    rises: dict[str, FloatArray]
    into_body: FloatArray
    mismatch: float


def flash_temperature(
    case: Case,
    result: xr.Dataset,
    *,
    body: ThermalProperties,
    roller: ThermalProperties | None = None,
    body_speed: float | None = None,
    roller_speed: float | None = None,
    rolling_speed: float | None = None,
    partition: float | None = None,
    z: Sequence[float] | FloatArray | None = None,
    limit: float | None = None,
) -> xr.Dataset:
    """Steady temperature that friction raises on both surfaces of a contact, above that of the bodies far away.

    Parameters
    ----------
    case : Case
        The case that was solved: it says where both bodies end. A roller with ``ends="none"`` conducts heat like a
        half-space. Ends, and the top beside the contact, are insulated.
    result : Dataset
        What `solve` returned for it.
    body, roller : ThermalProperties
        What body and roller are made of; a roller that takes a stated part of the heat only needs none.
    body_speed, roller_speed : float, optional
        In full sliding: velocities of the surfaces along +y relative to the contact, m/s. A roller that slides over a
        body which rolls past at V has ``body_speed = -V``.
    rolling_speed : float, optional
        In rolling, instead: speed with which the contact moves over both surfaces, m/s.
    partition : float, optional
        Part of the heat that goes into the body, everywhere the same, from 0 to 1. Default: as much at each point as
        makes both surfaces equally hot where they touch.
    z : sequence of float, optional
        Depths below the body's surface at which its temperature is wanted as well, metres.
    limit : float, optional
        Temperature rise, K, above which a warning is given.

    Returns
    -------
    Dataset
        `temperature_rise` of the body's surface and `roller_temperature_rise` (x, y), K; `frictional_heat` and
        `heat_into_body` (x, y), W/m2; `heat_partition` (x, y), the part of the heat that goes into the body, NaN
        where there is none; `body_heat_share` of the whole; `max_temperature_rise` of both surfaces, between the
        cells along y, with `max_temperature_rise_x` and ``_y`` and `max_temperature_rise_error`; `friction_power`, W;
        `heat_error`, heat into both bodies minus that power, over it; `temperature_mismatch` of the surfaces over the
        largest rise. With `z` also `body_temperature_rise` (x, y, z).

    Raises
    ------
    InvalidInputError
        If thermal properties or speeds are missing, the speeds contradict the friction, the result says that it is of
        another case, or a finite body's surface rests under the contact: its temperature would rise without limit.

    Warns
    -----
    TemperatureWarning
        If `limit` is passed.
    ConvergenceWarning
        If the temperatures of the surfaces could not be made equal.

    Notes
    -----
    Properties do not depend on temperature, and the contact does not deform by heat. At a singular end the heat is
    infinite as the pressure is, and so is the temperature of a fast surface there: the maximum is then that of the
    last cell.

    The stated error of the maximum is its change on cells twice as wide along y, plus the relative error of the
    largest pressure. It is NaN where that pressure has no known error, or no limit.

    Examples
    --------
    >>> from contactstudy import Case, FiniteLengthSpace, Material, Roller, ThermalProperties, choose_grid, solve
    >>> space = FiniteLengthSpace(length=0.5e-3, material=Material(210e9, 0.3))
    >>> roller = Roller(radius=5e-3, length=0.5e-3)
    >>> case = Case(body=space, roller=roller, max_pressure=1.5e9, friction=0.05)
    >>> result = solve(case, choose_grid(case), stresses=False)
    >>> steel = ThermalProperties(conductivity=46.0, density=7850.0, specific_heat=470.0)
    >>> hot = flash_temperature(case, result, body=steel, roller=steel, body_speed=-10.0, roller_speed=-9.0)
    >>> round(float(hot.max_temperature_rise)), round(float(hot.body_heat_share), 2)
    (10, 0.51)
    """
    checks.instance("case", case, Case, "a Case")
    one = single_case(required_in_si(result, "pressure", argument="result"))
    if isinstance(case.motion, Shift):
        raise InvalidInputError("case.motion", case.motion, "Sliding() or Rolling(...): a shift makes no steady heat")
    check_solved_for(result, case)
    pressure, grid = labelled_cells("result.pressure", one["pressure"], extent=case.body.extent)
    checks.instance("body", body, ThermalProperties, "a ThermalProperties(...)")
    if partition is None and roller is None:
        raise InvalidInputError(
            "roller", None, "a ThermalProperties(...)", "or give partition, the part of the heat that the body takes"
        )
    if roller is not None:
        checks.instance("roller", roller, ThermalProperties, "a ThermalProperties(...)")
    share = None if partition is None else _share(partition)
    if limit is not None:
        limit = checks.positive("limit", limit, "K")
    depths = None if z is None else checks.coordinates("z", z)
    if depths is not None and (depths < 0).any():
        raise InvalidInputError("z", float(depths.min()), "not below zero (metres)")
    heat = frictional_heat(case, one, grid, body_speed, roller_speed, rolling_speed)

    found = _temperatures(case, grid, heat, pressure, body, roller, share)
    into_body, into_roller = found.into_body, heat.density - found.into_body
    area = grid.weights * grid.cell_area
    made = heat.density != 0
    fields = found.rises | {
        "frictional_heat": heat.density,
        "heat_into_body": into_body,
        "heat_partition": np.where(made, into_body / np.where(made, heat.density, 1.0), np.nan),
    }
    values = {name: (("x", "y"), each) for name, each in fields.items()}
    scalars = _largest(grid, found.rises)
    halved, wider = _on_wider_cells(grid, heat.density), _on_wider_cells(grid, pressure)
    on_half = _temperatures(case, halved.grid, heat._replace(density=halved.values), wider.values, body, roller, share)
    change = abs(_largest(halved.grid, on_half.rises)["max_temperature_rise"] - scalars["max_temperature_rise"])
    scalars["max_temperature_rise_error"] = change + scalars["max_temperature_rise"] * _pressure_error(one)
    scalars["friction_power"] = heat.power
    scalars["body_heat_share"] = float((area * into_body).sum() / heat.power) if heat.power else np.nan
    entered = (area * into_body).sum() + (area * into_roller)[_under_roller(case, grid, pressure)[0]].sum()
    scalars["heat_error"] = float(entered / heat.power - 1) if heat.power else 0.0
    scalars["temperature_mismatch"] = found.mismatch
    kept = {name: one.coords[name] for name in ("x", "y", "x_bounds", "x_width") if name in one.coords}
    hot = xr.Dataset(values | scalars, coords=kept)
    for name in ("hertz_half_width", "hertz_max_pressure"):
        if name in one:
            hot[name] = one[name]
    if depths is not None:
        moving, whole = MovingBody(body, heat.body_speed, Ends(*case.body.extent)), slice(0, grid.cells_x)
        inside = [SourceOperator(moving, grid, whole, float(depth))(into_body) for depth in depths]
        hot = hot.assign_coords(z=depths)
        hot["body_temperature_rise"] = (("x", "y", "z"), np.stack(inside, axis=-1))
    mismatch = found.mismatch
    if mismatch > LARGEST_MISMATCH:
        warn(
            f"the surfaces' temperatures still differ by {mismatch:.2g} of the largest",
            ConvergenceWarning,
        )
    _warn_above(hot, limit)
    return describe(hot, "flash temperature of a contact")


def _temperatures(
    case: Case,
    grid: Grid,
    heat: FrictionalHeat,
    pressure: FloatArray,
    body: ThermalProperties,
    roller: ThermalProperties | None,
    share: float | None,
) -> _Temperatures:
    """Share the heat and find how hot both surfaces get."""
    own = SourceOperator(MovingBody(body, heat.body_speed, Ends(*case.body.extent)), grid, slice(0, grid.cells_x))
    if roller is None:
        assert share is not None
        return _Temperatures({"temperature_rise": own(share * heat.density)}, share * heat.density, np.nan)
    columns, ends = _under_roller(case, grid, pressure)
    other = SourceOperator(MovingBody(roller, heat.roller_speed, ends), grid, columns)
    if share is None:
        into_body, mismatch = shared_heat(own, other, heat.density, pressure > 0)
    else:
        into_body, mismatch = share * heat.density, np.nan
    rises = {"temperature_rise": own(into_body), "roller_temperature_rise": other(heat.density - into_body)}
    return _Temperatures(rises, into_body, mismatch)


class _OnCells(NamedTuple):
    """Cells, and means over them."""

    grid: Grid
    values: FloatArray


def _on_wider_cells(grid: Grid, values: FloatArray) -> _OnCells:
    """Means over half as many cells along y."""
    wider = Grid.between(grid.x_edges, grid.y_range, max(grid.cells_y // 2, 1))
    summed = np.concatenate([np.zeros((grid.cells_x, 1)), np.cumsum(values, axis=1)], axis=1)
    # A border of a wider cell may cut a cell: that one's part is its share of the width.
    cuts = np.arange(wider.cells_y + 1) * (grid.cells_y / wider.cells_y)
    whole = np.minimum(cuts.astype(int), grid.cells_y - 1)
    at_cuts = summed[:, whole] + (cuts - whole) * values[:, whole]
    return _OnCells(wider, np.diff(at_cuts, axis=1) * wider.cells_y / grid.cells_y)


def _pressure_error(one: xr.Dataset) -> float:
    """Error of the largest pressure over that pressure; NaN where there is none, or no largest pressure."""
    if not {"peak_pressure", "peak_pressure_error"} <= set(one.variables):
        return float("nan")
    peak, error = float(one["peak_pressure"]), float(one["peak_pressure_error"])
    return error / peak if np.isfinite(peak) and np.isfinite(error) and peak > 0 else float("nan")


def _share(partition: object) -> float:
    """Return a part between nothing and all, or raise."""
    share = checks.not_negative("partition", partition)
    if share > 1:
        raise InvalidInputError("partition", share, "from 0 to 1: the part of the heat that goes into the body")
    return share


def _under_roller(case: Case, grid: Grid, pressure: FloatArray) -> tuple[slice, Ends]:
    """Columns of the roller, all that it presses among them, and its insulated ends, moved to borders of cells."""
    if case.roller.ends == "none":
        return slice(0, grid.cells_x), Ends(-np.inf, np.inf)
    low, high = case.roller_start, case.roller_start + case.roller.length
    edges = grid.x_edges
    # A centre right under the end may count as under the roller or not, by rounding.
    under = np.flatnonzero(((grid.x > low) & (grid.x < high)) | (pressure > 0).any(axis=1))
    first, stop = int(under[0]), int(under[-1]) + 1
    start = edges[first] if first > 0 else min(low, edges[0])
    end = edges[stop] if stop < grid.cells_x else max(high, edges[-1])
    return slice(first, stop), Ends(float(start), float(end))


def _largest(grid: Grid, rises: dict[str, FloatArray]) -> dict[str, float]:
    """Largest rise of the surfaces and where it is, between the cells along y by a parabola."""
    hottest = max(rises.values(), key=lambda rise: float(rise.max()))
    i, j = np.unravel_index(int(hottest.argmax()), hottest.shape)
    largest, y = float(hottest[i, j]), float(grid.y[j])
    if 0 < j < grid.cells_y - 1:
        before, after = hottest[i, j - 1], hottest[i, j + 1]
        bend = before - 2 * largest + after
        if bend < 0:
            offset = 0.5 * (before - after) / bend
            largest, y = float(largest - 0.25 * (before - after) * offset), float(y + offset * grid.dy)
    return {"max_temperature_rise": largest, "max_temperature_rise_x": float(grid.x[i]), "max_temperature_rise_y": y}


def _warn_above(hot: xr.Dataset, limit: float | None) -> None:
    """Warn where the limit is passed."""
    largest = float(hot["max_temperature_rise"])
    if limit is None or largest <= limit:
        return
    x, y = (1e3 * float(hot[f"max_temperature_rise_{axis}"]) for axis in "xy")
    warn(
        f"the surfaces are {largest:.4g} K hotter than the bodies at x = {x:.4g} mm, y = {y:.4g} mm: above "
        f"limit = {limit:g} K",
        TemperatureWarning,
    )
