"""Flash temperature of a solved contact: heat of friction, partition of the heat, and temperature of both surfaces.

The steady temperature of a moving surface is the integral of eq. (601) over the length of spreading s. For uniform heat
in a cell the integrand has one factor along each axis (docs/explanation/heat_and_wear.md); insulated ends mirror cells.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
import xarray as xr
from scipy.fft import fft, irfft, irfft2, next_fast_len, rfft, rfft2
from scipy.interpolate import make_interp_spline
from scipy.sparse.linalg import LinearOperator, gmres
from scipy.special import erf

from contactstudy import checks
from contactstudy.analysis.axes import single_case
from contactstudy.analysis.provenance import check_solved_for
from contactstudy.arrays.grid import Grid
from contactstudy.arrays.variables import describe, labelled_cells, require_in_si
from contactstudy.case.case import Case
from contactstudy.case.magnitudes import warn_of_values
from contactstudy.case.motion import Rolling, Shift, Sliding, SurfaceSpeeds
from contactstudy.checks import BoolArray, ComplexArray, FloatArray
from contactstudy.errors import ConvergenceWarning, InvalidInputError, TemperatureWarning


@dataclass(frozen=True, kw_only=True)
class ThermalProperties:
    """Thermal properties of a material, independent of its temperature.

    Parameters
    ----------
    conductivity : float
        Thermal conductivity, W/(m K).
    density : float
        Density, kg/m3.
    specific_heat : float
        Heat capacity of a unit of mass, J/(kg K).

    Raises
    ------
    InvalidInputError
        If a value is not a positive finite number.

    Warns
    -----
    MagnitudeWarning
        If a value lies outside its usual range, which suggests a wrong unit.

    Examples
    --------
    >>> steel = ThermalProperties(conductivity=46.0, density=7850.0, specific_heat=470.0)
    >>> round(1e6 * steel.diffusivity, 2)
    12.47
    """

    conductivity: float = field(metadata=checks.number(checks.positive, "W/(m K)"))
    density: float = field(metadata=checks.number(checks.positive, "kg/m3"))
    specific_heat: float = field(metadata=checks.number(checks.positive, "J/(kg K)"))

    def __post_init__(self) -> None:
        checks.store_numbers(self)
        warn_of_values(stacklevel=4, **vars(self))

    @property
    def diffusivity(self) -> float:
        """Thermal diffusivity ``kappa = lambda / (rho c)``, m2/s."""
        return self.conductivity / (self.density * self.specific_heat)


MAX_SPREADS = 6.5  # Lengths of spreading beyond which the heat of a cell vanishes: erfc(6.5) = 4e-20


def spread_nodes(min_width: float, cell_width: float, window: float, drift: float) -> tuple[FloatArray, FloatArray]:
    """Nodes and weights over the length of spreading s, in which heat moves by ``drift s**2 / 2``, drift in 1/m."""
    speed = abs(drift)
    # The integral ends when all heat has drifted beyond the window; at rest, at 1e8 windows, with a remainder of 1e-8.
    max_spread = 1e8 * window
    if speed:
        max_spread = min((MAX_SPREADS + np.sqrt(MAX_SPREADS**2 + 2 * speed * window)) / speed, max_spread)
    # Length of spreading below which the midpoint of the smallest cell keeps its heat
    min_spread = 0.125 * min_width
    panel_count = max(1, int(np.ceil(np.log(max_spread / min_spread) / np.log(2.0))))  # Ratio of neighbouring panels
    edges = [np.zeros(1), np.geomspace(min_spread, max_spread, panel_count + 1)]
    if speed:
        # Lengths of spreading at which the edge of a drifting cell passes the midpoint of another cell.
        crossings = np.sqrt(2 * cell_width * (np.arange(int(np.ceil(window / cell_width)) + 1) + 0.5) / speed)
        edges.append(crossings[crossings < max_spread])
    panel_edges = np.unique(np.concatenate(edges))
    panel_edges = panel_edges[np.concatenate([[True], np.diff(panel_edges) > 1e-9 * panel_edges[1:]])]
    # Gauss points in each panel of the integral over the length of spreading
    points, weights = np.polynomial.legendre.leggauss(6)
    half_widths = 0.5 * np.diff(panel_edges)
    midpoints = 0.5 * (panel_edges[1:] + panel_edges[:-1])
    return (midpoints[:, None] + half_widths[:, None] * points).ravel(), (half_widths[:, None] * weights).ravel()


def lateral_factors(spread: FloatArray, distance: FloatArray, cell_width: float, drift: float) -> FloatArray:
    """Fraction of a cell's heat density that remains at distances along y from its midpoint: (spread, distance)."""
    s = spread[:, None]
    offset = distance[None, :] - 0.5 * drift * s**2
    return np.asarray(0.5 * (erf((offset + 0.5 * cell_width) / s) - erf((offset - 0.5 * cell_width) / s)))


