"""Contact law of a roller on a raceway from solved contacts: load and moment at every approach and tilt of a table."""

from __future__ import annotations

import logging
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.variables import describe, in_si
from contactstudy.bearing.energy_spline import STIFFNESSES, EnergySpline, Nodes, estimate_fit_errors
from contactstudy.bearing.law import MIN_NODES, ContactLaw
from contactstudy.case.case import MAX_TILT, Case
from contactstudy.case.magnitudes import warn_of_magnitudes
from contactstudy.checks import FloatArray
from contactstudy.contact.normal.contact import Contact
from contactstudy.contact.refinement.refined_contact import LOAD_POWER, refine_contact, search_load
from contactstudy.contact.solve import reference_depths
from contactstudy.errors import InvalidInputError, WindowError

LOGGER = logging.getLogger(__name__)

TOLERANCE = 1e-9  # Maximum difference of mirror images over the length, or over the drop


@dataclass(frozen=True)
class ContactSolver:
    """Solves the contact of a case at given loads or approaches, and tilts."""

    case: Case
    accuracy: float  # of the peak pressure
    tolerance: float  # of each contact's iteration

    def solve_at_load(self, load: float, tilt: float) -> Contact:
        """Return the contact under a load."""
        with _name_unsolvable_contact(load, tilt):
            case = replace(self.case, load=load, max_pressure=None, tilt=tilt)
            return refine_contact(case, self.accuracy, self.tolerance).contact

    def solve_at_approach(self, approach: float, tilt: float, load: float) -> FloatArray:
        """Load (N), moment about mid-length (N m) and energy (J) at an approach, from a first guess of the load."""
        with _name_unsolvable_contact(load, tilt):
            contact = search_load(replace(self.case, tilt=tilt), approach, load, self.accuracy, self.tolerance).contact
        contact.warn_unless_converged()
        grid = contact.shape.grid
        forces = grid.weights * contact.pressure * grid.cell_area
        # In the contact the normal displacement is approach less gap.
        normal_displacement = np.where(contact.pressure > 0, contact.approach - contact.shape.gap.values, 0.0)
        moment = (forces * (grid.x[:, None] - self.case.roller_middle)).sum()
        return np.array([forces.sum(), moment, 0.5 * (forces * normal_displacement).sum()])


@contextmanager
def _name_unsolvable_contact(load: float, tilt: float) -> Iterator[None]:
    """Raise the error of a contact without a solution as an error that names the load and the tilt."""
    try:
        yield
    except (InvalidInputError, WindowError) as error:
        value, hint = f"a tilt of {tilt:g} rad under {load:.3g} N", f"take smaller tilts or larger approaches ({error})"
        raise InvalidInputError("tilts, approaches", value, "such that the contact is solved", hint) from error


def solve_nodes(solver: ContactSolver, approaches: FloatArray, tilts: FloatArray) -> Nodes:
    """Solve the contacts at every pair; reflect the solutions to negative tilts if roller and body are symmetric."""
    reflected = _is_symmetric(solver) and bool(np.allclose(tilts, -tilts[::-1], rtol=0, atol=TOLERANCE * tilts[-1]))
    columns = [index for index, tilt in enumerate(tilts) if not reflected or tilt >= -TOLERANCE * tilts[-1]]
    nodes = np.full((3, approaches.size, tilts.size), np.nan)
    start_column = min(columns, key=lambda index: abs(tilts[index]))
    LOGGER.info(
        "%d contacts at %d approaches and %d tilts", len(columns) * approaches.size, approaches.size, len(columns)
    )
    # The first guesses at each tilt are the loads at the preceding tilt; the first tilt is the least.
    for index in sorted(columns, key=lambda index: abs(index - start_column)):
        neighbour = index + int(np.sign(start_column - index))
        for row in range(approaches.size - 1, -1, -1):
            guess = nodes[0, row, neighbour]
            if index == start_column:  # first guess: the load at the next larger approach, or the load of the case
                guess = solver.case.normal_load
                if row + 1 < approaches.size:
                    guess = nodes[0, row + 1, start_column] * (approaches[row] / approaches[row + 1]) ** LOAD_POWER
            nodes[:, row, index] = solver.solve_at_approach(float(approaches[row]), float(tilts[index]), float(guess))
            LOGGER.info("approach %.3g m, tilt %.3g rad: %.4g N", approaches[row], tilts[index], nodes[0, row, index])
    if reflected:
        for index in set(range(tilts.size)) - set(columns):
            nodes[:, :, index] = nodes[:, :, tilts.size - 1 - index] * np.array([1, -1, 1])[:, None]
    return Nodes(approaches, tilts, nodes[2], nodes[0], nodes[1])


def _is_symmetric(solver: ContactSolver) -> bool:
    """Whether roller and body are symmetric about mid-length."""
    case, (low, high) = solver.case, solver.case.body.extent
    length = case.roller.length
    is_centred = np.isinf(low) or abs(low + high - 2 * case.roller_middle) <= TOLERANCE * length
    offsets = 0.5 * length * np.linspace(0.01, 0.99, 50)
    second_half, first_half = (
        case.roller.clearance(sign * offsets, np.array([0.0, 1e-2 * length])) for sign in (1, -1)
    )
    return bool(is_centred) and bool(np.allclose(second_half, first_half, rtol=TOLERANCE, atol=0.0))


