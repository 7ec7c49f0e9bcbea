"""The whole case: contact, then stresses, in one Dataset."""

from __future__ import annotations

import logging
import time

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.analysis.discretisation import discretisation_error
from contactstudy.analysis.largest import settled_peak
from contactstudy.analysis.provenance import with_provenance
from contactstudy.arrays.grid import Grid
from contactstudy.arrays.variables import describe
from contactstudy.cache import ArrayKey
from contactstudy.case.case import Case
from contactstudy.case.doubts import changed
from contactstudy.case.gridding import choose_grid
from contactstudy.case.motion import Sliding
from contactstudy.case.roughness import heights_on
from contactstudy.case.settings import ACCURACY, TOLERANCE, check_accuracy
from contactstudy.case.standing import check_balanced, check_on_its_length, inclination
from contactstudy.checks import FloatArray
from contactstudy.contact.at_approach import ROUGH_TOLERANCE, ROUGHLY, AtApproach, load_error, settled_at_approach
from contactstudy.contact.contact import Contact, Settings, Shape, contact_of
from contactstudy.contact.frictional import FrictionalContact, frictional_contact, labelled
from contactstudy.contact.settled import prescribed_by, settled_contact, settled_values
from contactstudy.contact.settled_tractions import settled_tractions
from contactstudy.contact.solve import contact_dataset
from contactstudy.errors import InvalidInputError, WindowError
from contactstudy.fields.loads import TopLoad, sliding
from contactstudy.fields.positions import Positions, field_positions
from contactstudy.fields.prescribed import prescribed_loads
from contactstudy.fields.stress import contact_stresses, end_traction_residual, stress_dataset
from contactstudy.interrupts import BriefInterrupt
from contactstudy.kernels.load import Load

LOGGER = logging.getLogger(__name__)

DEPTHS = (0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.2, 1.4, 1.7, 2.0, 2.5, 3.0, 4.0, 5.0)
"""Default depths of the stresses, over the Hertz half-width."""

LEAST_CELLS = 8
"""Along each axis, for an estimate of the discretisation error."""

RESIDUAL_DEPTHS = (0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0)
"""Depths at which `end_traction_residual` looks at the ends, over the Hertz half-width."""

RESIDUAL_POSITIONS = (-1.1, -0.9, -0.5, 0.0, 0.5, 0.9, 1.1)
"""Positions along y, likewise."""