def axial_factors(spread: FloatArray, x: FloatArray, edges: FloatArray, ends: tuple[float, float]) -> FloatArray:
    """Fraction at positions `x` of the heat density of cells between `edges`: array (spread, x, cell)."""
    length = ends[1] - ends[0]
    primitives = _primitive(spread, x[:, None] - edges[None, :], length)
    if np.isfinite(ends[0]):
        primitives = primitives - _primitive(spread, x[:, None] + edges[None, :] - 2 * ends[0], length)
    return np.asarray(primitives[..., :-1] - primitives[..., 1:])


def _primitive(spread: FloatArray, distance: FloatArray, length: float) -> FloatArray:
    """Primitive along x of the heat kernel; for a finite length also of the kernel's images at every second length."""
    distance = np.asarray(distance)
    s = spread.reshape(-1, *[1] * distance.ndim)
    if not np.isfinite(length):
        return np.asarray(0.5 * erf(distance / s))
    periods = np.round(distance / (2 * length))
    reduced_distance = distance - 2 * length * periods
    primitive = np.empty((spread.size, *distance.shape))
    # Length of spreading over the distance between two ends above which the cosine series replaces the images
    is_wide = spread >= 0.6 * length
    # The cosines decay like exp(-(m pi / L)**2 kappa t) with 4 kappa t = s**2
    if is_wide.any():
        # The first neglected term is ``exp(-(9 pi 0.6 / 2)**2)``.
        wavenumbers = np.arange(1, 9) * np.pi / length
        decay = np.exp(-0.25 * np.outer(spread[is_wide], wavenumbers) ** 2) / (wavenumbers * length)
        waves = np.sin(wavenumbers.reshape(-1, *[1] * distance.ndim) * reduced_distance)
        primitive[is_wide] = reduced_distance / (2 * length) + np.tensordot(decay, waves, axes=1)
    if not is_wide.all():
        short_spreads = spread[~is_wide]
        image_count = max(0, int(np.ceil((MAX_SPREADS * short_spreads.max() / length - 1) / 2)))
        shifts = 2 * length * np.arange(-image_count, image_count + 1)
        primitive[~is_wide] = sum(0.5 * erf((reduced_distance + shift) / s[~is_wide]) for shift in shifts)
    return primitive + periods


class MovingBody(NamedTuple):
    """Thermal properties, speed and ends of a body."""

    properties: ThermalProperties
    speed: float  # of its surface along +y relative to the contact, m/s
    ends: tuple[float, float]  # positions of the insulated ends, m; infinite where the body has no end

    @property
    def drift(self) -> float:
        """``V / (2 kappa)``, 1/m."""
        return self.speed / (2 * self.properties.diffusivity)


class SourceOperator:
    """Temperature rise (K) at the cells' midpoints, at one depth, from heat (W/m2) uniform in each cell."""

    def __init__(self, body: MovingBody, grid: Grid, columns: slice, depth: float = 0.0) -> None:
        self._columns, self._shape, self._uniform = columns, grid.shape, grid.uniform
        self._size_y = next_fast_len(2 * grid.cells_y - 1, real=True)  # padded, so that the wake does not return
        edges = grid.x_edges[columns.start : columns.stop + 1]
        x = grid.x[columns]
        length = body.ends[1] - body.ends[0]
        window = grid.dy * grid.cells_y
        # Below this Peclet number of the window a surface is at rest.
        if np.isfinite(length) and abs(body.drift) * window < 1e-6:
            allowed = "such that the surface of a body with two ends leaves the contact"
            hint = "a surface at rest gets hotter without limit, and the other body takes all heat: give partition"
            raise InvalidInputError("speed", body.speed, allowed, hint)
        spread, weights = spread_nodes(min(float(np.diff(edges).min()), grid.dy), grid.dy, window, body.drift)
        # eq. (601)
        weights = weights * np.exp(-((depth / spread) ** 2)) / (body.properties.conductivity * np.sqrt(np.pi))
        lags = np.arange(self._size_y)
        lags[lags >= grid.cells_y] -= self._size_y
        spectra = rfft(weights[:, None] * lateral_factors(spread, grid.dy * lags, grid.dy, body.drift), axis=-1)
        if not grid.uniform:
            pairs = x.size * edges.size
            self._spectra = {1: _sum_products(spread, spectra, pairs, lambda s: axial_factors(s, x, edges, body.ends))}
            return
        self._size_x = next_fast_len(2 * x.size - 1, real=True)
        offsets = np.arange(self._size_x)
        offsets[offsets >= x.size] -= self._size_x

        def compute_spectrum(distance: float) -> ComplexArray:
            """Fractions at distances along x from the midpoint of a cell and of its images in both ends."""
            lower, upper = (distance + grid.dx * offsets + side * grid.dx for side in (-0.5, 0.5))

            def compute_factors(s: FloatArray) -> FloatArray:
                return _primitive(s, upper, length) - _primitive(s, lower, length)

            return np.asarray(fft(_sum_products(spread, spectra, lower.size, compute_factors), axis=0))

        self._spectra = {1: compute_spectrum(0.0)}  # by the order of the cells along x
        if np.isfinite(body.ends[0]):
            # In reversed order cell j lies at x[-1] - dx j, and the cell's image in the end e at 2 e - x[-1] + dx j.
            self._spectra[-1] = compute_spectrum(x[0] + x[-1] - 2 * body.ends[0])

    def __call__(self, heat: FloatArray) -> FloatArray:
        """Temperature rise under `heat` on all cells of the grid; zero on columns beyond the body."""
        body_heat = heat[self._columns]
        rise = np.zeros(self._shape)
        if self._uniform:
            size = (self._size_x, self._size_y)
            rise_spectrum = sum(spectrum * rfft2(body_heat[::order], size) for order, spectrum in self._spectra.items())
            column_rises = irfft2(rise_spectrum, size)[: body_heat.shape[0]]
        else:
            line_spectra = rfft(body_heat, self._size_y, axis=-1)
            column_rises = irfft(np.einsum("xck,ck->xk", self._spectra[1], line_spectra), self._size_y, axis=-1)
        rise[self._columns] = column_rises[:, : self._shape[1]]
        return rise


