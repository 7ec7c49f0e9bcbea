"""Contact law of a roller on a raceway from solved contacts: load and moment at every approach and tilt of a table."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.units import numbers_in_si
from contactstudy.arrays.variables import describe
from contactstudy.bearing.energy_spline import EnergySpline, FitErrors, Nodes, fit_errors
from contactstudy.bearing.law import FEWEST, ContactLaw
from contactstudy.bearing.nodes import Presser, discretisation_errors, solved_nodes
from contactstudy.case.case import LARGEST_TILT, Case
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.interrupts import BriefInterrupt

LOADS, DEFAULT_APPROACHES = (0.03, 1.5), 8
"""Loads over the case's whose approaches are the ends of the default table, and how many lines it has."""


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
        from that of 0.03 of the case's load to that of 1.5 times the load, in equal ratios.
    accuracy : float
        To which the peak pressure of each contact is settled, see :func:`contactstudy.solve`.
    tolerance : float
        Of each contact, see :func:`contactstudy.solve_contact`.

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

    Notes
    -----
    Each contact has columns of its own. The error of the interpolation follows from what it misses at the nodes, from
    splines of another degree, and from those without one of the approaches. Friction that is not coupled changes
    nothing, as its shear does not move the surfaces normally.

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
    _check_case(case)
    turned = _increasing("tilts", numbers_in_si("tilts", tilts, "rad"), "radians")
    if np.abs(turned).max() > LARGEST_TILT:
        raise InvalidInputError("tilts", tilts, f"small angles, at most {LARGEST_TILT} radians")
    presser = Presser(case, checks.positive("accuracy", accuracy), checks.positive("tolerance", tolerance))
    with BriefInterrupt():
        if approaches is None:
            first, last = (presser.loaded(part * case.normal_load, 0.0).approach for part in LOADS)
            lowered = np.geomspace(first, last, DEFAULT_APPROACHES)
        else:
            lowered = _increasing("approaches", numbers_in_si("approaches", approaches, "m"), "metres")
            checks.positive("approaches", float(lowered[0]), "metres")
        nodes = solved_nodes(presser, lowered, turned)
        length = case.contact_length
        fit, cells = fit_errors(nodes, length), discretisation_errors(presser, nodes)
        return ContactLaw(law_table(presser, nodes, fit.plus(cells)))


def _check_case(case: Case) -> None:
    """Raise unless the case leaves load and tilt to the law."""
    if case.tilt:
        raise InvalidInputError("case.tilt", case.tilt, "0: the law has tilts of its own")
    if case.load_position is not None:
        raise InvalidInputError("case.load_position", case.load_position, "None: the roller takes the law's tilts")
    if case.coupled:
        raise InvalidInputError("case.coupled", True, "False: with coupled friction the load derives from no energy")


def _increasing(name: str, values: object, unit: str) -> FloatArray:
    """Return enough increasing numbers, or raise."""
    numbers = checks.coordinates(name, values, unit)
    if numbers.size < FEWEST or (np.diff(numbers) <= 0).any():
        raise InvalidInputError(name, numbers.tolist(), f"{FEWEST} or more increasing numbers ({unit})")
    return numbers


def law_table(presser: Presser, nodes: Nodes, errors: FitErrors) -> xr.Dataset:
    """Label the nodes, with the stiffness of their interpolation."""
    delta, theta = np.meshgrid(nodes.approaches, nodes.tilts, indexing="ij")
    motion = EnergySpline.fitted(nodes)(delta, theta)
    both = ("approach", "tilt")
    arrays = {
        "normal_load": nodes.load,
        "moment": nodes.moment,
        "strain_energy": nodes.energy,
        "normal_stiffness": motion.normal,
        "coupling_stiffness": motion.coupling,
        "tilting_stiffness": motion.tilting,
        "relative_load_error": errors.load + np.zeros_like(nodes.load),
        "relative_moment_error": errors.moment + np.zeros_like(nodes.load),
    }
    scalars = {
        "contact_length": presser.case.contact_length,
        "accuracy": presser.accuracy,
    }
    table = xr.Dataset(
        {name: (both, values) for name, values in arrays.items()} | scalars,
        coords={"approach": nodes.approaches, "tilt": nodes.tilts},
    )
    reference = presser.reference
    table["approach"].attrs |= {"reference": reference, "comment": "at the roller's mid-length"}
    table["tilt"].attrs |= {"reference": reference, "centre": "the roller's mid-length"}
    table["moment"].attrs["comment"] = "about the roller's mid-length"
    return describe(table, "contact law of a roller on a raceway")
