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
    """Frictional heat on the cells, and the speeds of the surfaces relative to the contact."""

    density: FloatArray
    body_speed: float
    roller_speed: float


def frictional_heat(case: Case, solution: xr.Dataset) -> FrictionalHeat:
    """Compute heat per area and speeds of a solved case."""
    motion = case.motion
    names = ("traction_y",) if isinstance(motion, Sliding) else ("traction_x", "slip_x", "traction_y", "slip_y")
    solution = require_in_si(solution, *names, argument="result")
    fields = [labelled_cells(f"result.{name}", solution[name], extent=case.body.extent)[0] for name in names]
    if isinstance(motion, Rolling):
        creepage = solution.get("longitudinal_creepage", motion.longitudinal_creepage)
        speeds = motion.speeds_at(0.0 if creepage is None else float(creepage))
        q_x, s_x, q_y, s_y = fields
        # Power per area is traction times slip per distance, times distance per time.
        density = -speeds.entrainment * np.maximum(q_x * s_x + q_y * s_y, 0.0)
        return FrictionalHeat(density, speeds.body, speeds.roller)
    assert isinstance(motion, Sliding)
    if motion.speeds is None:
        raise InvalidInputError("case.motion", motion, "one with body_speed and roller_speed (m/s)")
    body_speed, roller_speed = motion.speeds
    (traction,) = fields
    density = traction * (roller_speed - body_speed)
    if (density < 0).any():
        relation = "not below" if traction.max() > 0 else "not above"
        if (traction < 0).any() and (traction > 0).any():
            relation = "equal to, as the friction changes its sign along the axis,"
        allowed = f"{relation} body_speed, {body_speed:g}: friction acts on the body along the roller's sliding"
        raise InvalidInputError("case.motion.roller_speed", roller_speed, allowed, "speeds are along +y")
    return FrictionalHeat(density, body_speed, roller_speed)


RESTART, MAX_RESTARTS = 60, 20  # Steps between restarts, and restarts
Response = Callable[[FloatArray], FloatArray]  # Temperature rise from heat


