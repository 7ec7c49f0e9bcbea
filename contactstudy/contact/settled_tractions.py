"""Stick and slip on the columns of a settled contact, with as many cells along y as the forces need.

The columns are those of the normal contact. The tractions are found on half of its cells along y, then on all of them,
and on twice as many until forces and creepages no longer change by more than the accuracy. Their error is of first
order in the cells at most, so the last change covers that of the cells along y. To it comes what the columns leave.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import xarray as xr

from contactstudy.arrays.grid import Grid
from contactstudy.arrays.variables import describe
from contactstudy.case.case import Case
from contactstudy.case.motion import Rolling, Shift
from contactstudy.checks import FloatArray
from contactstudy.contact.frictional import AMPLITUDES, FrictionalContact, frictional_contact
from contactstudy.contact.nested import Coarser
from contactstudy.contact.settled import CELLS_Y, SettledContact, shape_on, with_contact

COLUMNS_SHARE = 0.5
"""Error that the columns leave, over the least error of the pressure; of full sliding's force and moment, and of work
and creepages themselves. Accuracy: without it one in ten of these errors was too small."""


class SettledTractions(NamedTuple):
    """A contact with stick and slip, and what is known of its accuracy.

    Attributes
    ----------
    found : FrictionalContact
        Pressure and tractions.
    settled : SettledContact
        The normal contact with what is known of its accuracy.
    stated : mapping of str to float
        Errors of forces, moment, work and unknown rigid motions, as named in results.
    is_settled : bool
        Whether the last changes of these were within the accuracy.
    """

    found: FrictionalContact
    settled: SettledContact
    stated: Mapping[str, float]
    is_settled: bool

    def errors(self) -> xr.Dataset:
        """Label the errors."""
        result = xr.Dataset({f"{name}_error": error for name, error in self.stated.items()})
        units = self.found.dataset()["friction_work"].attrs["units"]
        result["friction_work_error"].attrs["units"] = units
        if not self.is_settled:
            for error in result.values():
                error.attrs["comment"] = "more than the accuracy: the most cells along y were reached"
        return describe(result)


def settled_tractions(case: Case, settled: SettledContact, accuracy: float) -> SettledTractions:
    """Tractions of a case on the columns of its settled contact.

    Raises
    ------
    InvalidInputError
        If the friction is below zero, or a prescribed force exceeds that of full sliding.
    WindowError
        If the contact comes too close to the edge of the window.
    """
    rows = settled.contact.shape.grid.cells_y
    before = _on(case, settled, rows // 2, None)
    while True:
        found = _on(case, settled, rows, before)
        changes, scales = _values(found) - _values(before), _scales(case, found)
        wanted = [name not in _prescribed(case) for name in scales]
        within = bool((np.abs(changes) <= accuracy * np.array(list(scales.values())))[wanted].all())
        if within or rows >= CELLS_Y[-1]:
            break
        rows, before = 2 * rows, found
    # Forces and moments may be small differences of large ones; work and rigid motions are not.
    sizes = [
        size if name in ("force_x", "force_y", "moment_z") else min(size, abs(float(value)))
        for (name, size), value in zip(scales.items(), _values(found), strict=True)
    ]
    of_columns = COLUMNS_SHARE * settled.refined.least_error
    stated = {
        name: abs(float(change)) + of_columns * size
        for name, size, change, free in zip(scales, sizes, changes, wanted, strict=True)
        if free
    }
    return SettledTractions(found, with_contact(settled, found.contact, case), stated, within)


def _on(case: Case, settled: SettledContact, rows: int, before: FrictionalContact | None) -> FrictionalContact:
    """Contact on the settled columns with other cells along y, beginning from half as many."""
    assert isinstance(case.motion, Shift | Rolling)
    contact = settled.contact
    own = contact.shape.grid
    grid = own if rows == own.cells_y else Grid.between(own.x_edges, own.y_range, rows)
    friction = case.friction_on(grid.x)
    coarser = None
    if before is not None:
        pressed = before.contact
        coarser = Coarser(pressed.shape.grid, np.asarray(friction * pressed.pressure), before.tractions)
    return frictional_contact(
        shape_on(case, grid, contact.shape.prescribed),
        contact.settings,
        case.motion,
        friction,
        case.roller_middle,
        coupled=case.coupled,
        coarser=coarser,
    )


def _values(found: FrictionalContact) -> FloatArray:
    """Return what is to be settled, in the order of `_scales`."""
    tractions = found.tractions
    forces = (tractions.force_x, tractions.force_y, tractions.moment_z, tractions.work)
    return np.array([*forces, *tractions.rigid.values()])


def _scales(case: Case, found: FrictionalContact) -> dict[str, float]:
    """Sizes to which the accuracy of each value is related, by its name in results.

    Forces and moment: those of full sliding. Creepages: ``f a / R``, at which a line contact slides fully (Johnson,
    Contact Mechanics (1985), 8.45), shifts ``f a**2 / R``, or their own size if it is larger.
    """
    pressure, grid = found.contact.pressure, found.contact.shape.grid
    loads = case.friction_on(grid.x) * pressure * grid.weights * grid.cell_area
    arms = np.hypot((grid.x - case.roller_middle)[:, None], grid.y)
    slip = float(np.max(case.friction_on(grid.x))) * case.hertz_half_width / case.roller.radius
    force, moment = float(loads.sum()), float((loads * arms).sum())
    rolls = isinstance(case.motion, Rolling)
    usual = {"x": slip, "y": slip, "spin": slip * force / moment if moment else 0.0}
    if not rolls:
        usual = {name: each * case.hertz_half_width for name, each in usual.items()}
    names = AMPLITUDES[rolls]
    rigid = {name: max(abs(amount), usual[name]) for name, amount in found.tractions.rigid.items()}
    largest = max(abs(rigid["x"]), abs(rigid["y"]), rigid.get("spin", 0.0) * moment / force if force else 0.0)
    return {"force_x": force, "force_y": force, "moment_z": moment, "friction_work": force * largest} | {
        names[name]: size for name, size in rigid.items()
    }


def _prescribed(case: Case) -> set[str]:
    """Return what a case's motion prescribes, by its name in results."""
    motion = case.motion
    assert isinstance(motion, Shift | Rolling)
    names = AMPLITUDES[isinstance(motion, Rolling)]
    forces = {"x": "force_x", "y": "force_y", "spin": "moment_z"}
    return {forces[name] if name in motion.modes else names[name] for name in names}
