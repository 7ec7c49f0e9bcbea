"""Contacts at pairs of approach and tilt, each on columns of its own."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from contactstudy.bearing.energy_spline import FitErrors, Nodes
from contactstudy.case.case import Case
from contactstudy.case.doubts import changed
from contactstudy.checks import FloatArray
from contactstudy.contact.at_approach import POWER, pressed_to
from contactstudy.contact.contact import Contact
from contactstudy.contact.settled import settled_contact
from contactstudy.contact.solve import motion_reference
from contactstudy.errors import InvalidInputError, WindowError

LOGGER = logging.getLogger(__name__)

FINER = 4.0
"""By how much finer the contacts are whose difference from the nodes is stated as discretisation error."""

MIRRORED = 1e-9
"""Part of the length, or of the drop, by which two halves may differ and still be mirror images. Accuracy."""


class Node(NamedTuple):
    """One contact: N, N m and J."""

    load: float
    moment: float
    energy: float


@dataclass(frozen=True)
class Presser:
    """Presses the roller of a case to given approaches and tilts.

    Attributes
    ----------
    case : Case
        Body and roller.
    accuracy : float
        To which the peak pressure of each contact is settled.
    tolerance : float
        Of each contact's iteration.
    """

    case: Case
    accuracy: float
    tolerance: float

    @property
    def reference(self) -> str:
        """What approach and tilt are relative to."""
        return motion_reference(self.case.body, self.case.counterbody)

    def loaded(self, load: float, tilt: float) -> Contact:
        """Return the contact under a load."""
        with _refused(load, tilt):
            case = changed(self.case, load=load, max_pressure=None, tilt=tilt)
            return settled_contact(case, self.accuracy, self.tolerance).contact

    def pressed(self, approach: float, tilt: float, load: float) -> Node:
        """Return the contact at an approach; `load` is a first guess of what it takes."""
        with _refused(load, tilt):
            found = pressed_to(changed(self.case, tilt=tilt), approach, load, self.accuracy, self.tolerance)
        contact = found.settled.contact
        contact.warn_unless_converged()
        return self.node(contact)

    def node(self, contact: Contact) -> Node:
        """Load, moment about mid-length and strain energy of a contact."""
        grid = contact.shape.grid
        forces = grid.weights * contact.pressure * grid.cell_area
        # Where it is pressed, the surfaces have moved apart by what the shape would have sunk in.
        sunk = np.where(contact.pressure > 0, contact.approach - contact.shape.gap.values, 0.0)
        moment = float((forces * (grid.x[:, None] - self.case.roller_middle)).sum())
        return Node(float(forces.sum()), moment, 0.5 * float((forces * sunk).sum()))


@contextmanager
def _refused(load: float, tilt: float) -> Iterator[None]:
    """Say which contact of the law cannot be solved."""
    try:
        yield
    except (InvalidInputError, WindowError) as error:
        raise InvalidInputError(
            "tilts, approaches",
            f"a tilt of {tilt:g} rad under {load:.3g} N",
            "such that the contact is solved",
            f"take smaller tilts or larger approaches ({error})",
        ) from error


def solved_nodes(presser: Presser, approaches: FloatArray, tilts: FloatArray) -> Nodes:
    """Contacts at every pair; those of negative tilts by reflection where roller and body are mirror images."""
    reflected = _mirror_images(presser) and bool(np.allclose(tilts, -tilts[::-1], rtol=0, atol=MIRRORED * tilts[-1]))
    at = [index for index, tilt in enumerate(tilts) if not reflected or tilt >= -MIRRORED * tilts[-1]]
    values = np.full((3, approaches.size, tilts.size), np.nan)
    level = min(at, key=lambda index: abs(tilts[index]))
    LOGGER.info("%d contacts at %d approaches and %d tilts", len(at) * approaches.size, approaches.size, len(at))
    # Each tilt begins with the loads of the one before it, from the least on.
    for index in sorted(at, key=lambda index: abs(index - level)):
        neighbour = index + int(np.sign(level - index))
        for line in range(approaches.size - 1, -1, -1):
            guess = values[0, line, neighbour]
            if index == level:
                guess = _first_guess(presser, approaches, values[0, :, level], line)
            values[:, line, index] = presser.pressed(float(approaches[line]), float(tilts[index]), float(guess))
            LOGGER.info(
                "approach %.3g m, tilt %.3g rad: %.4g N", approaches[line], tilts[index], values[0, line, index]
            )
    if reflected:
        for index in set(range(tilts.size)) - set(at):
            values[:, :, index] = values[:, :, tilts.size - 1 - index] * np.array([1, -1, 1])[:, None]
    return Nodes(approaches, tilts, values[2], values[0], values[1])


def _first_guess(presser: Presser, approaches: FloatArray, loads: FloatArray, line: int) -> float:
    """Load of an approach without tilt, from that of the next larger one, or from the case's own."""
    if line + 1 < approaches.size:
        return float(loads[line + 1] * (approaches[line] / approaches[line + 1]) ** POWER)
    return presser.case.normal_load


def _mirror_images(presser: Presser) -> bool:
    """Whether the halves of roller and body are mirror images."""
    case, (low, high) = presser.case, presser.case.body.extent
    length = case.roller.length
    centred = (np.isinf(low) and np.isinf(high)) or abs(
        low + high - 2 * presser.case.roller_middle
    ) <= MIRRORED * length
    places = 0.5 * length * np.linspace(0.01, 0.99, 50)
    right, left = (case.roller.clearance(side * places, np.array([0.0, 1e-2 * length])) for side in (1, -1))
    return bool(centred) and bool(np.allclose(right, left, rtol=MIRRORED, atol=0.0))


def discretisation_errors(presser: Presser, nodes: Nodes) -> FitErrors:
    """Difference of finer contacts, at the largest approach without tilt and with the largest one."""
    finer = replace(presser, accuracy=presser.accuracy / FINER)
    length = presser.case.contact_length
    worst = FitErrors(0.0, 0.0)
    sizes = np.abs(nodes.tilts)
    # Of two largest ones the last: the first may be its reflection.
    for index in {int(sizes.argmin()), sizes.size - 1 - int(sizes[::-1].argmax())}:
        load, moment = nodes.load[-1, index], nodes.moment[-1, index]
        fine = finer.pressed(float(nodes.approaches[-1]), float(nodes.tilts[index]), float(load))
        worst = worst.larger(FitErrors(abs(fine.load / load - 1), abs(fine.moment - moment) / (load * length)))
    return worst