def partition_heat(
    first_response: Response, second_response: Response, heat: FloatArray, in_contact: BoolArray
) -> tuple[FloatArray, float]:
    """Heat into the first of two surfaces of equal contact temperature, and the difference of their relative rises."""
    if not heat.any():  # surfaces of the same speed
        return np.zeros(heat.shape), 0.0

    first_rise, second_rise = first_response(heat)[in_contact], second_response(heat)[in_contact]
    fraction = second_rise.max() / (first_rise.max() + second_rise.max())  # Blok's: equal largest temperatures
    guess = fraction * heat[in_contact]
    count = guess.size

    def apply(cell_heat: FloatArray) -> FloatArray:
        grid_heat = np.zeros(heat.shape)
        grid_heat[in_contact] = np.ravel(cell_heat)
        return np.asarray((first_response(grid_heat) + second_response(grid_heat))[in_contact])

    operator = LinearOperator((count, count), matvec=apply, dtype=np.float64)  # eq. (602)
    # Residual of the temperatures over the right-hand side at which the iteration stops
    solution, _ = gmres(operator, second_rise, x0=guess, rtol=1e-9, restart=min(RESTART, count), maxiter=MAX_RESTARTS)
    mismatch = float(np.abs(apply(solution) - second_rise).max() / max(np.abs(second_rise).max(), np.finfo(float).tiny))
    into_first = np.zeros(heat.shape)
    into_first[in_contact] = solution
    return into_first, mismatch


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
        Thermal properties of the bodies; `roller` may be omitted with a given `partition`.
    partition : float, optional
        Uniform fraction of the heat into the body, from 0 to 1. Default: equal temperatures of both surfaces in the
        contact determine the fraction at each point.
    z : sequence of float, optional
        Depths below the body's surface of further temperatures, metres.
    limit : float, optional
        Temperature rise, K, above which the function warns.

    Returns
    -------
    Dataset
        `temperature_rise` of the body's surface and `roller_temperature_rise` (x, y), K; `frictional_heat` and
        `heat_into_body` (x, y), W/m2; `heat_partition` (x, y), the fraction of the heat into the body, NaN
        without heat; `body_heat_share`, the fraction of the total; `max_temperature_rise` of both surfaces, between the
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
        raise InvalidInputError("case.motion", case.motion, "Sliding() or Rolling(...): a shift causes no steady heat")
    check_solved_for(result, case)
    pressure, grid = labelled_cells("result.pressure", solution["pressure"], extent=case.body.extent)
    checks.instance("body", body, ThermalProperties, "a ThermalProperties(...)")
    share = None if partition is None else checks.not_negative("partition", partition)
    allowed = "a ThermalProperties(...), or None with partition, the fraction of the heat into the body"
    checks.instance("roller", roller, ThermalProperties if share is None else (ThermalProperties, type(None)), allowed)
    if share is not None and share > 1:
        raise InvalidInputError("partition", share, "from 0 to 1: the fraction of the heat into the body")
    if limit is not None:
        limit = checks.positive("limit", limit, "K")
    depths = None if z is None else checks.coordinates("z", z)
    if depths is not None and (depths < 0).any():
        raise InvalidInputError("z", float(depths.min()), "not below zero (metres)")
    heat = frictional_heat(case, solution)
    rises, into_body, mismatch = _solve_temperatures(case, grid, heat, pressure, body, roller=roller, fraction=share)
    no_fraction = np.full(grid.shape, np.nan)
    fields = rises | {
        "frictional_heat": heat.density,
        "heat_into_body": into_body,
        "heat_partition": np.divide(into_body, heat.density, out=no_fraction, where=heat.density != 0),
    }
    values = {name: (("x", "y"), field) for name, field in fields.items()}
    scalars = _find_maximum(grid, rises)
    (wide_grid, density), (_, mean_pressure) = (_coarsen(grid, values) for values in (heat.density, pressure))
    wide_heat = heat._replace(density=density)
    wide_rises = _solve_temperatures(case, wide_grid, wide_heat, mean_pressure, body, roller=roller, fraction=share)[0]
    change = abs(_find_maximum(wide_grid, wide_rises)["max_temperature_rise"] - scalars["max_temperature_rise"])
    peak, error = (float(solution.get(name, np.nan)) for name in ("peak_pressure", "peak_pressure_error"))
    relative_error = error / peak if np.isfinite([peak, error]).all() and peak > 0 else np.nan
    scalars["max_temperature_rise_error"] = change + scalars["max_temperature_rise"] * relative_error
    area = grid.weights * grid.cell_area
    power, body_power = (float((area * density).sum()) for density in (heat.density, into_body))
    roller_power = float((area * (heat.density - into_body))[_under_roller(case, grid, pressure)[0]].sum())
    scalars |= {
        "friction_power": power,
        "body_heat_share": body_power / power if power else np.nan,
        "heat_error": (body_power + roller_power) / power - 1 if power else 0.0,
        "temperature_mismatch": mismatch,
    }
    inherited_names = ("x", "y", "x_bounds", "x_width", "hertz_half_width", "hertz_max_pressure")
    inherited = solution[[name for name in inherited_names if name in solution.variables]].drop_attrs(deep=False)
    temperatures = inherited.assign(values | scalars)
    if depths is not None:
        moving_body, columns = MovingBody(body, heat.body_speed, case.body.extent), slice(0, grid.cells_x)
        inner_rises = [SourceOperator(moving_body, grid, columns, float(depth))(into_body) for depth in depths]
        temperatures = temperatures.assign_coords(z=depths)
        temperatures["body_temperature_rise"] = (("x", "y", "z"), np.stack(inner_rises, axis=-1))
    if mismatch > 1e-6:  # the limit of equal temperatures
        message = f"the surfaces' temperatures still differ by {mismatch:.2g} of the largest"
        warnings.warn(message, ConvergenceWarning, stacklevel=2)
    max_rise = scalars["max_temperature_rise"]
    if limit is not None and max_rise > limit:
        x, y = (1e3 * scalars[f"max_temperature_rise_{axis}"] for axis in "xy")
        message = f"the surfaces are {max_rise:.4g} K hotter than the bodies at x = {x:.4g} mm, y = {y:.4g} mm"
        warnings.warn(f"{message}: above limit = {limit:g} K", TemperatureWarning, stacklevel=2)
    return describe(temperatures, "flash temperature of a contact")


