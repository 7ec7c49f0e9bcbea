"""The whole case, contact and stresses, in one Dataset."""

from __future__ import annotations

import logging
import time
from dataclasses import dataclass, field, replace

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.analysis.peaks import label_largest_stress
from contactstudy.analysis.provenance import with_provenance
from contactstudy.arrays.grid import Grid
from contactstudy.arrays.variables import describe
from contactstudy.case.case import Case
from contactstudy.case.gridding import ACCURACY, TOLERANCE, check_accuracy, choose_grid
from contactstudy.case.magnitudes import check_balanced, check_contact_length, warn_of_magnitudes
from contactstudy.case.motion import Sliding
from contactstudy.contact.normal.contact import Contact, Settings, contact_of
from contactstudy.contact.refinement.refined_contact import (
    COARSE_ACCURACY,
    COARSE_TOLERANCE,
    approach_load_error,
    contact_at_approach,
    contact_shape,
    refine_contact,
    refine_tractions,
    refined_values,
)
from contactstudy.contact.rolling.frictional_contact import FrictionalContact, frictional_contact
from contactstudy.contact.rolling.tractions import FrictionRequest
from contactstudy.contact.solve import contact_dataset
from contactstudy.errors import InvalidInputError, WindowError
from contactstudy.fields.edge_tension import EdgeSections, label_largest_tension
from contactstudy.fields.loads import TopLoad, prescribed_loads, sliding
from contactstudy.fields.positions import Positions, default_columns, default_depths, field_positions
from contactstudy.fields.stress import contact_stresses, stress_dataset
from contactstudy.fields.stress_maximum import place_search
from contactstudy.kernels.load import Load
from contactstudy.roughness import heights_on

__all__ = ["roller_stress", "solve"]


@dataclass(frozen=True, kw_only=True, eq=False)
class CaseContact:
    """Contact of a case."""

    case: Case  # with the load in place of a prescribed approach
    contact: Contact
    tractions: FrictionalContact | None = None  # tractions with stick and slip; None in full sliding
    values: xr.Dataset = field(default_factory=xr.Dataset)  # of refined columns, with errors; empty on other cells

    def dataset(self) -> xr.Dataset:
        """Labelled contact with its values; `tilt` includes the tilt of the case."""
        case, grid = self.case, self.contact.shape.grid
        result = contact_dataset(self.contact, case.friction_on(grid.x), x=grid.x, y=grid.y)
        result["tilt"] = result["tilt"].copy(data=result["tilt"] + case.tilt)
        result["tilt"].attrs["centre"] = "the roller's mid-length" if case.load_position is None else "load_position"
        if self.tractions is not None:
            result = self.tractions.with_tractions(result)
        return result.assign(self.values.data_vars).assign(
            initial_gap=(("x", "y"), self.contact.shape.gap.values.copy()),
            hertz_half_width=case.hertz_half_width,
            hertz_max_pressure=case.hertz_max_pressure,
        )


def refined_case_contact(case: Case, accuracy: float, tolerance: float) -> CaseContact:
    """Contact on columns that are refined to an accuracy."""
    find_contact = refine_contact if case.approach is None else contact_at_approach
    refined = find_contact(case, accuracy, tolerance)
    loaded_case = _prescribe_load(case, refined.contact)
    contact, tractions, errors = _check_contact(case, refined.contact), None, xr.Dataset()
    load_error = {} if case.approach is None else {"normal_load_error": approach_load_error(loaded_case, refined)}
    if not isinstance(case.motion, Sliding):
        tractions, refined, errors = refine_tractions(loaded_case, refined, accuracy)
        tractions.warn_unless_converged()
        contact = tractions.contact
    values = refined_values(case, refined).assign(errors.data_vars).assign(load_error)
    return CaseContact(case=_prescribe_load(case, contact), contact=contact, tractions=tractions, values=values)


def contact_on_cells(case: Case, grid: Grid | None, roughness: xr.DataArray | None, tolerance: float) -> CaseContact:
    """Contact on given cells, or on uniform ones chosen for the case."""
    if grid is None:
        # At an approach the load of the smooth roller determines the cells; a rough roller carries another load.
        loaded_case = case
        if case.approach is not None:
            loaded_case = _prescribe_load(case, contact_at_approach(case, COARSE_ACCURACY, COARSE_TOLERANCE).contact)
        grid = choose_grid(loaded_case)
    clearance, tractions = case.gap(grid), None
    if not np.isfinite(clearance).any():
        length = f"{case.contact_length:.3g} m"
        allowed = f"such that a cell's centre lies under the roller, which faces the body over {length}"
        hint = "move the roller by end_distance, or take more cells along x"
        raise InvalidInputError("grid", grid.shape, allowed, hint)
    gap = clearance if roughness is None else clearance - heights_on(grid, roughness)
    try:
        contact = contact_of(contact_shape(case, grid, gap=gap), Settings(tolerance))
    except WindowError as error:
        advice = f"{error}; choose_grid(case, window=..., margin=...) makes a wider one"
        if not case.tilt and case.load_position is None:
            raise WindowError(advice) from error
        position = case.load_position
        cause = f"tilt = {case.tilt:g} rad" if position is None else f"load_position = {position:g} m"
        raise WindowError(f"{cause}, and so deep at the roller's end that {advice}") from error
    contact = _check_contact(case, contact)
    if not isinstance(case.motion, Sliding):
        request = FrictionRequest(
            motion=case.motion, friction=case.friction_on(grid.x), reference_x=case.roller_middle, coupled=case.coupled
        )
        tractions = frictional_contact(contact.shape, contact.settings, request)
        tractions.warn_unless_converged()
        contact = tractions.contact
    return CaseContact(case=_prescribe_load(case, contact), contact=contact, tractions=tractions)