def _sum_products(
    spread: FloatArray, spectra: ComplexArray, size: int, compute_factors: Callable[[FloatArray], FloatArray]
) -> ComplexArray:
    """Sum, over the lengths of spreading, of axial factors (`size` numbers) times spectra of lateral factors."""
    # Products of real numbers cost half as much as products of complex numbers.
    real_factors = np.ascontiguousarray(spectra).view(np.float64)
    sums: FloatArray = np.zeros(())
    step = max(1, 2**22 // size)  # Lengths of spreading in memory at a time
    for start in range(0, spread.size, step):
        chunk = slice(start, start + step)
        sums = sums + np.tensordot(compute_factors(spread[chunk]), real_factors[chunk], axes=(0, 0))
    return np.ascontiguousarray(sums).view(np.complex128)


class FrictionalHeat(NamedTuple):
    """Frictional heat on the cells, and the speeds of the surfaces relative to the contact."""

    density: FloatArray
    speeds: SurfaceSpeeds


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
        return FrictionalHeat(density, speeds)
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
    return FrictionalHeat(density, motion.speeds)


RESTART, MAX_RESTARTS = 60, 20  # Steps between restarts, and restarts
Response = Callable[[FloatArray], FloatArray]  # Temperature rise from heat


def partition_heat(
    body_response: Response, roller_response: Response, heat: FloatArray, in_contact: BoolArray
) -> tuple[FloatArray, float]:
    """Heat into the body with equal contact temperatures of both surfaces, and the temperatures' relative mismatch."""
    if not heat.any():  # surfaces of the same speed
        return np.zeros(heat.shape), 0.0

    body_rise, roller_rise = body_response(heat)[in_contact], roller_response(heat)[in_contact]
    fraction = roller_rise.max() / (body_rise.max() + roller_rise.max())  # Blok's: equal largest temperatures
    guess = fraction * heat[in_contact]
    count = guess.size

    def sum_rises(cell_heat: FloatArray) -> FloatArray:
        grid_heat = np.zeros(heat.shape)
        grid_heat[in_contact] = np.ravel(cell_heat)
        return np.asarray((body_response(grid_heat) + roller_response(grid_heat))[in_contact])

    operator = LinearOperator((count, count), matvec=sum_rises, dtype=np.float64)  # eq. (602)
    # Residual of the temperatures over the right-hand side at which the iteration stops
    heats, _ = gmres(operator, roller_rise, x0=guess, rtol=1e-9, restart=min(RESTART, count), maxiter=MAX_RESTARTS)
    max_rise = max(np.abs(roller_rise).max(), np.finfo(float).tiny)
    mismatch = float(np.abs(sum_rises(heats) - roller_rise).max() / max_rise)
    body_heat = np.zeros(heat.shape)
    body_heat[in_contact] = heats
    return body_heat, mismatch


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
    case_names = ("x", "y", "x_bounds", "x_width", "hertz_half_width", "hertz_max_pressure")
    case_variables = solution[[name for name in case_names if name in solution.variables]].drop_attrs(deep=False)
    temperatures = case_variables.assign(values | scalars)
    if depths is not None:
        moving_body, columns = MovingBody(body, heat.speeds.body, case.body.extent), slice(0, grid.cells_x)
        depth_rises = [SourceOperator(moving_body, grid, columns, float(depth))(into_body) for depth in depths]
        temperatures = temperatures.assign_coords(z=depths)
        temperatures["body_temperature_rise"] = (("x", "y", "z"), np.stack(depth_rises, axis=-1))
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
    body_rise = SourceOperator(MovingBody(body, heat.speeds.body, case.body.extent), grid, slice(0, grid.cells_x))
    if roller is None:
        assert fraction is not None
        return {"temperature_rise": body_rise(fraction * heat.density)}, fraction * heat.density, np.nan
    columns, ends = _under_roller(case, grid, pressure)
    roller_rise = SourceOperator(MovingBody(roller, heat.speeds.roller, ends), grid, columns)
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
    first_column, stop_column = int(under_roller[0]), int(under_roller[-1]) + 1
    start = edges[first_column] if first_column > 0 else min(roller_start, edges[0])
    end = edges[stop_column] if stop_column < grid.cells_x else max(roller_end, edges[-1])
    return slice(first_column, stop_column), (float(start), float(end))


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
