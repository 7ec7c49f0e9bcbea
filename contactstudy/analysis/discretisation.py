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

UNRESOLVED = 0.2
"""Two grids whose values differ by more than this fraction say nothing about the limit. Accuracy."""

FITTED = 3
"""Columns of cells that are extrapolated to the end of the shape. Accuracy."""


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
    pressure is smooth, and never less than what an edge displaced by `EDGE_UNCERTAINTY` cells would cause. It is
    infinite where no grid gives a limit: for the pressure at a sharp end of the shape inside the body's top, and a
    peak there, which grow without bound as the cells shrink; and where the two grids differ by more than a fifth.

    Parameters
    ----------
    fine, coarse : Dataset
        The same contact solved on two grids, by `solve_contact` or `solve`: with `pressure`, `gap`, in which infinite
        values show where the shape ends.

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
    unbounded = _sharp_ends(fine, measured[0])
    errors = {
        name: np.inf if name in unbounded else _estimated_error(measured[1][name], value, ratio, displaced)
        for name, value in measured[0].items()
    }
    errors["peak_pressure"] = max(errors["peak_pressure"], _left_by_ends(measured[0], errors))
    result = xr.Dataset()
    for name, value in measured[0].items():
        result[name], result[f"{name}_error"] = value, errors[name]
        if name in unbounded:
            result[f"{name}_error"].attrs["comment"] = SHARP
        elif np.isinf(errors[name]):
            columns, rows = cells[0]
            comment = f"no limit in sight on {columns} x {rows} cells: {_finer(fine)}"
            result[f"{name}_error"].attrs["comment"] = comment
    result.attrs["cells"] = [f"{columns} x {rows}" for columns, rows in cells]
    return describe(result, "contact quantities with their discretisation error")


def _estimated_error(coarse: float, fine: float, ratio: float, displaced: float) -> float:
    """Error of `fine`; `displaced` is the relative change that an edge within its uncertainty causes."""
    if fine == 0 and coarse == 0:
        return 0.0
    if not (np.isfinite(fine) and np.isfinite(coarse)) or abs(fine - coarse) > UNRESOLVED * abs(fine):
        return np.inf
    floor = displaced * abs(fine) if np.isfinite(displaced) else 0.0
    return max(abs(extrapolated(coarse, fine, ASSUMED_ORDER, ratio) - fine), floor)


def _left_by_ends(measured: dict[str, float], errors: dict[str, float]) -> float:
    """By how much an end may be above the peak; the pressure of a lower end without a limit says nothing of it."""
    peak, found = measured["peak_pressure"], 0.0
    for name in ("end_pressure_first", "end_pressure_last"):
        if np.isfinite(errors[name]) or measured[name] >= peak:
            found = max(found, measured[name] + errors[name] - peak)
    return found


def _shape_columns(contact: xr.Dataset) -> tuple[int, int]:
    """First and last column of cells where the shape faces the body."""
    touchable = np.flatnonzero(np.isfinite(contact["gap"].transpose("x", "y").values).any(axis=1))
    if not touchable.size:
        raise InvalidInputError("gap", "infinite everywhere", "finite where the shape can touch the body")
    return int(touchable[0]), int(touchable[-1])


def _sharp_ends(contact: xr.Dataset, measured: dict[str, float]) -> set[str]:
    """Name the quantities without a limit: where a loaded shape ends inside the body's top."""
    along = contact["pressure"].transpose("x", "y").values.max(axis=1)
    first, last = _shape_columns(contact)
    sharp = set()
    if first > 0 and along[first] > 0:
        sharp.add("end_pressure_first")
    if last < along.size - 1 and along[last] > 0:
        sharp.add("end_pressure_last")
    at_first = "end_pressure_first" in sharp and along.argmax() < first + FITTED
    at_last = "end_pressure_last" in sharp and along.argmax() > last - FITTED
    at_end = any(measured[name] >= measured["peak_pressure"] for name in sharp)
    return sharp | {"peak_pressure"} if at_first or at_last or at_end else sharp


def _finer(contact: xr.Dataset) -> str:
    """Say what to try where cells are too coarse: refined columns, or twice as many uniform cells."""
    refined = "leave the grid out, for columns that are refined"
    steps = [np.diff(contact[axis].values) for axis in ("x", "y")]
    if "hertz_half_width" not in contact or not all(np.allclose(step, step[0]) for step in steps):
        return f"{refined}, or take twice as many"
    twice = [2 * float(contact["hertz_half_width"]) / step[0] for step in steps]
    return f"{refined}, or try choose_grid(case, cells_x={twice[0]:.3g}, cells_y={twice[1]:.3g})"


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
