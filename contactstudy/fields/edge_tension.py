"""Tension at the trailing edge of a sliding contact, where the stress along y has a cusp.

Outside the contact the tension falls like a square root of the distance from the edge (K. L. Johnson, Contact
Mechanics, 1985, section 7.1), so stresses near the edge miss the cusp. The traction of a cross-section is a
Chebyshev series ``sqrt(1 - t**2) sum c_n U_n(t)`` between its edges. In plane strain its tension is
``2 sum (-1)**n c_n g**(n + 1)`` with ``g = 1 + d - sqrt((1 + d)**2 - 1)`` at the distance d from the edge over the
half-width. The difference from the stress in the body is smooth, and extrapolated linearly from outside the contact.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import xarray as xr

from contactstudy.analysis.axes import single_case
from contactstudy.analysis.axial import EDGE_UNCERTAINTY, contact_borders
from contactstudy.analysis.provenance import solved_case
from contactstudy.arrays.grid import Grid, Points
from contactstudy.arrays.variables import STRESSES, describe, require, without_error
from contactstudy.checks import FloatArray, IntArray
from contactstudy.errors import InvalidInputError
from contactstudy.fields.loads import Loads, prescribed_loads
from contactstudy.fields.positions import Positions
from contactstudy.fields.stress import stresses_at
from contactstudy.kernels.load import Load

SERIES_TERMS = 4  # terms of the Chebyshev series; the last term enters the error. Accuracy.
FIT_DISTANCES = np.array([0.35, 0.5, 0.7, 1.0])  # over a; nearer stresses err by over 1e-3. Accuracy.
MIN_CELLS = 8  # least number of loaded cells across a section, for edges to a few hundredths of a cell. Accuracy.


class EdgeSections(NamedTuple):
    """Cross-sections of a contact, each with rows of cells outside of its trailing edge for the extrapolation."""

    grid: Grid
    sign: float  # direction of the traction along y: the trailing edge has the opposite direction
    columns: IntArray
    edges: FloatArray  # positions y of the trailing edges, metres
    half_widths: FloatArray  # metres
    rows: IntArray  # (section, distance): numbers of rows, also beyond the grid

    @classmethod
    def of(cls, grid: Grid, loads: Loads, gap: FloatArray, columns: IntArray | None = None) -> EdgeSections:
        """Sections in columns with enough loaded cells; default: under the largest pressures and in the middle."""
        pressure = loads[Load.NORMAL].values
        if columns is None:
            maxima, middle = pressure.max(axis=1), grid.cells_x // 2
            columns = np.array([maxima[:middle].argmax(), middle, middle + maxima[middle:].argmax()])
        columns = np.unique(columns)
        columns = columns[np.count_nonzero(pressure[columns], axis=1) >= MIN_CELLS]
        # Without friction the sections equal those of a traction along +y, and share their stresses under the pressure.
        sign = -1.0 if Load.ALONG_Y in loads and loads[Load.ALONG_Y].values.sum() < 0 else 1.0
        low, high = contact_borders(pressure[columns], grid.y, gap[columns])
        edges, half_widths = low if sign > 0 else high, 0.5 * (high - low)
        # All stresses at rows of cells take one evaluation.
        row_positions = sign * (edges - grid.y[0])[:, None] - half_widths[:, None] * FIT_DISTANCES
        rows = (sign * np.floor(row_positions / grid.dy + 1e-9)).astype(np.int64)
        return cls(grid, sign, columns, edges=edges, half_widths=half_widths, rows=rows)

    @property
    def points(self) -> Points:
        """Points on the top for the stresses of all sections."""
        y = self.grid.y[0] + self.grid.dy * np.unique(self.rows)
        return Points(self.grid.x[self.columns], y, np.zeros(1))

    def compute_tensions(self, loads: Loads, stresses: FloatArray, relative_error: float) -> xr.Dataset:
        """Tensions at the edges with errors, from the stresses (6, section, y, 1) at the points."""
        grid, traction, rows = self.grid, loads[Load.ALONG_Y].values, np.unique(self.rows)
        tensions, errors = np.zeros((2, self.columns.size))
        for section, (column, edge, half_width) in enumerate(
            zip(self.columns, self.edges, self.half_widths, strict=True)
        ):
            cell_width = grid.dy / half_width
            coefficients = _fit_series(
                self.sign * (grid.y - edge) / half_width - 1, cell_width, self.sign * traction[column]
            )
            section_rows = self.rows[section]
            distances = self.sign * (edge - grid.y[0] - grid.dy * section_rows) / half_width
            stress = stresses[STRESSES.index("sigma_yy"), section, np.searchsorted(rows, section_rows), 0]
            smooth_stress = stress - _plane_tension(coefficients, distances)
            intercept = np.polyfit(distances, smooth_stress, 1)[1]
            tensions[section] = _plane_tension(coefficients, np.zeros(1))[0] + intercept
            errors[section] = (
                abs(intercept - smooth_stress[0])
                + 2 * abs(coefficients[-1])
                + abs(tensions[section]) * (relative_error + EDGE_UNCERTAINTY * cell_width)
            )
        variables = {"edge_tension": tensions, "edge_tension_error": errors, "trailing_edge": self.edges}
        coordinates = {"x": grid.x[self.columns]}
        return describe(xr.Dataset({name: ("x", values) for name, values in variables.items()}, coords=coordinates))


def edge_tension(result: xr.Dataset, x: Positions | None = None) -> xr.Dataset:
    """Return the tension along y on the top of the body at the trailing edge of a sliding contact.

    Parameters
    ----------
    result : Dataset
        A result of :func:`contactstudy.solve` of one case in full sliding, with its inputs; stresses may be absent.
    x : sequence of float, optional
        Positions along the axis, metres, moved to the nearest column; default: mid-length and either half's peak.

    Returns
    -------
    Dataset
        Along x: `edge_tension` (Pa), the stress sigma_yy at the edge, `edge_tension_error`, and `trailing_edge` (m),
        the y of the edge; NaN for a section with less than 8 loaded cells. Mid-length of a long roller has
        ``2 f p0``, and the stress that the normal load causes. The error contains the uncertainty of the edge, the last
        term of the series, the extrapolation, and the relative error of `peak_pressure`.

    Raises
    ------
    InvalidInputError
        If the result has stick and slip, no friction, or no inputs.

    Examples
    --------
    >>> from contactstudy import Case, FiniteLengthSpace, Material, Roller, solve
    >>> body = FiniteLengthSpace(length=2e-3, material=Material(210e9, 0.3))
    >>> case = Case(body=body, roller=Roller(radius=5e-3, length=2e-3), max_pressure=1e9, friction=0.3)
    >>> tension = edge_tension(solve(case, accuracy=0.1, stresses=False), [1e-3]).edge_tension
    >>> round(float(tension[0]) / (2 * 0.3 * 1e9), 1)
    1.0
    """
    require(result, "pressure", "gap", "traction_y", argument="result")
    if "stick" in result:
        raise InvalidInputError("result", "a contact with stick and slip", "one in full sliding")
    body, case = solved_case(result).body, single_case(result)
    pressure, traction = case["pressure"], case["traction_y"]
    if not traction.values.any():
        raise InvalidInputError("result", "a contact without friction", "one in full sliding")
    grid, loads, _, shape = prescribed_loads(body, pressure, traction_y=traction, inside_cells=pressure)
    columns = None
    if x is not None:
        columns = np.abs(grid.x - np.atleast_1d(np.asarray(x, dtype=np.float64))[:, None]).argmin(axis=1)
    sections = EdgeSections.of(grid, loads, case["gap"].transpose("x", "y").values, columns)
    (stresses,) = stresses_at(body, loads, grid, [sections.points], shape)
    tensions = sections.compute_tensions(loads, stresses, _relative_error(case))
    return tensions if columns is None else tensions.reindex(x=grid.x[np.unique(columns)])


def label_largest_tension(result: xr.Dataset, sections: EdgeSections, loads: Loads, stresses: FloatArray) -> xr.Dataset:
    """Return the largest edge tension with its error and position."""
    tensions = sections.compute_tensions(loads, stresses, _relative_error(result))
    largest_tension = tensions.isel(x=int(tensions["edge_tension"].values.argmax()))
    names = {"edge_tension": "", "edge_tension_error": "_error", "x": "_x", "trailing_edge": "_y"}
    variables = {f"peak_edge_tension{suffix}": float(largest_tension[name]) for name, suffix in names.items()}
    return without_error(describe(xr.Dataset(variables)), "peak_edge_tension_x", "peak_edge_tension_y")


def _relative_error(case: xr.Dataset) -> float:
    """Relative error of a refined largest pressure; 0 on given cells and at singular ends."""
    if "peak_pressure_error" not in case or not np.isfinite(float(case["peak_pressure"])):
        return 0.0
    return float(case["peak_pressure_error"] / case["peak_pressure"])


def _plane_tension(coefficients: FloatArray, distance: FloatArray) -> FloatArray:
    """Tension of the series at distances from the edge over the half-width, Pa."""
    g = 1 + distance - np.sqrt((1 + distance) ** 2 - 1)
    n = np.arange(SERIES_TERMS)
    return np.asarray(2 * ((-1.0) ** n * coefficients * g[:, None] ** (n + 1)).sum(axis=-1))


def _fit_series(centres: FloatArray, cell_width: float, traction: FloatArray) -> FloatArray:
    """Chebyshev series of a traction along +y between -1 and 1, by least squares of the means of its cells."""
    points = centres[:, None] + cell_width * ((np.arange(40) + 0.5) / 40 - 0.5)
    angles = np.arccos(np.clip(points, -1.0, 1.0))
    # sqrt(1 - t**2) U_n(t) = sin((n + 1) arccos t)
    cell_means = np.stack([np.sin((n + 1) * angles).mean(axis=1) for n in range(SERIES_TERMS)], axis=1)
    return np.asarray(np.linalg.lstsq(cell_means, traction, rcond=None)[0])
