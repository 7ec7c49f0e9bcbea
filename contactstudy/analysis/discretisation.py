"""Peak, end pressure and half-width of a contact with an estimate of their discretisation error, from two grids."""

from __future__ import annotations

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.analysis.border import EDGE_UNCERTAINTY
from contactstudy.analysis.edges import contact_edges
from contactstudy.arrays.cells import labelled_cells
from contactstudy.arrays.variables import describe
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError

ASSUMED_ORDER = 1.0
"""Below the orders observed (1.5 to 2 where the pressure is smooth): the estimate errs on the high side. Accuracy."""

END_ORDER = 0.8
"""The same for the pressure at an end, which is extrapolated: beside a flush end 0.86 was observed. Accuracy."""

UNRESOLVED = 0.2
"""Two grids whose values differ by more than this fraction say nothing about the limit. Accuracy."""

FITTED = 3
"""Columns of cells that are extrapolated to the end of the shape. Accuracy."""

RESOLVED_TURN = 0.9
"""Columns from one to the next of which the shape turns by more, see `_turn`, may miss a peak. Accuracy."""

SAME_WIDTH = 1e-6
"""Widths of cells that differ by a smaller fraction are the same but for rounding."""

ENDS = "end_pressure_first", "end_pressure_last"
PRESSURES = "peak_pressure", *ENDS

SHARP = (
    "no limit: the shape ends sharply inside the body's top, and the pressure there grows with every finer grid; "
    "leave the grid out, for columns that are refined beside the end, and for its law"
)
"""What is said of an error that is infinite for every grid."""


def extrapolated(coarse: float, fine: float, order: float, ratio: float = 2.0) -> float:
    """Limit of a value that converges with a known order, from two grids (Richardson's extrapolation).

    Parameters
    ----------
    coarse, fine : float
        The value on two grids, any unit.
    order : float
        Order of convergence.
    ratio : float
        Cell size of the coarse grid over that of the fine one, more than 1.

    Returns
    -------
    float
        ``fine + (fine - coarse) / (ratio**order - 1)``, in the unit of the values.

    Raises
    ------
    InvalidInputError
        If a value is not finite, the order not positive or the ratio not more than 1.

    Examples
    --------
    >>> round(extrapolated(coarse=1 + 0.2**2, fine=1 + 0.1**2, order=2), 12)
    1.0
    """
    coarse, fine = checks.finite("coarse", coarse), checks.finite("fine", fine)
    order, ratio = checks.positive("order", order), checks.positive("ratio", ratio)
    if ratio <= 1:
        raise InvalidInputError("ratio", ratio, "more than 1")
    return float(fine + (fine - coarse) / (ratio**order - 1))


