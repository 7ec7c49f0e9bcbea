"""Peak and end pressure and half-width of a contact with an estimate of their discretisation error, from two grids."""

from __future__ import annotations

import numpy as np
import xarray as xr

from contactstudy.analysis.axial import EDGE_UNCERTAINTY, contact_edges
from contactstudy.arrays.peaks import section_maxima
from contactstudy.arrays.variables import describe, labelled_cells
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError

# Assumed orders of convergence: of all values, and of extrapolated end pressures. Accuracy: measured orders are higher,
# 1.5 to 2 for smooth pressures and 0.86 at a flush end, so the estimate is conservative
ASSUMED_ORDER, END_ORDER = 1.0, 0.8
FITTED_COLUMNS = 3  # Columns of cells in the extrapolation to the end of the shape
RESOLVED_TURN = 0.9  # Largest turn of the shape between columns (`_largest_turn`) at which the columns resolve a peak
ENDS = "end_pressure_first", "end_pressure_last"
PRESSURES = "peak_pressure", *ENDS

SHARP_EDGE_ADVICE = (
    "no limit: the shape ends sharply inside the body's top, and the end's pressure grows with every finer grid; "
    "leave the grid out, for columns that are refined near the end, and for its law"
)


def discretisation_error(fine: xr.Dataset, coarse: xr.Dataset) -> xr.Dataset:
    """Return peak and end pressure and half-width of a contact, each with an estimate of its discretisation error.

    The estimate is the correction of Richardson's extrapolation with order 1, and with order 0.8 at the ends; at least
    the effect of an edge displaced by `EDGE_UNCERTAINTY` cells. It is infinite where the grids show no limit: for the
    peak and for a loaded sharp end inside the body's top; if the two grids differ by more than a fifth; for
    peak and ends if the shape turns too much between loaded columns. It does not cover an edge radius, or a top that
    continues, within half a cell of the end.

    Parameters
    ----------
    fine, coarse : Dataset
        The same contact on two grids, from `solve_contact` or `solve`: with `pressure`, `gap` (infinite beyond the
        shape), and for the shape `initial_gap` or `displacement_z`.

    Returns
    -------
    Dataset
        `peak_pressure` (Pa), between the cells across y, or at an end with more; `end_pressure_first` and
        `end_pressure_last` (Pa), the largest pressure across y extrapolated to the first and last end of the shape or
        the body, 0 without contact; `half_width_middle` (metres), in the middle between these ends (NaN without
        contact). All are values of the finer grid. Each has its ``<name>_error`` in the same unit; the peak error
        covers the ends; an infinite error has a `comment` with the reason and advice.

    Raises
    ------
    InvalidInputError
        If an argument is not such a Dataset, or the cells of `fine` are not smaller.

    Examples
    --------
    >>> from contactstudy import Case, FiniteLengthSpace, Grid, Material, Roller, solve
    >>> body = FiniteLengthSpace(length=0.5e-3, material=Material(210e9, 0.3))
    >>> case = Case(body=body, roller=Roller(radius=5e-3, length=0.5e-3), max_pressure=1.5e9)
    >>> cells = (Grid(x_range=(0, 0.5e-3), y_range=(-13e-5, 13e-5), cells_x=n, cells_y=n) for n in (64, 32))
    >>> fine, coarse = (solve(case, grid, stresses=False) for grid in cells)
    >>> result = discretisation_error(fine, coarse)
    >>> round(float(result.peak_pressure) / 1.5e9, 2), float(result.peak_pressure_error) < 0.01 * 1.5e9
    (1.02, True)
    """
    values, coarse_values = (_quantities(name, contact) for name, contact in (("fine", fine), ("coarse", coarse)))
    cells, coarse_cells = ((contact.sizes["x"], contact.sizes["y"]) for contact in (fine, coarse))
    ratio = min(cells[0] / coarse_cells[0], cells[1] / coarse_cells[1])
    if ratio <= 1:
        raise InvalidInputError(
            "coarse", f"{coarse_cells} cells", f"fewer in each direction than the fine grid's {cells}"
        )
    edge_error = EDGE_UNCERTAINTY * float(fine["y"][1] - fine["y"][0]) / values["half_width_middle"]
    # At a loaded end of the shape inside the body's top the pressure has no limit, so the peak has no limit either.
    axial = fine["pressure"].transpose("x", "y").values.max(axis=1)
    first, last = _shape_columns(fine)
    end_in_contact = (first > 0 and axial[first] > 0, last < axial.size - 1 and axial[last] > 0)
    singular_names = {name for name, is_loaded in zip(ENDS, end_in_contact, strict=True) if is_loaded}
    singular_names |= {"peak_pressure"} if singular_names else set()
    largest_turn = _largest_turn(fine)
    unresolved = {name for name in PRESSURES if values[name] > 0} if largest_turn > RESOLVED_TURN else set()

    def extrapolate(name: str) -> float:
        """Distance from the fine value to the limit of Richardson's extrapolation."""
        order = END_ORDER if name in ENDS else ASSUMED_ORDER
        return float(abs(values[name] - coarse_values[name]) / (ratio**order - 1))

    def estimate_error(name: str) -> float:
        value = abs(values[name])
        # Grids that differ by more than a fifth, or contain NaN, do not allow an estimate of the limit.
        has_limit = name not in singular_names | unresolved and abs(values[name] - coarse_values[name]) <= 0.2 * value
        return max(extrapolate(name), edge_error * value if np.isfinite(edge_error) else 0.0) if has_limit else np.inf

    errors = {name: estimate_error(name) for name in values}
    peak = values["peak_pressure"]
    for name in ENDS:
        # The peak's error covers an end pressure without a limit, if below the peak, by that end's correction.
        error = errors[name] if np.isfinite(errors[name]) or values[name] >= peak else extrapolate(name)
        errors["peak_pressure"] = max(errors["peak_pressure"], values[name] + error - peak)
    result = xr.Dataset()
    for name, value in values.items():
        result[name], result[f"{name}_error"] = value, errors[name]
        if name in singular_names:
            result[f"{name}_error"].attrs["comment"] = SHARP_EDGE_ADVICE
        elif np.isinf(errors[name]):
            columns, rows = cells
            reason = (
                "the cells are too coarse for the shape's turn" if name in unresolved else "the values do not converge"
            )
            advice = _advise(fine, 2.0 * max(1.0, largest_turn / RESOLVED_TURN) if name in unresolved else 2.0)
            result[f"{name}_error"].attrs["comment"] = f"{reason} on {columns} x {rows} cells: {advice}"
    result.attrs["cells"] = [f"{columns} x {rows}" for columns, rows in (cells, coarse_cells)]
    return describe(result, "contact quantities with their discretisation error")