def _solve_temperatures(
    case: Case,
    grid: Grid,
    heat: FrictionalHeat,
    pressure: FloatArray,
    body: ThermalProperties,
    roller: ThermalProperties | None,
    fraction: float | None,
) -> tuple[dict[str, FloatArray], FloatArray, float]:
    """Rises of the surfaces by name, heat into the body, and relative difference of the temperatures."""
    body_rise = SourceOperator(MovingBody(body, heat.body_speed, case.body.extent), grid, slice(0, grid.cells_x))
    if roller is None:
        assert fraction is not None
        return {"temperature_rise": body_rise(fraction * heat.density)}, fraction * heat.density, np.nan
    columns, ends = _under_roller(case, grid, pressure)
    roller_rise = SourceOperator(MovingBody(roller, heat.roller_speed, ends), grid, columns)
    if fraction is None:
        into_body, mismatch = partition_heat(body_rise, roller_rise, heat.density, pressure > 0)
    else:
        into_body, mismatch = fraction * heat.density, np.nan
    rises = {"temperature_rise": body_rise(into_body), "roller_temperature_rise": roller_rise(heat.density - into_body)}
    return rises, into_body, mismatch


def _coarsen(grid: Grid, field: FloatArray) -> tuple[Grid, FloatArray]:
    """Return a grid with half as many cells along y, and the means of the field over its cells."""
    wide_grid = Grid.between(grid.x_edges, grid.y_range, max(grid.cells_y // 2, 1))
    cumulative = np.pad(np.cumsum(field, axis=1), ((0, 0), (1, 0)))
    # The edge of a wide cell may cut a cell.
    edges = np.linspace(0, grid.cells_y, wide_grid.cells_y + 1)
    cell_sums = make_interp_spline(np.arange(grid.cells_y + 1), cumulative, k=1, axis=1)(edges)
    return wide_grid, np.diff(cell_sums, axis=1) * wide_grid.cells_y / grid.cells_y


def _under_roller(case: Case, grid: Grid, pressure: FloatArray) -> tuple[slice, tuple[float, float]]:
    """Columns that are loaded or under the roller, and positions of the roller's insulated ends at edges of columns."""
    if case.roller.ends == "none":
        return slice(0, grid.cells_x), (-np.inf, np.inf)
    roller_start, roller_end = case.roller_start, case.roller_start + case.roller.length
    edges = grid.x_edges
    # Rounding may place the centre of a loaded column beyond the end of the roller.
    under_roller = np.flatnonzero(((grid.x > roller_start) & (grid.x < roller_end)) | (pressure > 0).any(axis=1))
    first, stop = int(under_roller[0]), int(under_roller[-1]) + 1
    start = edges[first] if first > 0 else min(roller_start, edges[0])
    end = edges[stop] if stop < grid.cells_x else max(roller_end, edges[-1])
    return slice(first, stop), (float(start), float(end))


def _find_maximum(grid: Grid, rises: dict[str, FloatArray]) -> dict[str, float]:
    """Largest rise of both surfaces and its position, by a parabola through three cells along y."""
    hotter_rise = max(rises.values(), key=lambda rise: float(rise.max()))
    i, j = np.unravel_index(int(hotter_rise.argmax()), hotter_rise.shape)
    maximum, y = float(hotter_rise[i, j]), float(grid.y[j])
    if 0 < j < grid.cells_y - 1:
        before, after = hotter_rise[i, j - 1], hotter_rise[i, j + 1]
        curvature = before - 2 * maximum + after
        if curvature < 0:
            offset = 0.5 * (before - after) / curvature
            maximum, y = float(maximum - 0.25 * (before - after) * offset), float(y + offset * grid.dy)
    return {"max_temperature_rise": maximum, "max_temperature_rise_x": float(grid.x[i]), "max_temperature_rise_y": y}