RESIDUAL_COVERS = (
    f"the largest at depths from {RESIDUAL_DEPTHS[0]} a to {RESIDUAL_DEPTHS[-1]} a and |y| up to "
    f"{RESIDUAL_POSITIONS[-1]} a; nearer to the top of a loaded end more is left, about 1e-4 at 0.01 a, 1e-3 at 0.004 a"
)
"""What it says and what it does not."""


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
    began = time.perf_counter()
    with BriefInterrupt():
        known = xr.Dataset()
        slides = isinstance(case.motion, Sliding)
        found: FrictionalContact | None = None
        cells = "refined" if grid is None and roughness is None else "chosen" if grid is None else "given"
        asked = case
        if cells != "refined" and accuracy is not None:
            instead = "a grid is solved as it is" if grid is not None else "rough surfaces are solved on uniform cells"
            raise InvalidInputError("accuracy", accuracy, f"left out here: {instead}", "see error_estimate")
        if grid is None and roughness is None:
            accuracy = check_accuracy(ACCURACY if accuracy is None else accuracy)
            at = _settled(case, accuracy, checks.positive("tolerance", tolerance))
            case, settled = at
            contact, known = _checked(case, settled.contact), settled_values(settled)
            if not slides:
                rubbed = settled_tractions(case, settled, accuracy)
                found, known = rubbed.found, settled_values(rubbed.settled).assign(rubbed.errors().data_vars)
                found.warn_unless_converged()
                contact = found.contact
            if asked.approach is not None:
                known["normal_load_error"] = load_error(at)
        elif grid is None:
            # At an approach the cells are those of the smooth roller, though the rough one carries another load.
            sized = case if case.approach is None else settled_at_approach(case, ROUGHLY, ROUGH_TOLERANCE).case
            contact = _contact(case, choose_grid(sized), roughness, tolerance)
        else:
            checks.instance("grid", grid, Grid, "a Grid")
            contact = _contact(case, grid, roughness, tolerance)
        if not slides and found is None:
            found = _with_tractions(case, contact)
            contact = found.contact
        case = _under_its_load(asked, contact)
        grid = contact.shape.grid
        result = _labelled(case, contact)
        loads = sliding(contact.pressure, case.friction_on(grid.x)) if found is None else found.loads
        if found is not None:
            result = labelled(result, found)
        result = result.assign(known.data_vars)
        if error_estimate and not known:
            if roughness is not None:
                raise InvalidInputError(
                    "error_estimate", True, "False with roughness, which other cells would not resolve"
                )
            result = result.assign(_discretisation_errors(case, asked, result, grid, tolerance).data_vars)
        contact_seconds = time.perf_counter() - began
        LOGGER.info("contact: %d x %d cells, %.2f s", *grid.shape, contact_seconds)
        half_width = case.hertz_half_width
        result = result.assign(
            initial_gap=(("x", "y"), contact.shape.gap.values.copy()),
            hertz_half_width=half_width,
            hertz_max_pressure=case.hertz_max_pressure,
        )
        looked_at = [half_width * np.array(places) for places in (RESIDUAL_POSITIONS, RESIDUAL_DEPTHS)]
        if stresses:
            depths = half_width * np.array(DEPTHS) if z is None else z
            positions = field_positions(case.body, grid, x, y, depths)
            field, residual, largest = contact_stresses(case.body, loads, grid, positions, *looked_at)
            if x is not None or y is not None:
                field = field.rename({"x": "x_field", "y": "y_field"})
            result = result.assign_coords(field.coords).assign(field.data_vars)
            result = result.assign(settled_peak(result, *largest).data_vars)
        else:
            residual = end_traction_residual(case.body, loads, grid, *looked_at)
        result["end_traction_residual"] = residual
        result["end_traction_residual"].attrs["comment"] = RESIDUAL_COVERS
        stages = {"contact": contact_seconds, "stresses": time.perf_counter() - began - contact_seconds}
        LOGGER.info("%s: %.2f s", "stresses" if stresses else "what is left on the ends", stages["stresses"])
        described = describe(result, "roller on an elastic body: contact and stresses")
        settings = {"cells": cells, "tolerance": float(tolerance), "rough": roughness is not None}
        if accuracy is not None:
            settings["accuracy"] = float(accuracy)
        return with_provenance(described, asked, settings, stages)


def _settled(case: Case, accuracy: float, tolerance: float) -> AtApproach:
    """Settled contact of a case, and the case under the load that it carries."""
    if case.approach is None:
        return AtApproach(case, settled_contact(case, accuracy, tolerance))
    return settled_at_approach(case, accuracy, tolerance)


def _discretisation_errors(case: Case, asked: Case, result: xr.Dataset, grid: Grid, tolerance: float) -> xr.Dataset:
    """Errors of a contact on given cells, from that on half of them."""
    if min(grid.shape) < LEAST_CELLS:
        raise InvalidInputError("grid", grid.shape, f"at least {LEAST_CELLS} cells each way for an error estimate")
    coarse = _labelled(case, _contact(asked, grid.coarsened(), None, tolerance))
    return discretisation_error(result.assign(hertz_half_width=case.hertz_half_width), coarse)


def _under_its_load(case: Case, contact: Contact) -> Case:
    """Return a case that prescribes its approach as one that prescribes the load that this takes."""
    return case if case.approach is None else changed(case, load=contact.carried, approach=None)


def _initial_gap(case: Case, grid: Grid, roughness: xr.DataArray | None) -> FloatArray:
    """Gap of a case before deformation, less the heights of its rough surfaces."""
    clearance = case.gap(grid)
    if not np.isfinite(clearance).any():
        raise InvalidInputError(
            "grid",
            grid.shape,
            f"such that a cell's centre lies under the roller, which faces the body over {case.contact_length:.3g} m",
            "move the roller by end_distance, or take more cells along x",
        )
    return clearance if roughness is None else clearance - heights_on(grid, roughness)


def _contact(case: Case, grid: Grid, roughness: xr.DataArray | None, tolerance: float) -> Contact:
    """Contact of a case on given cells."""
    gap = _initial_gap(case, grid, roughness)
    shape = Shape(
        case.body,
        grid,
        ArrayKey(gap),
        prescribed_by(case).checked(gap, grid),
        case.counterbody,
        case.coupled_friction,
    )
    try:
        contact = contact_of(shape, Settings(checks.positive("tolerance", tolerance)))
    except WindowError as error:
        advice = f"{error}; choose_grid(case, window=..., margin=...) makes a wider one"
        if not case.tilt and case.load_position is None:
            raise WindowError(advice) from error
        raise WindowError(f"{inclination(case)}, and so deep at the roller's end that {advice}") from error
    return _checked(case, contact)