def estimate_discretisation_errors(solver: ContactSolver, nodes: Nodes) -> FloatArray:
    """Errors (load, moment): differences from finer contacts at the largest approach, without and with largest tilt."""
    # The discretisation error is the difference from contacts solved to a quarter of the accuracy.
    fine_solver = replace(solver, accuracy=solver.accuracy / 4.0)
    length = solver.case.contact_length
    errors = np.zeros(2)
    tilt_sizes = np.abs(nodes.tilts)
    # Of two opposite tilts the last is solved; the first may be a reflection.
    for index in {int(tilt_sizes.argmin()), tilt_sizes.size - 1 - int(tilt_sizes[::-1].argmax())}:
        load, moment = nodes.normal_load[-1, index], nodes.moment[-1, index]
        position = float(nodes.approaches[-1]), float(nodes.tilts[index])
        fine_load, fine_moment, _ = fine_solver.solve_at_approach(*position, float(load))
        errors = np.maximum(errors, [abs(fine_load / load - 1), abs(fine_moment - moment) / (load * length)])
    return errors


# Loads, over the case's load, of the first and last default approach, and number of approaches
LOAD_RANGE, APPROACH_COUNT = (0.03, 1.5), 8


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
        Roller and body; its load defines the default approaches; without a tilt.
    tilts : sequence of float
        Five or more, increasing, radians. For symmetric tilts, roller and body the code solves half of the tilts.
    approaches : sequence of float, optional
        Five or more, increasing, positive, metres, at the roller's mid-length. Default: eight
        from the approach under 0.03 of the case's load to the approach under 1.5 times the load, in equal ratios.
    accuracy, tolerance : float
        Accuracy and tolerance of each contact, see :func:`contactstudy.solve` and :func:`contactstudy.solve_contact`.

    Returns
    -------
    ContactLaw
        Its `table` is a Dataset along `approach` and `tilt`: `normal_load`, `moment`, `strain_energy`,
        `normal_stiffness`, `coupling_stiffness`, `tilting_stiffness`; and `relative_load_error` (over the load) and
        `relative_moment_error` (over load times length), sums of the errors of interpolation and discretisation.

    Raises
    ------
    InvalidInputError
        If the case is tilted, prescribes its load's position or couples friction; if approaches or tilts are too few,
        do not increase, or have no solution.

    Examples
    --------
    >>> from contactstudy import HalfSpace, Material, Roller, profiles
    >>> body = HalfSpace(material=Material(210e9, 0.3))
    >>> roller = Roller(radius=5e-3, length=0.3e-3, profile=profiles.FullCrown(crown_radius=0.1))
    >>> case = Case(body=body, roller=roller, load=30.0)
    >>> law = contact_law(case, np.linspace(-2e-4, 2e-4, 5), 1e-6 * np.linspace(1.0, 1.8, 5), accuracy=0.1)
    >>> contact = law.at(1.3e-6, 1e-4)
    >>> bool(contact.normal_stiffness > contact.normal_load / 1.3e-6)  # the load grows faster than the approach
    True
    """
    checks.instance("case", case, Case, "a Case")
    warn_of_magnitudes(case)
    if case.tilt:
        raise InvalidInputError("case.tilt", case.tilt, "0: give the tilts of the law")
    if case.load_position is not None:
        raise InvalidInputError("case.load_position", case.load_position, "None: the roller takes the law's tilts")
    if case.coupled:
        raise InvalidInputError("case.coupled", True, "False: with coupled friction the load derives from no energy")
    checked_tilts = checks.increasing("tilts", in_si("tilts", tilts, "rad"), "radians", MIN_NODES)
    if np.abs(checked_tilts).max() > MAX_TILT:
        raise InvalidInputError("tilts", tilts, f"small angles, at most {MAX_TILT} radians")
    solver = ContactSolver(case, checks.positive("accuracy", accuracy), checks.positive("tolerance", tolerance))
    if approaches is None:
        low, high = (solver.solve_at_load(factor * case.normal_load, 0.0).approach for factor in LOAD_RANGE)
        checked_approaches = np.geomspace(low, high, APPROACH_COUNT)
    else:
        numbers = in_si("approaches", approaches, "m")
        checked_approaches = checks.increasing("approaches", numbers, "metres", MIN_NODES)
        checks.positive("approaches", float(checked_approaches[0]), "metres")
    nodes = solve_nodes(solver, checked_approaches, checked_tilts)
    length = case.contact_length
    fit_errors, cell_errors = estimate_fit_errors(nodes, length), estimate_discretisation_errors(solver, nodes)
    return ContactLaw(label_law(solver, nodes, fit_errors + cell_errors[:, None, None]))


def label_law(solver: ContactSolver, nodes: Nodes, errors: FloatArray) -> xr.Dataset:
    """Label the nodes and their errors (2, approach, tilt), with the stiffness of their interpolation."""
    delta, theta = np.meshgrid(nodes.approaches, nodes.tilts, indexing="ij")
    response = EnergySpline.fit(nodes)(delta, theta)
    dims = ("approach", "tilt")
    arrays = {
        "normal_load": nodes.normal_load,
        "moment": nodes.moment,
        "strain_energy": nodes.energy,
        **{name: getattr(response, name) for name in STIFFNESSES},
        "relative_load_error": errors[0],
        "relative_moment_error": errors[1],
    }
    scalars = {"contact_length": solver.case.contact_length, "accuracy": solver.accuracy}
    scalars |= reference_depths(solver.case.body, solver.case.counterbody)
    centre = "the roller's mid-length"
    coordinates = {
        "approach": ("approach", nodes.approaches, {"comment": f"relative to reference_depth, at {centre}"}),
        "tilt": ("tilt", nodes.tilts, {"centre": centre}),
    }
    table = xr.Dataset({name: (dims, values) for name, values in arrays.items()} | scalars, coordinates)
    table["moment"].attrs["comment"] = f"about {centre}"
    return describe(table, "contact law of a roller on a raceway")
