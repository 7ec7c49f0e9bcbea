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
from contactstudy.analysis.axial import EDGE_UNCERTAINTY, contact_edges
from contactstudy.analysis.contact import cut_ends
from contactstudy.analysis.provenance import INPUTS_ATTRIBUTE, attribute, solved_case
from contactstudy.arrays.variables import describe, require, without_error
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.fields.positions import Positions
from contactstudy.fields.stress import stress_field

SERIES_TERMS = 4  # terms of the Chebyshev series. Accuracy: the last one is part of the error.
FIT_DISTANCES = np.array([0.35, 0.5, 0.7, 1.0])  # over a: cells are accurate to 1e-3. Accuracy
MIN_CELLS = 8  # least number of loaded cells across a section, for edges accurate to a few hundredths of a cell


class _Section(NamedTuple):
    """Traction of a cross-section: its trailing edge, half-width, series, and the width of its cells."""

    edge: float
    half_width: float
    coefficients: FloatArray
    cell_width: float

    def plane_tension(self, distance: FloatArray | float) -> FloatArray:
        """Tension of the series at distances from the edge over the half-width, Pa."""
        g = (1 + np.asarray(distance)) - np.sqrt((1 + np.asarray(distance)) ** 2 - 1)
        n = np.arange(SERIES_TERMS)
        return np.asarray(2 * ((-1.0) ** n * self.coefficients * g[..., None] ** (n + 1)).sum(axis=-1))


def edge_tension(result: xr.Dataset, x: Positions | None = None) -> xr.Dataset:
    """Return the tension along y on the top of the body at the trailing edge of a sliding contact.

    Parameters
    ----------
    result : Dataset
        A result of :func:`contactstudy.solve` of one case in full sliding, with its inputs; stresses may be absent.
    x : sequence of float, optional
        Positions along the axis, metres, moved to the nearest column; default: the columns of the largest pressure of
        either half and mid-length.

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
    traction = case["traction_y"].transpose("x", "y").values
    if not traction.any():
        raise InvalidInputError("result", "a contact without friction", "one in full sliding")
    centres, column_maxima = case["x"].values, case["pressure"].transpose("x", "y").values.max(axis=1)
    if x is None:
        middle_column = centres.size // 2
        columns = np.unique(
            [
                int(column_maxima[:middle_column].argmax()),
                middle_column,
                middle_column + int(column_maxima[middle_column:].argmax()),
            ]
        )
    else:
        columns = np.unique(np.abs(centres - np.atleast_1d(np.asarray(x, dtype=np.float64))[:, None]).argmin(axis=1))
    edges, sign = contact_edges(case), float(np.sign(traction.sum()))
    relative_error = 0.0
    if "peak_pressure_error" in case and np.isfinite(float(case["peak_pressure"])):
        relative_error = float(case["peak_pressure_error"] / case["peak_pressure"])
    sections: dict[int, _Section] = {}
    for column in columns.tolist():
        limits = float(edges["y_left"][column]), float(edges["y_right"][column])
        if np.count_nonzero(traction[column]) >= MIN_CELLS and np.isfinite(limits).all():
            sections[column] = _section(
                sign * case["y"].values, sign * traction[column], sorted(sign * np.array(limits))
            )
    y = {column: sign * (section.edge - section.half_width * FIT_DISTANCES) for column, section in sections.items()}
    if sections:
        # One field for all sections: the end correction takes most of the time.
        stresses = stress_field(
            body,
            case["pressure"],
            x=centres[list(sections)],
            y=np.unique(np.concatenate(list(y.values()))),
            z=[0.0],
            traction_y=case["traction_y"],
        )
        tension_field = stresses["sigma_yy"].squeeze("z")
    tensions = np.full((3, columns.size), np.nan)
    for column, section in sections.items():
        stress = tension_field.sel(x=centres[column], y=y[column]).values
        smooth_stress = stress - section.plane_tension(FIT_DISTANCES)
        intercept = float(np.polyfit(FIT_DISTANCES, smooth_stress, 1)[1])
        tension = float(section.plane_tension(0.0)) + intercept
        error = (
            abs(intercept - smooth_stress[0])
            + 2 * abs(section.coefficients[-1])
            + abs(tension) * (relative_error + EDGE_UNCERTAINTY * section.cell_width / section.half_width)
        )
        tensions[:, columns == column] = np.array([[tension], [error], [sign * section.edge]])
    names = ("edge_tension", "edge_tension_error", "trailing_edge")
    variables = {name: ("x", values) for name, values in zip(names, tensions, strict=True)}
    return describe(xr.Dataset(variables, coords={"x": centres[columns]}))


def edge_tension_summary(dataset: xr.Dataset) -> xr.Dataset:
    """Largest edge tension of a solved case with its error and position; empty where :func:`edge_tension` has none."""
    slides_fully = {"pressure", "gap", "traction_y"} <= set(dataset.data_vars) and "stick" not in dataset
    if not slides_fully or not dataset["traction_y"].values.any() or any(cut_ends(dataset)):
        return xr.Dataset()
    if "case" not in attribute(dataset, INPUTS_ATTRIBUTE) or np.isinf(float(dataset.get("peak_pressure", 0))):
        return xr.Dataset()
    tension = edge_tension(dataset)
    if bool(tension["edge_tension"].isnull().all()):
        return xr.Dataset()
    largest_tension = tension.isel(x=int(np.nanargmax(tension["edge_tension"].values)))
    names = {"edge_tension": "", "edge_tension_error": "_error", "x": "_x", "trailing_edge": "_y"}
    variables = {f"peak_edge_tension{suffix}": float(largest_tension[name]) for name, suffix in names.items()}
    return without_error(describe(xr.Dataset(variables)), "peak_edge_tension_x", "peak_edge_tension_y")


def _section(y: FloatArray, traction: FloatArray, limits: list[float]) -> _Section:
    """Chebyshev series of the traction of a section along +y, by least squares of the means of its cells."""
    trailing_edge, leading_edge = limits
    half_width, centre = 0.5 * (leading_edge - trailing_edge), 0.5 * (trailing_edge + leading_edge)
    cell_width = abs(float(y[1] - y[0]))
    points = (y[:, None] + cell_width * ((np.arange(40) + 0.5) / 40 - 0.5) - centre) / half_width
    angles = np.arccos(np.clip(points, -1.0, 1.0))
    # sqrt(1 - t**2) U_n(t) = sin((n + 1) arccos t)
    cell_means = np.stack([np.sin((n + 1) * angles).mean(axis=1) for n in range(SERIES_TERMS)], axis=1)
    return _Section(trailing_edge, half_width, np.linalg.lstsq(cell_means, traction, rcond=None)[0], cell_width)