def _with_tractions(case: Case, contact: Contact) -> FrictionalContact:
    """Tractions of a case that does not slide fully."""
    assert not isinstance(case.motion, Sliding)
    friction = case.friction_on(contact.shape.grid.x)
    found = frictional_contact(
        contact.shape, contact.settings, case.motion, friction, case.roller_middle, coupled=case.coupled
    )
    found.warn_unless_converged()
    return found


def _checked(case: Case, contact: Contact) -> Contact:
    """Return a contact that does not stand on the roller's end; warn unless it converged."""
    shape = contact.shape
    check_on_its_length(_under_its_load(case, contact), shape.grid, shape.gap.values, contact.pressure)
    contact.warn_unless_converged()
    return contact


def _labelled(case: Case, contact: Contact) -> xr.Dataset:
    """Label the contact of a case; its tilt includes the case's own."""
    grid = contact.shape.grid
    result = contact_dataset(contact, case.friction_on(grid.x), x=grid.x, y=grid.y)
    result["tilt"] = result["tilt"].copy(data=result["tilt"] + case.tilt)
    result["tilt"].attrs["centre"] = "the roller's mid-length" if case.load_position is None else "load_position"
    return result


def roller_stress(
    case: Case,
    pressure: xr.DataArray,
    x: Positions | None = None,
    y: Positions | None = None,
    z: Positions = (0.0,),
    *,
    traction_x: xr.DataArray | None = None,
    traction_y: xr.DataArray | None = None,
) -> xr.Dataset:
    """Stresses in an elastic roller.

    Parameters
    ----------
    case : Case
        The case; its roller has a material.
    pressure : DataArray (x, y)
        Contact pressure on the body's cells, Pa, as in the result of `solve`.
    x, y : sequence of float, optional
        Positions, metres: x from the roller's own end I, y as on the body; default: the roller's cell centres.
    z : sequence of float
        Depths into the roller, metres, not negative.
    traction_x, traction_y : DataArray (x, y), optional
        Tractions on the body, as in the result, if the roller does not slide fully.

    Returns
    -------
    Dataset
        As from `stress_field`. The traction on the roller is opposite to that on the body.

    Raises
    ------
    InvalidInputError
        If the roller is rigid, or an argument is of the wrong kind or outside the roller.

    Examples
    --------
    >>> from contactstudy import Case, FiniteLengthSpace, Material, Roller
    >>> steel = Material(210e9, 0.3)
    >>> body = FiniteLengthSpace(length=0.5e-3, material=steel)
    >>> case = Case(body=body, roller=Roller(radius=5e-3, length=0.5e-3, material=steel), max_pressure=1.5e9)
    >>> result = solve(case, y=[0.0], z=[5e-5])
    >>> inside = roller_stress(case, result.pressure, y=[0.0], z=[5e-5])  # two equal bodies carry equal stresses
    >>> bool(np.allclose(inside.von_mises.values, result.von_mises.values, rtol=1e-4))
    True
    """
    checks.instance("case", case, Case, "a Case")
    if case.counterbody is None:
        raise InvalidInputError("case.roller.material", None, "a Material: a rigid roller has no stresses")
    slides = isinstance(case.motion, Sliding)
    if not slides and (traction_x is None or traction_y is None):
        raise InvalidInputError(
            "traction_x, traction_y", None, "those of the result: they do not follow from the pressure"
        )
    grid, on_body, _ = prescribed_loads(case.body, pressure, 0.0, traction_x, traction_y)
    if slides and traction_y is None:
        on_body = {**on_body, **sliding(on_body[Load.NORMAL].cells, case.friction_on(grid.x))}
    body, own = case.counterbody.body, case.counterbody.own_grid(grid)
    loads = {
        load: TopLoad(case.counterbody.load_on(grid, top.cells), top.factor if load is Load.NORMAL else -top.factor)
        for load, top in on_body.items()
    }
    return stress_dataset(body, loads, own, field_positions(body, own, x, y, z))
