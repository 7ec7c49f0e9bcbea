"""Contact law of a roller on a raceway from solved contacts: load and moment at every approach and tilt of a table."""

from __future__ import annotations

import logging
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.variables import describe, numbers_in_si
from contactstudy.bearing.energy_spline import EnergySpline, Nodes, fit_errors
from contactstudy.bearing.law import FEWEST, ContactLaw
from contactstudy.case.case import LARGEST_TILT, Case
from contactstudy.case.magnitudes import warn_doubtful
from contactstudy.checks import FloatArray
from contactstudy.contact.normal.contact import Contact
from contactstudy.contact.refinement.refined_contact import LOAD_POWER, refine_contact, search_load
from contactstudy.contact.solve import describe_reference_lines
from contactstudy.errors import InvalidInputError, WindowError

LOGGER = logging.getLogger(__name__)

MIRRORED = 1e-9  # Difference of mirror images over the length, or over the drop


class Node(NamedTuple):
    """One contact: N, N m and J."""

    load: float
    moment: float
    energy: float


@dataclass(frozen=True)
class Presser:
    """Presses the roller of a case to given approaches and tilts."""

    case: Case
    accuracy: float  # of the peak pressure
    tolerance: float  # of each contact's iteration

    def loaded(self, load: float, tilt: float) -> Contact:
        """Return the contact under a load."""
        with _refused(load, tilt):
            case = replace(self.case, load=load, max_pressure=None, tilt=tilt)
            return refine_contact(case, self.accuracy, self.tolerance).contact

    def pressed(self, approach: float, tilt: float, load: float) -> Node:
        """Load, moment about mid-length and strain energy at an approach, from a first guess of the load."""
        with _refused(load, tilt):
            solution = search_load(replace(self.case, tilt=tilt), approach, load, self.accuracy, self.tolerance)
        contact = solution.refined.contact
        contact.warn_unless_converged()
        grid = contact.shape.grid
        forces = grid.weights * contact.pressure * grid.cell_area
        # In the contact the surfaces move apart by approach less gap.
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
    """Contacts at every pair; negative tilts by reflection if roller and body are mirror images."""
    reflected = _mirror_images(presser) and bool(np.allclose(tilts, -tilts[::-1], rtol=0, atol=MIRRORED * tilts[-1]))
    columns = [index for index, tilt in enumerate(tilts) if not reflected or tilt >= -MIRRORED * tilts[-1]]
    values = np.full((3, approaches.size, tilts.size), np.nan)
    level = min(columns, key=lambda index: abs(tilts[index]))
    LOGGER.info(
        "%d contacts at %d approaches and %d tilts", len(columns) * approaches.size, approaches.size, len(columns)
    )
    # Each tilt begins with the loads of the one before it, from the least on.
    for index in sorted(columns, key=lambda index: abs(index - level)):
        neighbour = index + int(np.sign(level - index))
        for line in range(approaches.size - 1, -1, -1):
            guess = values[0, line, neighbour]
            if index == level:  # from the next larger approach, or the load of the case
                guess = presser.case.normal_load
                if line + 1 < approaches.size:
                    guess = values[0, line + 1, level] * (approaches[line] / approaches[line + 1]) ** LOAD_POWER
            values[:, line, index] = presser.pressed(float(approaches[line]), float(tilts[index]), float(guess))
            LOGGER.info(
                "approach %.3g m, tilt %.3g rad: %.4g N", approaches[line], tilts[index], values[0, line, index]
            )
    if reflected:
        for index in set(range(tilts.size)) - set(columns):
            values[:, :, index] = values[:, :, tilts.size - 1 - index] * np.array([1, -1, 1])[:, None]
    return Nodes(approaches, tilts, values[2], values[0], values[1])


def _mirror_images(presser: Presser) -> bool:
    """Whether the halves of roller and body are mirror images."""
    case, (low, high) = presser.case, presser.case.body.extent
    length = case.roller.length
    centred = np.isinf(low) or abs(low + high - 2 * case.roller_middle) <= MIRRORED * length
    places = 0.5 * length * np.linspace(0.01, 0.99, 50)
    second_half, first_half = (case.roller.clearance(side * places, np.array([0.0, 1e-2 * length])) for side in (1, -1))
    return bool(centred) and bool(np.allclose(second_half, first_half, rtol=MIRRORED, atol=0.0))


def discretisation_errors(presser: Presser, nodes: Nodes) -> FloatArray:
    """Differences (load, moment) of finer contacts, at the largest approach without tilt and with the largest one."""
    # By how much finer the contacts are whose difference from the nodes is stated as discretisation error
    finer = replace(presser, accuracy=presser.accuracy / 4.0)
    length = presser.case.contact_length
    worst = np.zeros(2)
    sizes = np.abs(nodes.tilts)
    # Of two largest ones the last: the first may be its reflection.
    for index in {int(sizes.argmin()), sizes.size - 1 - int(sizes[::-1].argmax())}:
        load, moment = nodes.load[-1, index], nodes.moment[-1, index]
        fine = finer.pressed(float(nodes.approaches[-1]), float(nodes.tilts[index]), float(load))
        worst = np.maximum(worst, [abs(fine.load / load - 1), abs(fine.moment - moment) / (load * length)])
    return worst


# Loads over the case's whose approaches are the ends of the default table, and how many lines it has
LOADS, DEFAULT_APPROACHES = (0.03, 1.5), 8


