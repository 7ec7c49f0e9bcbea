"""Contact of a case, on refined columns, or on chosen or given cells."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.grid import Grid
from contactstudy.cache import ArrayKey
from contactstudy.case.case import Case
from contactstudy.case.gridding import choose_grid
from contactstudy.case.magnitudes import check_on_its_length, inclination
from contactstudy.case.motion import Sliding
from contactstudy.checks import FloatArray
from contactstudy.contact.normal.contact import Contact, Settings, Shape, contact_of
from contactstudy.contact.refinement.refined_contact import (
    ROUGH_TOLERANCE,
    ROUGHLY,
    ApproachContact,
    approach_load_error,
    contact_at_approach,
    prescribed_load,
    refine_contact,
    refined_values,
)
from contactstudy.contact.refinement.refined_tractions import refine_tractions
from contactstudy.contact.rolling.frictional_contact import (
    FrictionalContact,
    FrictionRequest,
    frictional_contact,
    with_tractions,
)
from contactstudy.contact.solve import contact_dataset
from contactstudy.errors import InvalidInputError, WindowError
from contactstudy.fields.loads import TopLoad, sliding
from contactstudy.kernels.load import Load
from contactstudy.roughness import heights_on

Cells = Literal["refined", "chosen", "given"]
"""Origin of the cells: refined to an accuracy, chosen for a rough surface, or given by the caller."""


@dataclass(frozen=True, eq=False)
class CaseContact:
    """Contact of a case."""

    case: Case  # the case; a prescribed approach is replaced by the load
    cells: Cells  # origin of the cells
    contact: Contact  # the contact
    tractions: FrictionalContact | None = None  # stick and slip; none in full sliding
    values: xr.Dataset = field(default_factory=xr.Dataset)
    """Values of refined columns with their errors; empty on other cells."""

    @property
    def grid(self) -> Grid:
        """Cells of the contact."""
        return self.contact.shape.grid

    @property
    def loads(self) -> Mapping[Load, TopLoad]:
        """Loads on the body."""
        if self.tractions is not None:
            return self.tractions.loads
        return sliding(self.contact.pressure, self.case.friction_on(self.grid.x))

    def dataset(self) -> xr.Dataset:
        """Labelled contact with its values."""
        result = _labelled(self.case, self.contact)
        if self.tractions is not None:
            result = with_tractions(result, self.tractions)
        return result.assign(self.values.data_vars).assign(
            initial_gap=(("x", "y"), self.contact.shape.gap.values.copy()),
            hertz_half_width=self.case.hertz_half_width,
            hertz_max_pressure=self.case.hertz_max_pressure,
        )


def refined_case_contact(case: Case, accuracy: float, tolerance: float) -> CaseContact:
    """Contact on columns that are refined to an accuracy."""
    if case.approach is None:
        solution = ApproachContact(case, refine_contact(case, accuracy, tolerance))
    else:
        solution = contact_at_approach(case, accuracy, tolerance)
    loaded, normal = solution
    contact, values, tractions = _checked(loaded, normal.contact), refined_values(normal), None
    if not isinstance(case.motion, Sliding):
        refined = refine_tractions(loaded, normal, accuracy)
        tractions, values = refined.contact, refined_values(refined.normal).assign(refined.error_dataset().data_vars)
        tractions.warn_unless_converged()
        contact = tractions.contact
    if case.approach is not None:
        values["normal_load_error"] = approach_load_error(solution)
    return CaseContact(_with_load(case, contact), "refined", contact, tractions, values)


def contact_on_cells(case: Case, grid: Grid | None, roughness: xr.DataArray | None, tolerance: float) -> CaseContact:
    """Contact on given cells, or on uniform ones chosen for the case."""
    cells: Cells = "chosen" if grid is None else "given"
    if grid is None:
        # At an approach the smooth roller determines the cells; the rough one carries another load.
        loaded = case if case.approach is None else contact_at_approach(case, ROUGHLY, ROUGH_TOLERANCE).case
        grid = choose_grid(loaded)
    contact, tractions = _contact(case, grid, roughness, tolerance), None
    if not isinstance(case.motion, Sliding):
        request = FrictionRequest(
            motion=case.motion,
            friction=case.friction_on(grid.x),
            middle=case.roller_middle,
            coupled=case.coupled,
        )
        tractions = frictional_contact(contact.shape, contact.settings, request)
        tractions.warn_unless_converged()
        contact = tractions.contact
    return CaseContact(_with_load(case, contact), cells, contact, tractions)


def _with_load(case: Case, contact: Contact) -> Case:
    """Case with a prescribed load in place of its approach."""
    return case if case.approach is None else replace(case, load=contact.carried, approach=None)


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
        prescribed_load(case).checked(gap, grid),
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


def _checked(case: Case, contact: Contact) -> Contact:
    """Contact; raises if the roller touches with its end only, warns unless it converged."""
    shape = contact.shape
    check_on_its_length(_with_load(case, contact), shape.grid, shape.gap.values, contact.pressure)
    contact.warn_unless_converged()
    return contact


def _labelled(case: Case, contact: Contact) -> xr.Dataset:
    """Labelled contact of a case; `tilt` includes the tilt of the case."""
    grid = contact.shape.grid
    result = contact_dataset(contact, case.friction_on(grid.x), x=grid.x, y=grid.y)
    result["tilt"] = result["tilt"].copy(data=result["tilt"] + case.tilt)
    result["tilt"].attrs["centre"] = "the roller's mid-length" if case.load_position is None else "load_position"
    return result