def discretisation_error(fine: xr.Dataset, coarse: xr.Dataset) -> xr.Dataset:
    """Peak and end pressure and half-width of a contact, each with an estimate of its discretisation error.

    The estimate is the correction of `extrapolated` with order 1, which is lower than the order observed where the
    pressure is smooth, and for the ends with order 0.8; it is never less than what an edge displaced by
    `EDGE_UNCERTAINTY` cells would cause. It is infinite where no grid gives a limit: where a sharp end of the shape
    inside the body's top is pressed, for the pressure there and the peak, which grow without bound as the cells
    shrink; where the two grids differ by more than a fifth; and for the peak and ends that are pressed where the shape
    turns so much from one pressed column to the next that the cells are too coarse for it, as for an edge radius. What
    the cells do not show is not covered: an edge radius, or a top that goes on, within half a cell of the end.

    Parameters
    ----------
    fine, coarse : Dataset
        The same contact solved on two grids, by `solve_contact` or `solve`: with `pressure`, `gap`, in which infinite
        values show where the shape ends, and for the shape `initial_gap` or `displacement_z`.

    Returns
    -------
    Dataset
        `peak_pressure` (Pa), between the cells by parabolas, or at an end where that is more; `end_pressure_first` and
        `end_pressure_last` (Pa), the largest pressure across y extrapolated to the first and last end of the shape or
        the body, 0 if the contact ends before; `half_width_middle` (metres), in the middle between these ends (NaN if
        open there). All are values of the finer grid. Beside each, ``<name>_error`` in the same unit, that of the peak
        so large that it covers what an end may have; where it is infinite, its attribute `comment` says why and what
        to try.

    Raises
    ------
    InvalidInputError
        If an argument is not such a Dataset, or `fine` has no smaller cells than `coarse`.

    Examples
    --------
    >>> from contactstudy import Case, FiniteLengthSpace, Grid, Material, Roller, solve
    >>> body = FiniteLengthSpace(length=0.5e-3, material=Material(210e9, 0.3))
    >>> case = Case(body=body, roller=Roller(radius=5e-3, length=0.5e-3), max_pressure=1.5e9)
    >>> fine, coarse = (
    ...     solve(case, Grid((0, 0.5e-3), (-13e-5, 13e-5), *cells), stresses=False) for cells in [(64, 64), (32, 32)]
    ... )
    >>> result = discretisation_error(fine, coarse)
    >>> round(float(result.peak_pressure) / 1.5e9, 2), float(result.peak_pressure_error) < 0.01 * 1.5e9
    (1.02, True)
    """
    measured = [_measured(name, contact) for name, contact in (("fine", fine), ("coarse", coarse))]
    cells = [(contact.sizes["x"], contact.sizes["y"]) for contact in (fine, coarse)]
    ratio = min(cells[0][0] / cells[1][0], cells[0][1] / cells[1][1])
    if ratio <= 1:
        raise InvalidInputError(
            "coarse", f"{cells[1]} cells", f"fewer in each direction than the fine grid's {cells[0]}"
        )
    step = float(fine["y"][1] - fine["y"][0])
    displaced = EDGE_UNCERTAINTY * step / measured[0]["half_width_middle"]
    unbounded, turn = _without_limit(fine), _turn(fine)
    missed = {name for name in PRESSURES if measured[0][name] > 0} if turn > RESOLVED_TURN else set()
    errors = {
        name: np.inf
        if name in unbounded | missed
        else _estimated_error(name, measured[1][name], value, ratio, displaced)
        for name, value in measured[0].items()
    }
    errors["peak_pressure"] = max(errors["peak_pressure"], _left_by_ends(measured[0], measured[1], errors, ratio))
    result = xr.Dataset()
    for name, value in measured[0].items():
        result[name], result[f"{name}_error"] = value, errors[name]
        if name in unbounded:
            result[f"{name}_error"].attrs["comment"] = SHARP
        elif np.isinf(errors[name]):
            columns, rows = cells[0]
            found = "the cells are too coarse for the shape's turn" if name in missed else "no limit in sight"
            advice = _finer(fine, 2.0 * max(1.0, turn / RESOLVED_TURN) if name in missed else 2.0)
            result[f"{name}_error"].attrs["comment"] = f"{found} on {columns} x {rows} cells: {advice}"
    result.attrs["cells"] = [f"{columns} x {rows}" for columns, rows in cells]
    return describe(result, "contact quantities with their discretisation error")


def _estimated_error(name: str, coarse: float, fine: float, ratio: float, displaced: float) -> float:
    """Error of `fine`; `displaced` is the relative change that an edge within its uncertainty causes."""
    if fine == 0 and coarse == 0:
        return 0.0
    if not (np.isfinite(fine) and np.isfinite(coarse)) or abs(fine - coarse) > UNRESOLVED * abs(fine):
        return np.inf
    floor = displaced * abs(fine) if np.isfinite(displaced) else 0.0
    return max(_correction(name, coarse, fine, ratio), floor)


def _correction(name: str, coarse: float, fine: float, ratio: float) -> float:
    """How far the limit may be from `fine`, by the order assumed for the quantity."""
    order = END_ORDER if name in ENDS else ASSUMED_ORDER
    return abs(extrapolated(coarse, fine, order, ratio) - fine)


def _left_by_ends(fine: dict[str, float], coarse: dict[str, float], errors: dict[str, float], ratio: float) -> float:
    """By how much an end may be above the peak; an end below it without a limit in sight by its last correction."""
    peak, found = fine["peak_pressure"], 0.0
    for name in ENDS:
        known = np.isfinite(errors[name]) or fine[name] >= peak
        error = errors[name] if known else _correction(name, coarse[name], fine[name], ratio)
        found = max(found, fine[name] + error - peak)
    return found


def _shape_columns(contact: xr.Dataset) -> tuple[int, int]:
    """First and last column of cells where the shape faces the body."""
    touchable = np.flatnonzero(np.isfinite(contact["gap"].transpose("x", "y").values).any(axis=1))
    if not touchable.size:
        raise InvalidInputError("gap", "infinite everywhere", "finite where the shape can touch the body")
    return int(touchable[0]), int(touchable[-1])


def _without_limit(contact: xr.Dataset) -> set[str]:
    """Name the pressures without a limit: where a pressed shape ends inside the body's top, and then the peak."""
    along = contact["pressure"].transpose("x", "y").values.max(axis=1)
    first, last = _shape_columns(contact)
    inside = first > 0, last < along.size - 1
    sharp = {name for name, column, ends in zip(ENDS, (first, last), inside, strict=True) if ends and along[column] > 0}
    return sharp | {"peak_pressure"} if sharp else sharp