def _prescribe_load(case: Case, contact: Contact) -> Case:
    """Case with a prescribed load in place of its approach."""
    return case if case.approach is None else replace(case, load=contact.carried_load, approach=None)


def _check_contact(case: Case, contact: Contact) -> Contact:
    """Contact; raises if only the end of the roller touches, warns unless it converged."""
    shape = contact.shape
    check_contact_length(_prescribe_load(case, contact), shape.grid, shape.gap.values, contact.pressure)
    contact.warn_unless_converged()
    return contact


RESIDUAL_DEPTHS = (0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0)  # of `end_traction_residual` over the half-width. Accuracy.
RESIDUAL_POSITIONS = (-1.1, -0.9, -0.5, 0.0, 0.5, 0.9, 1.1)  # its positions along y over the half-width. Accuracy.
RESIDUAL_COMMENT = (
    f"the largest at depths from {RESIDUAL_DEPTHS[0]} a to {RESIDUAL_DEPTHS[-1]} a and |y| up to "
    f"{RESIDUAL_POSITIONS[-1]} a; nearer to the top of a loaded end it is larger, about 1e-4 at 0.01 a, 1e-3 at 0.004 a"
)


def with_stresses(
    result: xr.Dataset, contact: CaseContact, x: Positions | None, y: Positions | None, z: Positions | None
) -> xr.Dataset:
    """Add the stresses, the largest stress and edge tension in the body, and the residual on the free ends."""
    # Default positions along x resolve the contact on refined columns, and equal the centres of chosen or given cells.
    case, refined, scale = contact.case, bool(contact.values), contact.case.hertz_half_width
    grid, pressure = contact.contact.shape.grid, contact.contact.pressure
    loads = contact.tractions.loads if contact.tractions else sliding(pressure, case.friction_on(grid.x))
    search = place_search(case.body, loads, grid, case.roller.material)
    is_loaded = np.asarray(pressure.any(axis=1))
    columns = default_columns(grid, case.body.extent, is_loaded, scale) if x is None and refined else x
    depths = default_depths(scale, search.peak_width) if z is None else z
    positions = field_positions(case.body, grid, columns, y, depths)
    end_yz = scale * np.array(RESIDUAL_POSITIONS), scale * np.array(RESIDUAL_DEPTHS)
    sections = EdgeSections.of(grid, loads, contact.contact.gap)
    slides_fully, is_singular = contact.tractions is None, np.isinf(float(result.get("peak_pressure", 0.0)))
    further_points = [sections.points] if sections.columns.size and slides_fully and not is_singular else []
    stresses = contact_stresses(case.body, loads, search, positions, end_yz=end_yz, further_points=further_points)
    field = stresses.field
    if refined or x is not None or y is not None:
        field = field.rename({"x": "x_field", "y": "y_field"})
    result = result.assign_coords(field.coords).assign(field.data_vars)
    extremes = label_largest_stress(result, *stresses.maximum).assign(end_traction_residual=stresses.end_residual)
    extremes["end_traction_residual"].attrs["comment"] = RESIDUAL_COMMENT
    if stresses.further_stresses and Load.ALONG_Y in loads:
        extremes = extremes.assign(label_largest_tension(result, sections, loads, *stresses.further_stresses).data_vars)
    return result.assign(extremes.data_vars)


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
        Largest error of the peak and the pressures at the roller's ends, over the peak pressure: from 0.001 to 0.1;
        default 0.01. A singular end has a law instead. Not for given cells or rough surfaces.
    x : sequence of float, optional
        Positions of the stresses, metres. Default: from one end face to the other, narrow at the faces and where the
        pressure changes; on chosen or given cells their centres.
    y : sequence of float, optional
        Positions of the stresses, metres; default: the cell centres.
    z : sequence of float, optional
        Depths of the stresses, metres; default: from 0 to 5 Hertz half-widths, narrow below the pressure's peak.
    stresses : bool
        Whether to compute the stresses.
    roughness : DataArray (x, y), optional
        Heights of the surfaces in metres, positive outward, as from `contactstudy.roughness`; on other cells they are
        interpolated linearly to the cell centres, which they must cover.
    tolerance : float
        Tolerance of the contact, see `solve_contact`.

    Returns
    -------
    Dataset
        Everything that `solve_contact` and `stress_field` return, with `hertz_half_width` and `hertz_max_pressure`.
        Stresses have the dimensions ``(x_field, y_field, z)``; ``(x, y, z)`` at the centres of given cells. With
        stresses also `end_traction_residual` and the largest von Mises stress in the body, independent of the
        positions: `peak_von_mises` and its position ``_x``, ``_y``, ``_z``; in full sliding with friction
        `peak_edge_tension`, see `contactstudy.fields.edge_tension`. On refined columns also `peak_pressure`
        and, for the ends ``_first`` and ``_last``, `end_pressure` and `end_load`, the load on the last half-width. At
        a singular end pressures are infinite; `end_intensity` is K and `end_exponent` m of ``p = K d**-m``. Estimated
        errors are ``<name>_error``. The attributes contain the case, the settings, the versions, and the seconds of
        each stage, see `contactstudy.analysis.solved_case`.

    Raises
    ------
    InvalidInputError
        If the grid does not fit the body, a position lies outside it, the roughness does not cover the grid, or
        a tilted roller touches within one Hertz half-width of its end only.
    WindowError
        If the contact reaches the edge of the grid, or of the widest window.

    Warns
    -----
    MagnitudeWarning
        If a value of the case suggests a mistake in the unit, such as a length in millimetres.

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
    warn_of_magnitudes(case)
    check_balanced(case)
    if grid is not None:
        checks.instance("grid", grid, Grid, "a Grid")
    if accuracy is not None and (grid is not None or roughness is not None):
        reason = "a grid" if grid is not None else "roughness"
        raise InvalidInputError("accuracy", accuracy, f"omitted with {reason}: the cells are not refined")
    refines_cells = grid is None and roughness is None
    tolerance = checks.positive("tolerance", tolerance)
    cell_choice = "refined" if refines_cells else "chosen" if grid is None else "given"
    settings: dict[str, object] = {"cells": cell_choice, "tolerance": tolerance, "rough": roughness is not None}
    start = time.perf_counter()
    if refines_cells:
        settings["accuracy"] = accuracy = check_accuracy(ACCURACY if accuracy is None else accuracy)
        contact = refined_case_contact(case, accuracy, tolerance)
    else:
        contact = contact_on_cells(case, grid, roughness, tolerance)
    result = contact.dataset()
    contact_seconds = time.perf_counter() - start
    LOGGER.info("contact: %d x %d cells, %.2f s", *contact.contact.shape.grid.shape, contact_seconds)
    if stresses:
        result = with_stresses(result, contact, x, y, z)
    stages = {"contact": contact_seconds, "stresses": time.perf_counter() - start - contact_seconds}
    LOGGER.info("stresses: %.2f s", stages["stresses"])
    described_result = describe(result, "roller on an elastic body: contact and stresses")
    return with_provenance(described_result, case, settings, stages)


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
        Positions, metres: x from end I of the roller, y as on the body; default: the roller's cell centres.
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
    >>> import numpy as np
    >>> from contactstudy import Case, FiniteLengthSpace, Material, Roller, choose_grid, solve
    >>> steel = Material(210e9, 0.3)
    >>> body = FiniteLengthSpace(length=0.3e-3, material=steel)
    >>> case = Case(body=body, roller=Roller(radius=5e-3, length=0.3e-3, material=steel), max_pressure=1.5e9)
    >>> result = solve(case, choose_grid(case, cells_x=4, cells_y=8), x=[1e-4, 2e-4], y=[0.0], z=[5e-5])
    >>> inside = roller_stress(case, result.pressure, result.x_field, [0.0], [5e-5])  # equal bodies, equal stresses
    >>> bool(np.allclose(inside.von_mises.values, result.von_mises.values, rtol=1e-4))
    True
    """
    checks.instance("case", case, Case, "a Case")
    if case.counterbody is None:
        raise InvalidInputError("case.roller.material", None, "a Material: a rigid roller has no stresses")
    slides_fully = isinstance(case.motion, Sliding)
    if not slides_fully and (traction_x is None or traction_y is None):
        allowed = "those of the result: they do not follow from the pressure"
        raise InvalidInputError("traction_x, traction_y", None, allowed)
    grid, body_loads, *_ = prescribed_loads(case.body, pressure, 0.0, traction_x, traction_y)
    if slides_fully and traction_y is None:
        body_loads = {**body_loads, **sliding(body_loads[Load.NORMAL].cell_loads, case.friction_on(grid.x))}
    counterbody = case.counterbody
    roller_grid, loads = counterbody.grid_on_body(grid), {}
    for load, top in body_loads.items():
        factor = top.factor if load is Load.NORMAL else -top.factor
        loads[load] = TopLoad(counterbody.transfer_load(grid, top.cell_loads), factor)
    positions = field_positions(counterbody.body, roller_grid, x, y, z)
    return stress_dataset(counterbody.body, loads, roller_grid, positions, loads[Load.NORMAL].values)
