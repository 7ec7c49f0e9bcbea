"""Contact law of a roller on a raceway: load and moment over approach and tilt, and the stiffness matrix."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.required import require
from contactstudy.arrays.units import numbers_in_si
from contactstudy.arrays.variables import describe
from contactstudy.bearing.energy_spline import EnergySpline, FitErrors, Motion, Nodes, fit_errors
from contactstudy.bearing.motions import Values, broadcast, dataset, each_pair, with_position_errors
from contactstudy.bearing.nodes import Presser, discretisation_errors, solved_nodes
from contactstudy.case.case import LARGEST_TILT, Case
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError

FEWEST = 5
"""Approaches and tilts below which an interpolation would not deserve the name."""

LOADS, DEFAULT_APPROACHES = (0.03, 1.5), 8
"""Loads over the case's whose approaches are the ends of the default table, and how many lines it has."""

EDGE = 1e-9
"""Part of the table by which rounding may leave it."""

MET = 1e-7
"""Part of load, and of load times length, to which an approach and a tilt meet what was asked for. Accuracy."""

NEEDED = ("normal_load", "moment", "strain_energy", "relative_load_error", "relative_moment_error", "contact_length")
"""Variables of a table from which the law follows."""


@dataclass(frozen=True, eq=False)
class ContactLaw:
    """Load and moment of one contact as smooth functions of approach and tilt, and the inverse.

    Parameters
    ----------
    table : Dataset
        What :func:`contact_law` tabulates, or the same from a file: ``ContactLaw(xarray.open_dataset(path))``.

    Raises
    ------
    InvalidInputError
        If the Dataset is no such table.

    Notes
    -----
    What is interpolated is the strain energy U, of which the load ``Q = dU/d delta`` and the moment
    ``M = dU/d theta`` are derivatives, so that the stiffness matrix is symmetric and is the exact derivative of the
    load and moment that are returned: what Newton's method for a bearing's equilibrium needs.

    Examples
    --------
    >>> approach, tilt = np.geomspace(1e-6, 4e-6, 5), np.linspace(-1e-3, 1e-3, 5)
    >>> delta, theta = np.meshgrid(approach, tilt, indexing="ij")
    >>> both = ("approach", "tilt")  # two springs of 10 N/um, 1 mm to either side of the middle
    >>> springs = xr.Dataset(
    ...     {
    ...         "normal_load": (both, 2e7 * delta),
    ...         "moment": (both, 20.0 * theta),
    ...         "strain_energy": (both, 1e7 * delta**2 + 10.0 * theta**2),
    ...         "relative_load_error": 0.0,
    ...         "relative_moment_error": 0.0,
    ...         "contact_length": 2e-3,
    ...     },
    ...     {"approach": approach, "tilt": tilt},
    ... )
    >>> law = ContactLaw(springs)
    >>> round(float(law.at(2e-6, 5e-4).normal_load), 1)
    40.0
    >>> found = law.under(normal_load=40.0, moment=0.01)
    >>> round(1e6 * float(found.approach), 2), round(1e3 * float(found.tilt), 2)
    (2.0, 0.5)
    """

    table: xr.Dataset

    def __post_init__(self) -> None:
        """Check the table."""
        require(self.table, *NEEDED, argument="table")
        for name in ("approach", "tilt"):
            if self.table.sizes.get(name, 0) < FEWEST:
                raise InvalidInputError("table", dict(self.table.sizes), f"one with {FEWEST} or more along {name}")

    def __repr__(self) -> str:
        low, high = (1e6 * end for end in self._range("approach"))
        least, most = (1e3 * end for end in self._range("tilt"))
        loads = self.table["normal_load"]
        errors = 100 * self.table["relative_load_error"].broadcast_like(loads)
        worst = errors[errors.argmax(...)]
        return (
            f"ContactLaw(approach {low:.3g} to {high:.3g} um, tilt {least:.3g} to {most:.3g} mrad, "
            f"load {float(loads.min()):.3g} to {float(loads.max()):.3g} N, "
            f"error of the load {float(errors.median()):.1g} % by the median, up to {float(errors.max()):.1g} % at "
            f"{1e6 * float(worst.approach):.3g} um and {1e3 * float(worst.tilt):.3g} mrad)"
        )

    def at(self, approach: Values, tilt: Values = 0.0) -> xr.Dataset:
        """Load, moment and stiffness at an approach and a tilt.

        Parameters
        ----------
        approach : float, sequence or DataArray
            How far the roller is pressed down at its mid-length, metres, relative to the table's reference.
        tilt : float, sequence or DataArray
            Radians, positive if larger x is pressed deeper. Two sequences give a table, DataArrays are paired along
            their common dimensions.

        Returns
        -------
        Dataset
            `normal_load` Q (N), `moment` M about the roller's mid-length (N m), `normal_stiffness` dQ/d approach,
            `coupling_stiffness` dQ/d tilt = dM/d approach, `tilting_stiffness` dM/d tilt; `normal_load_error` and
            `moment_error`, from interpolation and discretisation.

        Raises
        ------
        InvalidInputError
            Outside the table.
        """
        delta, theta = broadcast(approach=approach, tilt=tilt)
        for name, values in (("approach", delta), ("tilt", theta)):
            low, high = self._range(name)
            room = EDGE * (high - low)
            outside = values.values[(values.values < low - room) | (values.values > high + room)]
            if outside.size:
                raise InvalidInputError(name, float(outside[0]), f"in the table, from {low:g} to {high:g}")
        pairs = delta.values, theta.values
        return dataset(delta, theta, self.motion(*pairs), self.errors(*pairs))

    def under(self, normal_load: Values, moment: Values = 0.0) -> xr.Dataset:
        """Approach and tilt under a load and a moment, with the stiffness there.

        Parameters
        ----------
        normal_load, moment : float, sequence or DataArray
            N, and N m about the roller's mid-length; broadcast as in :meth:`at`.

        Returns
        -------
        Dataset
            `approach` (m), `tilt` (rad), their errors, and what :meth:`at` gives for them.

        Raises
        ------
        InvalidInputError
            If they belong to an approach and a tilt outside the table.
        """
        load, turn = broadcast(normal_load=normal_load, moment=moment)
        delta, theta = each_pair(load, turn, self.position)
        pairs = delta.values, theta.values
        return with_position_errors(dataset(delta, theta, self.motion(*pairs), self.errors(*pairs)))

    def motion(self, approach: FloatArray, tilt: FloatArray) -> Motion:
        """Load, moment and stiffness as plain arrays, at pairs inside the table: for loops of one's own.

        Outside it extrapolates without a warning, so that Newton's method may pass there; check where it ends.
        """
        return self._spline(np.asarray(approach, dtype=np.float64), np.asarray(tilt, dtype=np.float64))

    def position(self, load: float, moment: float) -> tuple[float, float]:
        """Approach and tilt under one load (N) and one moment (N m)."""
        from scipy.optimize import least_squares

        load = checks.positive("normal_load", load, "N")
        (low, high), (least, most) = self._range("approach"), self._range("tilt")
        length = float(self.table["contact_length"])
        loads, moments = (self.table[name].transpose("approach", "tilt").values for name in ("normal_load", "moment"))
        distance = np.hypot(loads / load - 1, (moments - moment) / (load * length))
        line, column = np.unravel_index(int(distance.argmin()), distance.shape)
        size = np.array([high, most - least])

        def missed(scaled: FloatArray) -> FloatArray:
            found = self.motion(*(scaled * size))
            return np.array([found.load / load - 1, (found.moment - moment) / (load * length)])

        def slopes(scaled: FloatArray) -> FloatArray:
            found = self.motion(*(scaled * size))
            turned = np.array([found.coupling, found.tilting]) / length
            return np.asarray(np.array([[found.normal, found.coupling], turned]) / load * size)

        bounds = (np.array([low, least]) / size, np.array([high, most]) / size)
        begun = np.array([float(self.table["approach"][line]), float(self.table["tilt"][column])]) / size
        inside = np.clip(begun, bounds[0] + EDGE, bounds[1] - EDGE)
        found = least_squares(missed, inside, slopes, bounds=bounds, xtol=1e-14, ftol=1e-14, gtol=1e-14)
        if np.abs(found.fun).max() > MET:
            raise InvalidInputError(
                "normal_load, moment",
                (load, moment),
                f"of a contact in the table, whose loads go from {loads.min():.4g} to {loads.max():.4g} N "
                f"and tilts from {least:g} to {most:g} rad",
                "make the table for larger approaches or tilts",
            )
        delta, theta = found.x * size
        return float(delta), float(theta)

    def _range(self, name: str) -> tuple[float, float]:
        """First and last approach or tilt."""
        return float(self.table[name][0]), float(self.table[name][-1])

    @cached_property
    def _spline(self) -> EnergySpline:
        """The interpolation."""
        values = [self.table[name].transpose("approach", "tilt").values for name in ("strain_energy", "normal_load")]
        moment = self.table["moment"].transpose("approach", "tilt").values
        return EnergySpline.fitted(
            Nodes(self.table["approach"].values, self.table["tilt"].values, values[0], values[1], moment)
        )

    def errors(self, approach: FloatArray, tilt: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Errors of load and moment over the load, at pairs inside the table: the largest of the nodes around each."""
        sides = []
        for name, places in (("approach", approach), ("tilt", tilt)):
            lines = self.table[name].values
            right = np.clip(np.searchsorted(lines, places), 1, lines.size - 1)
            sides.append((right - 1, right))
        found = []
        for name in ("relative_load_error", "relative_moment_error"):
            known = self.table[name].broadcast_like(self.table["normal_load"]).transpose("approach", "tilt").values
            found.append(np.max([known[i, j] for i in sides[0] for j in sides[1]], axis=0))
        return found[0], float(self.table["contact_length"]) * found[1]


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