def _turn(contact: xr.Dataset) -> float:
    """Largest turn of the shape from one column to the next, as the pressure that it may cause over the peak.

    That pressure is the modulus times the turn, in radians. The modulus is that of the middle column, where the load
    per length is w and the pressure is that of Hertz, p = E* a / (2 R) and w = pi p a / 2. A column counts by its
    pressure over the peak: where the contact leaves the shape smoothly, a turn makes no peak. 0 if nothing is pressed.
    """
    first, last = _shape_columns(contact)
    shape = contact["initial_gap"] if "initial_gap" in contact else contact["gap"] - contact["displacement_z"]
    heights = shape.transpose("x", "y").values[first : last + 1]
    pressure = contact["pressure"].transpose("x", "y").values[first : last + 1]
    x, y, along = contact["x"].values[first : last + 1], contact["y"].values, pressure.max(axis=1)
    pressed = np.flatnonzero(along)
    if x.size < 3 or not pressed.size:
        return 0.0
    middle = (pressed[0] + pressed[-1]) // 2
    top = int(pressure[middle].argmax())
    away = int(np.abs(y - y[top]).argmax())
    curvature = 2 * (heights[middle, away] - heights[middle, top]) / (y[away] - y[top]) ** 2
    if not (curvature > 0 and along[middle] > 0):
        return 0.0
    modulus = np.pi * along[middle] ** 2 / (curvature * pressure[middle].sum() * (y[1] - y[0]))
    # Far from the contact what is left of an elastic roller's displacement changes little from column to column.
    turns = np.pad(np.abs(np.diff(np.diff(heights[:, away]) / np.diff(x))), 1, mode="edge")
    return float((modulus * turns * along).max() / along.max() ** 2)


def _finer(contact: xr.Dataset, times: float) -> str:
    """Say what to try where cells are too coarse: refined columns, or more uniform cells, twice as many along y."""
    refined = "leave the grid out, for columns that are refined"
    x, y = (contact[axis].values for axis in ("x", "y"))
    widths = contact["x_width"].values if "x_width" in contact else np.diff(x)
    uniform = np.allclose(widths, widths[0], rtol=SAME_WIDTH, atol=0.0)
    if "hertz_half_width" not in contact or not uniform:
        return f"{refined}, or take {'twice' if times == 2 else f'{times:.2g} times'} as many"
    half_width = float(contact["hertz_half_width"])
    more = times * half_width / widths[0], 2 * half_width / (y[1] - y[0])
    return f"{refined}, or try choose_grid(case, cells_x={more[0]:.3g}, cells_y={more[1]:.3g})"


def _measured(name: str, contact: xr.Dataset) -> dict[str, float]:
    """Read the quantities off one contact."""
    edges = contact_edges(contact)
    pressure, grid = labelled_cells(f"{name}.pressure", contact["pressure"])
    first, last = _shape_columns(contact)
    along = np.array([_peak(pressure[column : column + 1]) for column in range(first, last + 1)])
    middle = 0.5 * (grid.x[first] + grid.x[last])
    ends = _at_end(along[:FITTED]), _at_end(along[: -FITTED - 1 : -1])
    return {
        "peak_pressure": max(_peak(pressure), *ends),
        "end_pressure_first": ends[0],
        "end_pressure_last": ends[1],
        "half_width_middle": float(np.interp(middle, grid.x, edges["half_width"].values)),
    }


def _at_end(nearest: FloatArray) -> float:
    """Pressure half a cell before the first of some neighbouring cells, by a parabola; 0 if that cell is open."""
    if nearest[0] == 0:
        return 0.0
    loaded = nearest[: int((nearest > 0).cumprod().sum())]
    fit = np.polynomial.Polynomial.fit(np.arange(0.5, loaded.size), loaded, loaded.size - 1)
    return max(0.0, float(fit(0.0)))


def _peak(pressure: FloatArray) -> float:
    """Largest pressure (x, y), between the cells by a parabola along each direction whose neighbours are loaded."""
    at = np.unravel_index(int(pressure.argmax()), pressure.shape)
    peak = highest = float(pressure[at])
    for axis in (0, 1):
        line = np.take(pressure, at[1 - axis], axis=1 - axis)
        i = int(at[axis])
        if 0 < i < line.size - 1 and line[i - 1] > 0 and line[i + 1] > 0:
            slope, bend = 0.5 * (line[i + 1] - line[i - 1]), line[i + 1] - 2 * highest + line[i - 1]
            if bend < 0:
                peak -= float(0.5 * slope**2 / bend)
    return peak