def _shape_columns(contact: xr.Dataset) -> tuple[int, int]:
    """First and last column of cells where the shape faces the body."""
    under_roller = np.flatnonzero(np.isfinite(contact["gap"].transpose("x", "y").values).any(axis=1))
    if not under_roller.size:
        raise InvalidInputError("gap", "infinite everywhere", "finite where the shape can touch the body")
    return int(under_roller[0]), int(under_roller[-1])


def _largest_turn(contact: xr.Dataset) -> float:
    """Largest turn of the shape between columns, as the pressure that it causes over the peak; 0 without pressure."""
    first_column, last_column = _shape_columns(contact)
    cells = contact.isel(x=slice(first_column, last_column + 1))
    shape = cells["initial_gap"] if "initial_gap" in cells else cells["gap"] - cells["displacement_z"]
    heights, pressure = (array.transpose("x", "y").values for array in (shape, cells["pressure"]))
    x, y, axial = cells["x"].values, cells["y"].values, pressure.max(axis=1)
    in_contact = np.flatnonzero(axial)
    if x.size < 3 or not in_contact.size:
        return 0.0
    mid_column = (in_contact[0] + in_contact[-1]) // 2
    row = int(pressure[mid_column].argmax())
    farthest_row = int(np.abs(y - y[row]).argmax())
    curvature = 2 * (heights[mid_column, farthest_row] - heights[mid_column, row]) / (y[farthest_row] - y[row]) ** 2
    if not (curvature > 0 and axial[mid_column] > 0):
        return 0.0
    # In the middle column, p = E* a / (2 R) and w = pi p a / 2. A turn causes a pressure of modulus times angle.
    pressure_per_angle = np.pi * axial[mid_column] ** 2 / (curvature * pressure[mid_column].sum() * (y[1] - y[0]))
    # Far from the contact the displacement of an elastic roller varies little between columns.
    turns = np.pad(np.abs(np.diff(np.diff(heights[:, farthest_row]) / np.diff(x))), 1, mode="edge")
    return float((pressure_per_angle * turns * axial).max() / axial.max() ** 2)


def _advise(contact: xr.Dataset, factor: float) -> str:
    """Advice for coarse cells: refined columns, or more uniform cells."""
    remedy = "leave the grid out, for columns that are refined"
    x, y = (contact[axis].values for axis in ("x", "y"))
    widths = contact["x_width"].values if "x_width" in contact else np.diff(x)
    uniform = np.allclose(widths, widths[0], rtol=1e-6, atol=0.0)
    if "hertz_half_width" not in contact or not uniform:
        return f"{remedy}, or take {'twice' if factor == 2 else f'{factor:.2g} times'} as many"
    half_width = float(contact["hertz_half_width"])
    cells_x, cells_y = factor * half_width / widths[0], 2 * half_width / (y[1] - y[0])
    return f"{remedy}, or try choose_grid(case, cells_x={cells_x:.3g}, cells_y={cells_y:.3g})"


def _quantities(name: str, contact: xr.Dataset) -> dict[str, float]:
    """Peak, end pressures and half-width of one contact."""
    edges = contact_edges(contact)
    pressure, grid = labelled_cells(f"{name}.pressure", contact["pressure"])
    first_column, last_column = _shape_columns(contact)
    axial = section_maxima(pressure[first_column : last_column + 1])
    mid_length = 0.5 * (grid.x[first_column] + grid.x[last_column])
    end_pressures = _end_pressure(axial[:FITTED_COLUMNS]), _end_pressure(axial[: -FITTED_COLUMNS - 1 : -1])
    return {
        "peak_pressure": max(float(axial.max()), *end_pressures),
        **dict(zip(ENDS, end_pressures, strict=True)),
        "half_width_middle": float(np.interp(mid_length, grid.x, edges["half_width"].values)),
    }


def _end_pressure(pressures: FloatArray) -> float:
    """Pressure half a cell before the first column, extrapolated by a parabola; 0 if the first column is open."""
    if pressures[0] == 0:
        return 0.0
    loaded = pressures[: int((pressures > 0).cumprod().sum())]
    polynomial = np.polynomial.Polynomial.fit(np.arange(0.5, loaded.size), loaded, loaded.size - 1)
    return max(0.0, float(polynomial(0.0)))
