"""The contact of a case: on columns that are refined until it is settled, or on chosen or given cells."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.analysis.discretisation import discretisation_error
from contactstudy.arrays.grid import Grid
from contactstudy.cache import ArrayKey
from contactstudy.case.case import Case
from contactstudy.case.doubts import changed
from contactstudy.case.gridding import choose_grid
from contactstudy.case.motion import Sliding
from contactstudy.case.roughness import heights_on
from contactstudy.case.standing import check_on_its_length, inclination
from contactstudy.checks import FloatArray
from contactstudy.contact.at_approach import ROUGH_TOLERANCE, ROUGHLY, AtApproach, load_error, settled_at_approach
from contactstudy.contact.contact import Contact, Settings, Shape, contact_of
from contactstudy.contact.frictional import FrictionalContact, frictional_contact, labelled
from contactstudy.contact.settled import prescribed_by, settled_contact, settled_values
from contactstudy.contact.settled_tractions import settled_tractions
from contactstudy.contact.solve import contact_dataset
from contactstudy.errors import InvalidInputError, WindowError
from contactstudy.fields.loads import TopLoad, sliding
from contactstudy.kernels.load import Load

LEAST_CELLS = 8
"""Along each axis, for an estimate of the discretisation error."""

Cells = Literal["refined", "chosen", "given"]
"""Where the cells come from: refined to an accuracy, chosen for a rough surface, or given by the caller."""


@dataclass(frozen=True, eq=False)
class ContactOfCase:
    """Contact of a case.

    Attributes
    ----------
    case : Case
        The case, under the load that it carries if its approach is prescribed.
    cells : str
        Where the cells come from.
    contact : Contact
        The contact.
    tractions : FrictionalContact or None
        Stick and slip; none in full sliding.
    known : Dataset
        Values that are settled on refined columns, with their errors; empty on other cells.
    """

    case: Case
    cells: Cells
    contact: Contact
    tractions: FrictionalContact | None = None
    known: xr.Dataset = field(default_factory=xr.Dataset)

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
        """Label the contact, with what is known of it."""
        result = _labelled(self.case, self.contact)
        if self.tractions is not None:
            result = labelled(result, self.tractions)
        return result.assign(self.known.data_vars).assign(
            initial_gap=(("x", "y"), self.contact.shape.gap.values.copy()),
            hertz_half_width=self.case.hertz_half_width,
            hertz_max_pressure=self.case.hertz_max_pressure,
        )


def refined_contact(asked: Case, accuracy: float, tolerance: float) -> ContactOfCase:
    """Contact on columns that are refined until it is settled to an accuracy."""
    at = _settled(asked, accuracy, tolerance)
    contact, known, tractions = _checked(at.case, at.settled.contact), settled_values(at.settled), None
    if not isinstance(asked.motion, Sliding):
        rubbed = settled_tractions(at.case, at.settled, accuracy)
        tractions, known = rubbed.found, settled_values(rubbed.settled).assign(rubbed.errors().data_vars)
        tractions.warn_unless_converged()
        contact = tractions.contact
    if asked.approach is not None:
        known["normal_load_error"] = load_error(at)
    return ContactOfCase(_under_its_load(asked, contact), "refined", contact, tractions, known)


def contact_on_cells(asked: Case, grid: Grid | None, roughness: xr.DataArray | None, tolerance: float) -> ContactOfCase:
    """Contact on given cells, or on uniform ones chosen for the case."""
    cells: Cells = "chosen" if grid is None else "given"
    if grid is None:
        # At an approach the cells are those of the smooth roller, though the rough one carries another load.
        sized = asked if asked.approach is None else settled_at_approach(asked, ROUGHLY, ROUGH_TOLERANCE).case
        grid = choose_grid(sized)
    contact, tractions = _contact(asked, grid, roughness, tolerance), None
    if not isinstance(asked.motion, Sliding):
        friction = asked.friction_on(grid.x)
        tractions = frictional_contact(
            contact.shape, contact.settings, asked.motion, friction, asked.roller_middle, coupled=asked.coupled
        )
        tractions.warn_unless_converged()
        contact = tractions.contact
    return ContactOfCase(_under_its_load(asked, contact), cells, contact, tractions)


def errors_on_cells(asked: Case, found: ContactOfCase, result: xr.Dataset, tolerance: float) -> xr.Dataset:
    """Errors of a contact on given cells, from that on half of them."""
    grid = found.grid
    if min(grid.shape) < LEAST_CELLS:
        raise InvalidInputError("grid", grid.shape, f"at least {LEAST_CELLS} cells each way for an error estimate")
    return discretisation_error(result, _labelled(found.case, _contact(asked, grid.coarsened(), None, tolerance)))


def _settled(case: Case, accuracy: float, tolerance: float) -> AtApproach:
    """Settled contact of a case, and the case under the load that it carries."""
    if case.approach is None:
        return AtApproach(case, settled_contact(case, accuracy, tolerance))
    return settled_at_approach(case, accuracy, tolerance)


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
