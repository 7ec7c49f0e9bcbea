"""Contact at a prescribed approach: the load that it takes is sought first, for window and columns follow from it."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from contactstudy.bodies import hertz
from contactstudy.bodies.models import EndedBody
from contactstudy.case.case import LARGEST_HALF_WIDTH, SMALLEST_HALF_WIDTH, Case
from contactstudy.case.doubts import changed
from contactstudy.case.gridding import columns_of
from contactstudy.checks import FloatArray
from contactstudy.contact.contact import Contact, Settings, contact_of
from contactstudy.contact.prescribed import Prescribed
from contactstudy.contact.settled import SettledContact, settled_contact, shape_on, with_contact

POWER, POWERS = 1.2, (1.0, 2.0)
"""Of the depth from first touch that the load is taken to follow while it is sought, at first and at least and at most:
10/9 for a line, 3/2 for a point contact. Speed."""

DEEPER, SHALLOWER, ROUNDS = 0.05, 0.005, 12
"""Parts of the depth by which a contact may be deeper or shallower for its columns and its window to serve a given
approach, and how often the load may be corrected until it does. Speed."""

ABOVE = 1.02
"""Factor on a corrected load: a deeper contact serves, a shallower one has too narrow a window. Speed."""

ROUGHLY, ROUGH_TOLERANCE = 0.1, 1e-4
"""Accuracy and tolerance of contacts that say how large a load is. Speed."""

ROOMIER = 1.5
"""Window over that of the contact where half as many cells along y are tried. Speed."""

SLICES, WIDTH_PART = 200, 0.3
"""Slices of a first guess of the load, and the half-width of each over that of the circle's cut with the top. Speed."""


class AtApproach(NamedTuple):
    """A contact at an approach.

    Attributes
    ----------
    case : Case
        The case under the load that the approach takes.
    settled : SettledContact
        The contact.
    """

    case: Case
    settled: SettledContact


def settled_at_approach(case: Case, accuracy: float, tolerance: float) -> AtApproach:
    """Contact of a case that prescribes its approach, on columns that settle its peak and end pressures.

    Raises
    ------
    WindowError
        If the contact is wider than the widest window.
    """
    assert case.approach is not None
    rough = pressed_to(_without_freed_ends(case), case.approach, _first_guess(case), ROUGHLY, ROUGH_TOLERANCE)
    return pressed_to(case, case.approach, rough.case.normal_load, accuracy, tolerance)


def pressed_to(case: Case, approach: float, load: float, accuracy: float, tolerance: float) -> AtApproach:
    """Contact of a case at an approach, whatever it prescribes itself; `load` is a first guess of what that takes."""
    power, before = POWER, (0.0, 0.0)
    for _ in range(ROUNDS):
        loaded = changed(case, load=load, max_pressure=None, approach=None)
        settled = settled_contact(loaded, accuracy, tolerance)
        shape = settled.contact.shape
        touch = float(shape.gap.values.min())
        depth, wanted = settled.contact.approach - touch, approach - touch
        if 1 - SHALLOWER <= depth / wanted <= 1 + DEEPER:
            break
        if 0 < before[1] != depth:
            power = float(np.clip(np.log(load / before[0]) / np.log(depth / before[1]), *POWERS))
        before = (load, depth)
        load *= ABOVE * (wanted / depth) ** power
    prescribed = Prescribed(approach=approach).checked(shape.gap.values, shape.grid)
    found = contact_of(shape._replace(prescribed=prescribed), Settings(tolerance))
    carried = changed(loaded, load=found.carried)
    return AtApproach(carried, with_contact(settled, found, carried))


def load_error(found: AtApproach) -> float:
    """Estimated error of the load that an approach takes, N: what coarser columns and half the cells along y change.

    Both are found at the same load without free ends, which are what takes longest to prepare.
    """
    contact, refined = found.settled.contact, found.settled.refined
    case, own = _without_freed_ends(found.case), contact.shape.grid
    # Half as many cells need more room, for they overlap the border of the contact by more.
    window = ROOMIER * own.y_range[0], ROOMIER * own.y_range[1]
    rows = int(ROOMIER * own.cells_y)

    def pressed(edges: FloatArray, cells_y: int, prescribed: Prescribed | None) -> Contact:
        shape = shape_on(case, columns_of(case, edges, window, cells_y), prescribed)
        return contact_of(shape._replace(coupled_friction=0.0), Settings(ROUGH_TOLERANCE))

    fine = pressed(refined.edges, rows, None)
    deep = Prescribed(approach=fine.approach)
    others = pressed(refined.first, rows, deep), pressed(refined.edges, rows // 2, deep)
    return sum(abs(other.carried - fine.carried) for other in others)


def _without_freed_ends(case: Case) -> Case:
    """Return a case whose ends are mirrored only: it is prepared at once."""
    body, roller = case.body, case.roller
    if isinstance(body, EndedBody) and body.model == "exact":
        body = replace(body, model="mirror")
    return changed(case, body=body, roller=replace(roller, ends="none"))


def _first_guess(case: Case) -> float:
    """Load of slices that are each a part as wide as where the undeformed shapes cut each other, N."""
    assert case.approach is not None
    start, stop = case.contact_range
    x = np.linspace(start, stop, SLICES + 1)
    depth = np.maximum(case.approach - case.lowest(x), 0.0)
    radius, modulus = case.roller.radius, case.modulus
    half_width = np.minimum(WIDTH_PART * np.sqrt(2 * radius * depth), LARGEST_HALF_WIDTH * radius)
    per_length = np.pi * modulus * half_width**2 / (4 * radius)  # Johnson, Contact Mechanics (1985), 4.43
    load = float(per_length.mean()) * (stop - start)
    least = hertz.line_load(SMALLEST_HALF_WIDTH * modulus, radius, modulus) * (stop - start)
    return max(load, least)
