"""A case, from its contact to its provenance, in one Dataset."""

from __future__ import annotations

import logging
import time

import xarray as xr

from contactstudy import checks
from contactstudy.analysis.provenance import with_provenance
from contactstudy.arrays.grid import Grid
from contactstudy.arrays.variables import describe
from contactstudy.case.case import Case
from contactstudy.case.settings import ACCURACY, TOLERANCE, check_accuracy
from contactstudy.case.standing import check_balanced
from contactstudy.errors import InvalidInputError
from contactstudy.fields.positions import Positions
from contactstudy.interrupts import BriefInterrupt
from contactstudy.solution.contact_of_case import contact_on_cells, errors_on_cells, refined_contact
from contactstudy.solution.stresses_of_case import with_stresses, without_stresses

LOGGER = logging.getLogger(__name__)


def solve(
    case: Case,
    grid: Grid | None = None,
    *,
    accuracy: float | None = None,
    x: Positions | None = None,
    y: Positions | None = None,
    z: Positions | None = None,
    stresses: bool = True,
    roughness: xr.DataArray | None = None,
    error_estimate: bool = False,
    tolerance: float = TOLERANCE,
) -> xr.Dataset:
    """Solve a case: the contact, then the stresses in the body.

    Parameters
    ----------
    case : Case
        Body, roller, load and friction.
    grid : Grid, optional
        Cells of pressure and gap. Default: columns of different widths, refined along the axis until `accuracy` is
        reached; for rough surfaces the uniform cells of `choose_grid`.
    accuracy : float, optional
        Error, over the peak pressure, to which the peak and the pressures at the roller's ends are settled: from 0.001
        to 0.1; default 0.01. Where a sharp end makes the pressure singular, its law is stated instead. Not for given
        cells or rough surfaces, which are solved as they are.
    x, y : sequence of float, optional
        Positions of the stresses, metres; default: the cell centres.
    z : sequence of float, optional
        Depths of the stresses, metres; default: from 0 to 5 Hertz half-widths.
    stresses : bool
        Whether to compute the stresses at all.
    roughness : DataArray (x, y), optional
        Heights of the surfaces in metres, positive out of them, as from `contactstudy.roughness`: they are taken off
        the gap, interpolated linearly to the cell centres, which they must cover, if they lie on other cells.
    error_estimate : bool
        Whether to solve a contact on given cells on half of them as well, and state peak and end pressure and
        half-width with their discretisation error, see `contactstudy.analysis.discretisation.discretisation_error`.
    tolerance : float
        Tolerance of the contact, see `solve_contact`.

    Returns
    -------
    Dataset
        Everything that `solve_contact` and `stress_field` return, with `hertz_half_width`, `hertz_max_pressure` and
        `end_traction_residual`; with stick and slip, tractions and slip as from `solve_contact` instead of
        `traction_y`. Stresses at positions of their own have the dimensions ``(x_field, y_field, z)`` instead of
        ``(x, y, z)``. With stresses also the largest von Mises stress in the body, wherever the positions are:
        `peak_von_mises`, its error and its place ``_x``, ``_y``, ``_z``. On refined columns also `peak_pressure` (and
        ``_first`` and ``_last``, of either half), `end_pressure_first` and `end_pressure_last`, and the load on the
        last half-width, `end_load_first` and `end_load_last`, each with its error ``<name>_error``. At a singular end
        pressures are infinite, and `end_intensity_first` or `end_intensity_last` is K of ``p = K d**-m``, with its
        error, and `end_exponent_first` or `end_exponent_last` is m; `end_intensity` and `end_exponent` are those of the
        sharper end. With stick and slip, forces, moment, work and the creepages or shifts that are not prescribed have
        errors as well.
        Its attributes hold the case, the settings, the versions, and the seconds of each stage, see
        `contactstudy.analysis.solved_case`.

    Raises
    ------
    InvalidInputError
        If the grid does not fit the body, a position lies outside it, the roughness does not cover the grid, or
        a tilted roller touches within one Hertz half-width of its end only.
    WindowError
        If the contact reaches the edge of the grid given, or of the widest one that is tried.

    Examples
    --------
    >>> from contactstudy import Case, FiniteLengthSpace, Material, Roller
    >>> body = FiniteLengthSpace(length=0.5e-3, material=Material(210e9, 0.3))
    >>> case = Case(body=body, roller=Roller(radius=5e-3, length=0.5e-3), max_pressure=1.5e9)
    >>> result = solve(case, stresses=False)
    >>> bool(result.converged), round(float(result.peak_pressure / result.hertz_max_pressure), 2)
    (True, 1.02)
    """
    checks.instance("case", case, Case, "a Case")
    check_balanced(case)
    _check_cells(grid, roughness, accuracy, error_estimate)
    refines = grid is None and roughness is None
    tolerance = checks.positive("tolerance", tolerance)
    settings: dict[str, object] = {"tolerance": tolerance, "rough": roughness is not None}
    began = time.perf_counter()
    with BriefInterrupt():
        if refines:
            settings["accuracy"] = accuracy = check_accuracy(ACCURACY if accuracy is None else accuracy)
            found = refined_contact(case, accuracy, tolerance)
        else:
            found = contact_on_cells(case, grid, roughness, tolerance)
        result = found.dataset()
        if error_estimate and not refines:
            result = result.assign(errors_on_cells(case, found, result, tolerance).data_vars)
        contact_seconds = time.perf_counter() - began
        LOGGER.info("contact: %d x %d cells, %.2f s", *found.grid.shape, contact_seconds)
        if stresses:
            result = with_stresses(result, found.case, found.grid, found.loads, x, y, z)
        else:
            result = without_stresses(result, found.case, found.grid, found.loads)
        stages = {"contact": contact_seconds, "stresses": time.perf_counter() - began - contact_seconds}
        LOGGER.info("%s: %.2f s", "stresses" if stresses else "what is left on the ends", stages["stresses"])
        described = describe(result, "roller on an elastic body: contact and stresses")
        return with_provenance(described, case, {"cells": found.cells, **settings}, stages)


def _check_cells(grid: Grid | None, roughness: xr.DataArray | None, accuracy: float | None, estimate: bool) -> None:
    """Refuse settings that do not go with given cells or rough surfaces."""
    if grid is not None:
        checks.instance("grid", grid, Grid, "a Grid")
    if accuracy is not None and (grid is not None or roughness is not None):
        instead = "a grid is solved as it is" if grid is not None else "rough surfaces are solved on uniform cells"
        raise InvalidInputError("accuracy", accuracy, f"left out here: {instead}", "see error_estimate")
    if estimate and roughness is not None:
        raise InvalidInputError("error_estimate", True, "False with roughness, which other cells would not resolve")