def contact_law(
    case: Case,
    tilts: Sequence[float] | FloatArray,
    approaches: Sequence[float] | FloatArray | None = None,
    *,
    accuracy: float = 0.01,
    tolerance: float = 1e-6,
) -> ContactLaw:
    """Tabulate load and moment of a roller on a raceway over approach and tilt.

    Parameters
    ----------
    case : Case
        Roller and body; its load sets the default approaches. Its own tilt is 0.
    tilts : sequence of float
        Five or more, increasing, radians. If they are symmetric and roller and body are, half of them are solved.
    approaches : sequence of float, optional
        Five or more, increasing, positive, metres: how far the roller is pressed down at its mid-length. Default: eight
        from the approach under 0.03 of the case's load to the approach under 1.5 times the load, in equal ratios.
    accuracy, tolerance : float
        Of each contact, see :func:`contactstudy.solve` and :func:`contactstudy.solve_contact`.

    Returns
    -------
    ContactLaw
        Its `table` is a Dataset along `approach` and `tilt`: `normal_load`, `moment`, `strain_energy`,
        `normal_stiffness`, `coupling_stiffness`, `tilting_stiffness`; and `relative_load_error` (over the load) and
        `relative_moment_error` (over load times length), the sum of the errors of interpolation, there and up to the
        next nodes, and of discretisation.

    Raises
    ------
    InvalidInputError
        If the case is tilted, prescribes where its load acts or couples friction; if approaches or tilts are too few,
        do not increase, or are too far apart for a contact to be found.

    Examples
    --------
    >>> from contactstudy import HalfSpace, Material, Roller, profiles
    >>> body = HalfSpace(material=Material(210e9, 0.3))
    >>> roller = Roller(radius=5e-3, length=0.3e-3, profile=profiles.FullCrown(crown_radius=0.1))
    >>> case = Case(body=body, roller=roller, load=30.0)
    >>> law = contact_law(case, np.linspace(-2e-4, 2e-4, 5), 1e-6 * np.linspace(1.0, 1.8, 5), accuracy=0.1)
    >>> pressed = law.at(1.3e-6, 1e-4)
    >>> bool(pressed.normal_stiffness > pressed.normal_load / 1.3e-6)  # the load grows faster than the approach
    True
    """
    checks.instance("case", case, Case, "a Case")
    warn_doubtful(case)
    if case.tilt:
        raise InvalidInputError("case.tilt", case.tilt, "0: the law has tilts of its own")
    if case.load_position is not None:
        raise InvalidInputError("case.load_position", case.load_position, "None: the roller takes the law's tilts")
    if case.coupled:
        raise InvalidInputError("case.coupled", True, "False: with coupled friction the load derives from no energy")
    turned = _increasing("tilts", numbers_in_si("tilts", tilts, "rad"), "radians")
    if np.abs(turned).max() > LARGEST_TILT:
        raise InvalidInputError("tilts", tilts, f"small angles, at most {LARGEST_TILT} radians")
    presser = Presser(case, checks.positive("accuracy", accuracy), checks.positive("tolerance", tolerance))
    if approaches is None:
        first, last = (presser.loaded(part * case.normal_load, 0.0).approach for part in LOADS)
        lowered = np.geomspace(first, last, DEFAULT_APPROACHES)
    else:
        lowered = _increasing("approaches", numbers_in_si("approaches", approaches, "m"), "metres")
        checks.positive("approaches", float(lowered[0]), "metres")
    nodes = solved_nodes(presser, lowered, turned)
    length = case.contact_length
    fit, cells = fit_errors(nodes, length), discretisation_errors(presser, nodes)
    return ContactLaw(law_table(presser, nodes, fit + cells[:, None, None]))


def _increasing(name: str, values: object, unit: str) -> FloatArray:
    """Return enough increasing numbers, or raise."""
    numbers = checks.coordinates(name, values, unit)
    if numbers.size < FEWEST or (np.diff(numbers) <= 0).any():
        raise InvalidInputError(name, numbers.tolist(), f"{FEWEST} or more increasing numbers ({unit})")
    return numbers


def law_table(presser: Presser, nodes: Nodes, errors: FloatArray) -> xr.Dataset:
    """Label the nodes and their errors (2, approach, tilt), with the stiffness of their interpolation."""
    delta, theta = np.meshgrid(nodes.approaches, nodes.tilts, indexing="ij")
    motion = EnergySpline.fitted(nodes)(delta, theta)
    dims = ("approach", "tilt")
    arrays = {
        "normal_load": nodes.load,
        "moment": nodes.moment,
        "strain_energy": nodes.energy,
        "normal_stiffness": motion.normal,
        "coupling_stiffness": motion.coupling,
        "tilting_stiffness": motion.tilting,
        "relative_load_error": errors[0],
        "relative_moment_error": errors[1],
    }
    scalars = {"contact_length": presser.case.contact_length, "accuracy": presser.accuracy}
    table = xr.Dataset(
        {name: (dims, values) for name, values in arrays.items()} | scalars,
        coords={"approach": nodes.approaches, "tilt": nodes.tilts},
    )
    reference = describe_reference_lines(presser.case.body, presser.case.counterbody)
    table["approach"].attrs |= {"reference": reference, "comment": "at the roller's mid-length"}
    table["tilt"].attrs |= {"reference": reference, "centre": "the roller's mid-length"}
    table["moment"].attrs["comment"] = "about the roller's mid-length"
    return describe(table, "contact law of a roller on a raceway")
