"""Accuracy and cells of the solution of a case; plans of studies use them without the solver."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import TypeVar

import numpy as np

from contactstudy import checks
from contactstudy.arrays.grid import MAX_CELLS, Grid, growing_edges
from contactstudy.bodies.models import FiniteLengthSpace
from contactstudy.case.case import Case
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError, WindowError

ACCURACY, TOLERANCE = 0.01, 1e-6  # Defaults: error over the peak, tolerance of the iteration. Accuracy.
ACCURACY_RANGE = (1e-3, 0.1)  # Range of the accuracy that the refinement can reach. Limit.


def check_accuracy(value: object) -> float:
    """Return an accuracy that the refinement can reach, or raise."""
    accuracy = checks.positive("accuracy", value)
    minimum, maximum = ACCURACY_RANGE
    if not minimum <= accuracy <= maximum:
        raise InvalidInputError("accuracy", accuracy, f"from {minimum:g} to {maximum:g} of the peak pressure")
    return accuracy


Result = TypeVar("Result")
Window = TypeVar("Window")  # A width, a grid, or None for columns that the solver refines
WINDOWS = (2.0, 3.0, 5.0, 8.0, *(12.0 * 1.5 ** np.arange(10)).tolist())
"""Default half-widths of the window over the Hertz half-width, tried in turn; the first is the default of
:func:`choose_grid`. A short or tilted contact is wider than the line contact of the same load; a ridge that carries the
load of the longest roller, of 1e7 half-widths, is 300 wide. Speed."""

MAX_CELL_INCREASE = 1.25  # Maximum cells over requested cells, for edges at an elastic roller's ends. Accuracy.


def graded_grid(case: Case, edges: FloatArray, y_range: tuple[float, float], cells_y: int) -> Grid:
    """Return a grid with columns between `edges` under the roller, and few cells beyond."""
    low, high = case.body.extent
    first_width, last_width = edges[1] - edges[0], edges[-1] - edges[-2]
    low_edges = edges[0] - growing_edges(edges[0] - low, first_width)[::-1]
    high_edges = edges[-1] + growing_edges(high - edges[-1], last_width)
    return Grid.between(np.concatenate([low_edges, edges, high_edges]), y_range, cells_y)


def choose_grid(
    case: Case, *, cells_x: float = 8, cells_y: float = 16, window: float = 2.0, margin: float = 4.0
) -> Grid:
    """Choose a uniform grid for a case.

    A finite body is tiled from end to end; beyond an open end the grid stops `margin` half-widths beyond the roller.
    The numbers of cells are rounded up to fast sizes of the Fourier transform; for an elastic roller of finite length,
    to the number with edges of cells nearest to its ends. A rigid roller's end moves to the nearest edge of cells, by
    at most half a cell.

    Parameters
    ----------
    case : Case
        The case.
    cells_x, cells_y : float
        Cells per Hertz half-width ``a`` along x and y, at least.
    window : float
        Half-width of the window in y, over ``a``.
    margin : float
        Distance over ``a`` from the roller to the grid's edge on a body without an end.

    Raises
    ------
    InvalidInputError
        If a setting is not positive, or the number of cells suggests a wrong unit.

    Examples
    --------
    >>> from contactstudy import Case, FiniteLengthSpace, Material, Roller
    >>> body = FiniteLengthSpace(length=1e-3, material=Material(210e9, 0.3))
    >>> choose_grid(Case(body=body, roller=Roller(radius=5e-3, length=1e-3), max_pressure=1.5e9)).shape
    (125, 64)
    """
    from scipy.fft import next_fast_len

    half_width = case.hertz_half_width
    half_window = checks.positive("window", window) * half_width
    margin_x = checks.not_negative("margin", margin) * half_width
    low, high = case.body.extent
    start, stop = case.roller_start, case.roller_start + case.roller.length
    x_range = (start - margin_x if np.isinf(low) else low, stop + margin_x if np.isinf(high) else high)
    min_counts = [
        max(4.0, float(np.ceil(span / half_width * checks.positive(name, cells) - 1e-9)))
        for name, span, cells in (("cells_x", x_range[1] - x_range[0], cells_x), ("cells_y", 2 * half_window, cells_y))
    ]
    if not min_counts[0] * min_counts[1] <= MAX_CELLS:
        allowed = f"such that there are at most {MAX_CELLS:.0e} cells, not {min_counts[0] * min_counts[1]:.1e}"
        hint = f"the Hertz half-width is {half_width:.3g} m: pressures are in Pa, loads in N, lengths in metres"
        raise InvalidInputError("cells_x, cells_y", (cells_x, cells_y), allowed, hint)
    counts = [next_fast_len(int(count), real=True) for count in min_counts]
    if isinstance(case.roller.body, FiniteLengthSpace):
        candidates = [counts[0]]
        while candidates[-1] < MAX_CELL_INCREASE * counts[0]:
            candidates.append(next_fast_len(candidates[-1] + 1))
        ends = (np.array(case.contact_range) - x_range[0]) / (x_range[1] - x_range[0])
        deviations = [np.abs(ends * count - np.round(ends * count)).max().round(3) for count in candidates]
        counts[0] = candidates[int(np.argmin(deviations))]
    return Grid(x_range=x_range, y_range=(-half_window, half_window), cells_x=counts[0], cells_y=counts[1])


def create_widening_grids(case: Case, *, cells_x: float = 8, cells_y: float = 16) -> Iterator[Grid]:
    """Yield grids of increasing windows."""
    for window in WINDOWS:
        yield choose_grid(case, cells_x=cells_x, cells_y=cells_y, window=window, margin=2 * window)


def solve_in_first_window(windows: Iterable[Window], solve: Callable[[Window], Result]) -> Result:
    """Return ``solve(window)`` of the first window or grid that contains the contact, or raise the last error."""
    last_error = WindowError("no grid for the contact")
    for window in windows:
        try:
            return solve(window)
        except WindowError as error:
            last_error = error
    raise last_error
