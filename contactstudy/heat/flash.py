"""Flash temperature of a solved contact: heat of friction, partition of the heat, and temperature of both surfaces."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
import xarray as xr
from scipy.interpolate import make_interp_spline
from scipy.sparse.linalg import LinearOperator, gmres

from contactstudy import checks
from contactstudy.analysis.axes import single_case
from contactstudy.analysis.provenance import check_solved_for
from contactstudy.arrays.cells import labelled_cells
from contactstudy.arrays.grid import Grid
from contactstudy.arrays.variables import describe, require_in_si
from contactstudy.case.case import Case
from contactstudy.case.motion import Rolling, Shift, Sliding
from contactstudy.checks import BoolArray, FloatArray
from contactstudy.errors import ConvergenceWarning, InvalidInputError, TemperatureWarning
from contactstudy.heat.moving_source import MovingBody, SourceOperator, ThermalProperties


class FrictionalHeat(NamedTuple):
    """Frictional heat on the cells, its power, and the speeds of the surfaces relative to the contact."""

    density: FloatArray
    power: float
    body_speed: float
    roller_speed: float


def frictional_heat(case: Case, solution: xr.Dataset, grid: Grid) -> FrictionalHeat:
    """Heat per area and speeds of a solved case."""
    motion = case.motion
    names = ("traction_y",) if isinstance(motion, Sliding) else ("traction_x", "slip_x", "traction_y", "slip_y")
    solution = require_in_si(solution, *names, argument="result")
    fields = [labelled_cells(f"result.{name}", solution[name], extent=case.body.extent)[0] for name in names]
    area = grid.weights * grid.cell_area
    if isinstance(motion, Rolling):
        creepage = solution.get("longitudinal_creepage", motion.longitudinal_creepage)
        speeds = motion.speeds_at(0.0 if creepage is None else float(creepage))
        q_x, s_x, q_y, s_y = fields
        # Traction times slip per distance, times distance per time.
        density = -speeds.entrainment * np.maximum(q_x * s_x + q_y * s_y, 0.0)
        return FrictionalHeat(density, float((area * density).sum()), speeds.body, speeds.roller)
    assert isinstance(motion, Sliding)
    if motion.speeds is None:
        raise InvalidInputError("case.motion", motion, "one with body_speed and roller_speed (m/s)")
    body_speed, roller_speed = motion.speeds
    (traction,) = fields
    density = traction * (roller_speed - body_speed)
    if (density < 0).any():
        bound = "not below" if traction.max() > 0 else "not above"
        if (traction < 0).any() and (traction > 0).any():
            bound = "equal to, as the friction changes its sign along the axis,"
        raise InvalidInputError(
            "case.motion.roller_speed",
            roller_speed,
            f"{bound} body_speed, {body_speed:g}: friction drags the body the way the roller slides",
            "speeds are along +y",
        )
    power = float((area * traction).sum() * (roller_speed - body_speed))
    return FrictionalHeat(density, power, body_speed, roller_speed)


RESTART, MOST_RESTARTS = 60, 20  # Steps between restarts, and restarts
Heated = Callable[[FloatArray], FloatArray]  # Temperature rise from heat


def shared_heat(first: Heated, second: Heated, heat: FloatArray, touching: BoolArray) -> tuple[FloatArray, float]:
    """Heat into the first of two surfaces of equal temperature where they touch, and their difference over the rise."""
    if not heat.any():  # surfaces of the same speed
        return np.zeros(heat.shape), 0.0

    def on_cells(values: FloatArray) -> FloatArray:
        full = np.zeros(heat.shape)
        full[touching] = values
        return full

    first_rise, second_rise = first(heat)[touching], second(heat)[touching]
    share = second_rise.max() / (first_rise.max() + second_rise.max())  # Blok's: equal largest temperatures
    guess = share * heat[touching]
    count = guess.size

    def summed(values: FloatArray) -> FloatArray:
        full = on_cells(np.asarray(values).ravel())
        return np.asarray((first(full) + second(full))[touching])

    operator = LinearOperator((count, count), matvec=summed, dtype=np.float64)  # eq. (602)
    # Residual of the temperatures over the right-hand side at which the iteration stops
    solved, _ = gmres(operator, second_rise, x0=guess, rtol=1e-9, restart=min(RESTART, count), maxiter=MOST_RESTARTS)
    mismatch = float(np.abs(summed(solved) - second_rise).max() / max(np.abs(second_rise).max(), np.finfo(float).tiny))
    return on_cells(solved), mismatch


def flash_temperature(
    case: Case,
    result: xr.Dataset,
    *,
    body: ThermalProperties,
    roller: ThermalProperties | None = None,
    partition: float | None = None,
    z: Sequence[float] | FloatArray | None = None,
    limit: float | None = None,
) -> xr.Dataset:
    """Steady temperature rise of both surfaces of a contact by friction, relative to the bodies far away.

    Parameters
    ----------
    case : Case
        The solved case, with the speeds of its motion. A roller with ``ends="none"`` conducts heat like a half-space.
    result : Dataset
        Result of `solve`.
    body, roller : ThermalProperties
        The roller's may be omitted with a given `partition`.
    partition : float, optional
        Uniform part of the heat that goes into the body, from 0 to 1. Default: equal temperatures of both surfaces in
        the contact determine the part at each point.
    z : sequence of float, optional
        Depths below the body's surface of further temperatures, metres.
    limit : float, optional
        Temperature rise, K, above which the function warns.

    Returns
    -------
    Dataset
        `temperature_rise` of the body's surface and `roller_temperature_rise` (x, y), K; `frictional_heat` and
        `heat_into_body` (x, y), W/m2; `heat_partition` (x, y), the part of the heat that goes into the body, NaN
        without heat; `body_heat_share`, its part of the total; `max_temperature_rise` of both surfaces, between the
        cells along y, with `max_temperature_rise_x` and ``_y`` and `max_temperature_rise_error`; `friction_power`, W;
        `heat_error`, heat into both bodies over that power, minus one; `temperature_mismatch` of the surfaces over the
        largest rise. With `z` also `body_temperature_rise` (x, y, z).

    Raises
    ------
    InvalidInputError
        If thermal properties or speeds are missing, the speeds contradict the friction, the result belongs to
        another case, or the surface of a finite body rests under the contact: its temperature is unbounded.

    Warns
    -----
    TemperatureWarning
        If the rise exceeds `limit`.
    ConvergenceWarning
        If the temperatures of the surfaces differ.

    Notes
    -----
    Thermal expansion is neglected. At a singular end heat and pressure are infinite, and the maximum is the temperature
    of the last cell. The stated error of the maximum is its change on cells twice as wide along y, plus the relative
    error of the largest pressure; NaN without an estimate of the latter, or with an infinite pressure.

    Examples
    --------
    >>> from contactstudy import Case, FiniteLengthSpace, Material, Roller, Sliding, choose_grid, solve
    >>> space = FiniteLengthSpace(length=0.5e-3, material=Material(210e9, 0.3))
    >>> roller = Roller(radius=5e-3, length=0.5e-3)
    >>> motion = Sliding(body_speed=-10.0, roller_speed=-9.0)
    >>> case = Case(body=space, roller=roller, max_pressure=1.5e9, friction=0.05, motion=motion)
    >>> result = solve(case, choose_grid(case), stresses=False)
    >>> steel = ThermalProperties(conductivity=46.0, density=7850.0, specific_heat=470.0)
    >>> hot = flash_temperature(case, result, body=steel, roller=steel)
    >>> round(float(hot.max_temperature_rise)), round(float(hot.body_heat_share), 2)
    (10, 0.51)
    """
    checks.instance("case", case, Case, "a Case")
    solution = single_case(require_in_si(result, "pressure", argument="result"))
    if isinstance(case.motion, Shift):
        raise InvalidInputError("case.motion", case.motion, "Sliding() or Rolling(...): a shift makes no steady heat")
    check_solved_for(result, case)
    pressure, grid = labelled_cells("result.pressure", solution["pressure"], extent=case.body.extent)
    checks.instance("body", body, ThermalProperties, "a ThermalProperties(...)")
    if partition is None and roller is None:
        raise InvalidInputError(
            "roller", None, "a ThermalProperties(...)", "or give partition, the part of the heat that the body takes"
        )
    if roller is not None:
        checks.instance("roller", roller, ThermalProperties, "a ThermalProperties(...)")
    share = None if partition is None else checks.not_negative("partition", partition)
    if share is not None and share > 1:
        raise InvalidInputError("partition", share, "from 0 to 1: the part of the heat that goes into the body")
    if limit is not None:
        limit = checks.positive("limit", limit, "K")
    depths = None if z is None else checks.coordinates("z", z)
    if depths is not None and (depths < 0).any():
        raise InvalidInputError("z", float(depths.min()), "not below zero (metres)")
    heat = frictional_heat(case, solution, grid)
    rises, into_body, mismatch = _temperatures(case, grid, heat, pressure, body, roller=roller, share=share)
    into_roller = heat.density - into_body
    area = grid.weights * grid.cell_area
    heated = heat.density != 0
    fields = rises | {
        "frictional_heat": heat.density,
        "heat_into_body": into_body,
        "heat_partition": np.where(heated, into_body / np.where(heated, heat.density, 1.0), np.nan),
    }
    values = {name: (("x", "y"), field) for name, field in fields.items()}
    scalars = _largest(grid, rises)
    (wider, density), (_, means) = (_on_wider_cells(grid, values) for values in (heat.density, pressure))
    on_half, _, _ = _temperatures(case, wider, heat._replace(density=density), means, body, roller=roller, share=share)
    change = abs(_largest(wider, on_half)["max_temperature_rise"] - scalars["max_temperature_rise"])
    peak, error = (float(solution.get(name, np.nan)) for name in ("peak_pressure", "peak_pressure_error"))
    relative = error / peak if np.isfinite([peak, error]).all() and peak > 0 else np.nan
    scalars["max_temperature_rise_error"] = change + scalars["max_temperature_rise"] * relative
    scalars["friction_power"] = heat.power
    scalars["body_heat_share"] = float((area * into_body).sum() / heat.power) if heat.power else np.nan
    entered = (area * into_body).sum() + (area * into_roller)[_under_roller(case, grid, pressure)[0]].sum()
    scalars["heat_error"] = float(entered / heat.power - 1) if heat.power else 0.0
    scalars["temperature_mismatch"] = mismatch
    coords = {name: solution.coords[name] for name in ("x", "y", "x_bounds", "x_width") if name in solution.coords}
    hot = xr.Dataset(values | scalars, coords=coords)
    hot = hot.assign({name: solution[name] for name in ("hertz_half_width", "hertz_max_pressure") if name in solution})
    if depths is not None:
        moving, columns = MovingBody(body, heat.body_speed, case.body.extent), slice(0, grid.cells_x)
        inside = [SourceOperator(moving, grid, columns, float(depth))(into_body) for depth in depths]
        hot = hot.assign_coords(z=depths)
        hot["body_temperature_rise"] = (("x", "y", "z"), np.stack(inside, axis=-1))
    if mismatch > 1e-6:  # larger differences do not count as equal
        text = f"the surfaces' temperatures still differ by {mismatch:.2g} of the largest"
        warnings.warn(text, ConvergenceWarning, stacklevel=2)
    largest = scalars["max_temperature_rise"]
    if limit is not None and largest > limit:
        x, y = (1e3 * scalars[f"max_temperature_rise_{axis}"] for axis in "xy")
        warnings.warn(
            f"the surfaces are {largest:.4g} K hotter than the bodies at x = {x:.4g} mm, y = {y:.4g} mm: above "
            f"limit = {limit:g} K",
            TemperatureWarning,
            stacklevel=2,
        )
    return describe(hot, "flash temperature of a contact")


def _temperatures(
    case: Case,
    grid: Grid,
    heat: FrictionalHeat,
    pressure: FloatArray,
    body: ThermalProperties,
    roller: ThermalProperties | None,
    share: float | None,
) -> tuple[dict[str, FloatArray], FloatArray, float]:
    """Rises of the surfaces by name, heat into the body, and relative difference of the temperatures."""
    body_rise = SourceOperator(MovingBody(body, heat.body_speed, case.body.extent), grid, slice(0, grid.cells_x))
    if roller is None:
        assert share is not None
        return {"temperature_rise": body_rise(share * heat.density)}, share * heat.density, np.nan
    columns, ends = _under_roller(case, grid, pressure)
    roller_rise = SourceOperator(MovingBody(roller, heat.roller_speed, ends), grid, columns)
    if share is None:
        into_body, mismatch = shared_heat(body_rise, roller_rise, heat.density, pressure > 0)
    else:
        into_body, mismatch = share * heat.density, np.nan
    rises = {"temperature_rise": body_rise(into_body), "roller_temperature_rise": roller_rise(heat.density - into_body)}
    return rises, into_body, mismatch


def _on_wider_cells(grid: Grid, values: FloatArray) -> tuple[Grid, FloatArray]:
    """Half as many cells along y, and means over them."""
    wider = Grid.between(grid.x_edges, grid.y_range, max(grid.cells_y // 2, 1))
    summed = np.pad(np.cumsum(values, axis=1), ((0, 0), (1, 0)))
    # The border of a wider cell may cut a cell.
    cuts = np.linspace(0, grid.cells_y, wider.cells_y + 1)
    at_cuts = make_interp_spline(np.arange(grid.cells_y + 1), summed, k=1, axis=1)(cuts)
    return wider, np.diff(at_cuts, axis=1) * wider.cells_y / grid.cells_y


def _under_roller(case: Case, grid: Grid, pressure: FloatArray) -> tuple[slice, tuple[float, float]]:
    """Columns under the roller, pressed ones included, and its insulated ends, moved to borders of cells."""
    if case.roller.ends == "none":
        return slice(0, grid.cells_x), (-np.inf, np.inf)
    low, high = case.roller_start, case.roller_start + case.roller.length
    edges = grid.x_edges
    # Rounding decides on a centre at the end of the roller.
    under = np.flatnonzero(((grid.x > low) & (grid.x < high)) | (pressure > 0).any(axis=1))
    first, stop = int(under[0]), int(under[-1]) + 1
    start = edges[first] if first > 0 else min(low, edges[0])
    end = edges[stop] if stop < grid.cells_x else max(high, edges[-1])
    return slice(first, stop), (float(start), float(end))


def _largest(grid: Grid, rises: dict[str, FloatArray]) -> dict[str, float]:
    """Largest rise of the surfaces and its position, by a parabola between the cells along y."""
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
