"""Stick and slip on the columns of a refined contact, with as many cells along y as the forces need.

The columns are the columns of the normal contact. The tractions are solved on half of its cells along y, then on all,
and on twice as many until forces and creepages change by less than the accuracy. Their error is of first order in the
cells at most, so the last change bounds the error of the cells along y; the error of the columns is added.
"""

from __future__ import annotations

import numpy as np
import xarray as xr

from contactstudy.arrays.grid import Grid
from contactstudy.arrays.variables import describe
from contactstudy.case.case import Case
from contactstudy.case.motion import RESULTANTS, Rolling, Shift
from contactstudy.contact.refinement.refined_contact import CELLS_Y, RefinedContact, contact_shape, replace_contact
from contactstudy.contact.rolling.frictional_contact import AMPLITUDE_NAMES, FrictionalContact, frictional_contact
from contactstudy.contact.rolling.tractions import FrictionRequest

COLUMN_ERROR_FACTOR = 0.5
"""Error of the columns, over the least error of the pressure; relative to full sliding's force and moment, and to work
and creepages themselves. Accuracy: without this error one in ten of the stated errors was too small."""

MAX_COARSE_STEPS = 60
"""Bound on the Newton steps on half of the cells along y, whose tractions are a guess. Speed: in a few shifts the
active sets cycle on these cells, and converge on finer cells."""


def refine_tractions(
    case: Case, normal: RefinedContact, accuracy: float
) -> tuple[FrictionalContact, RefinedContact, xr.Dataset]:
    """Tractions of a case on the columns of its normal contact, the contact that they change, and their errors."""
    motion, rows = case.motion, normal.contact.shape.grid.cells_y
    assert isinstance(motion, Shift | Rolling)
    prescribed = {
        RESULTANTS[mode] if mode in motion.modes else name for mode, name in AMPLITUDE_NAMES[type(motion)].items()
    }
    previous = _contact_on_rows(case, normal, rows // 2, None)
    # FASTSIM's error is due to its model: its strips do not become accurate on finer cells.
    max_rows = rows if isinstance(motion, Rolling) and motion.model == "fastsim" else CELLS_Y[-1]
    while True:
        contact = _contact_on_rows(case, normal, rows, previous)
        scales = {name: scale for name, scale in _scales(case, contact).items() if name not in prescribed}
        values, previous_values = _values(contact), _values(previous)
        changes = {name: abs(values[name] - previous_values[name]) for name in scales}
        accurate = all(changes[name] <= accuracy * scale for name, scale in scales.items())
        if accurate or rows >= max_rows:
            break
        rows, previous = 2 * rows, contact
    column_error = COLUMN_ERROR_FACTOR * normal.refined.least_error
    errors = xr.Dataset()
    for name, scale in scales.items():
        # A force or a moment may be a small difference of large parts; work and rigid motions are not.
        size = scale if name in RESULTANTS.values() else min(scale, abs(values[name]))
        errors[f"{name}_error"] = changes[name] + column_error * size
        if not accurate:
            errors[f"{name}_error"].attrs["comment"] = (
                "above the accuracy: the largest number of cells along y was reached"
            )
    errors["friction_work_error"].attrs["units"] = "J/m" if isinstance(motion, Rolling) else "J"
    return contact, replace_contact(normal, contact.contact, case), describe(errors)


def _contact_on_rows(
    case: Case, normal: RefinedContact, rows: int, coarse_contact: FrictionalContact | None
) -> FrictionalContact:
    """Contact on the refined columns with `rows` cells along y, with `coarse_contact`, on half as many, as a guess."""
    assert isinstance(case.motion, Shift | Rolling)
    contact = normal.contact
    grid = contact.shape.grid
    if rows != grid.cells_y:
        grid = Grid.between(grid.x_edges, grid.y_range, rows)
    request = FrictionRequest(
        motion=case.motion,
        friction=case.friction_on(grid.x),
        reference_x=case.roller_middle,
        coupled=case.coupled,
        coarse=None if coarse_contact is None else coarse_contact.tractions,
        max_steps=MAX_COARSE_STEPS if coarse_contact is None else None,
    )
    return frictional_contact(contact_shape(case, grid, contact.shape.prescribed), contact.settings, request)


def _values(contact: FrictionalContact) -> dict[str, float]:
    """Values whose changes end the refinement, by name in results."""
    tractions = contact.tractions
    return {**tractions.resultants, "friction_work": tractions.work, **contact.rigid_motions}


def _scales(case: Case, contact: FrictionalContact) -> dict[str, float]:
    """Scale of the accuracy of each value, by name in results."""
    # Forces and moment have the scale of full sliding. Creepages have ``f a / R`` (Johnson, Contact Mechanics (1985),
    # 8.45) and shifts ``f a**2 / R``, or their own size if larger.
    pressure, grid = contact.contact.pressure, contact.contact.shape.grid
    loads = case.friction_on(grid.x) * pressure * grid.weights * grid.cell_area
    arms = np.hypot((grid.x - case.roller_middle)[:, None], grid.y)
    slip = float(np.max(case.friction_on(grid.x))) * case.hertz_half_width / case.roller.radius
    force, moment = float(loads.sum()), float((loads * arms).sum())
    sliding = {"x": slip, "y": slip, "spin": slip * force / moment if moment else 0.0}
    if not isinstance(case.motion, Rolling):
        sliding = {name: size * case.hertz_half_width for name, size in sliding.items()}
    rigid = {name: max(abs(amplitude), sliding[name]) for name, amplitude in contact.tractions.rigid.items()}
    largest = max(abs(rigid["x"]), abs(rigid["y"]), rigid.get("spin", 0.0) * moment / force if force else 0.0)
    named = zip(contact.rigid_motions, rigid.values(), strict=True)
    return {"force_x": force, "force_y": force, "moment_z": moment, "friction_work": force * largest, **dict(named)}
