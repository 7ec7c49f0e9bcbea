"""Contact law of a roller on a raceway: load, moment and stiffness over approach and tilt, and the inverse."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.html_table import html_table
from contactstudy.arrays.required import require
from contactstudy.bearing.energy_spline import EnergySpline, Motion, Nodes
from contactstudy.bearing.motions import UNITS, Values, broadcast, dataset, each_pair, with_position_errors
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError

FEWEST = 5
"""Approaches and tilts below which an interpolation would not deserve the name."""

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
        What :func:`contactstudy.bearing.contact_law` tabulates, or the same from a file:
        ``ContactLaw(xarray.open_dataset(path))``.

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
        return f"ContactLaw({', '.join(f'{name} {text}' for name, text in self._said())})"

    def _repr_html_(self) -> str:
        return html_table([("Contact law", self._said())])

    def _said(self) -> Iterator[tuple[str, str]]:
        """Ranges of the table, and its errors."""
        low, high = (1e6 * end for end in self._range("approach"))
        least, most = (1e3 * end for end in self._range("tilt"))
        loads = self.table["normal_load"]
        errors = 100 * self.table["relative_load_error"].broadcast_like(loads)
        worst = errors[errors.argmax(...)]
        yield "approach", f"{low:.3g} to {high:.3g} um"
        yield "tilt", f"{least:.3g} to {most:.3g} mrad"
        yield "load", f"{float(loads.min()):.3g} to {float(loads.max()):.3g} N"
        yield (
            "error of the load",
            f"{float(errors.median()):.1g} % by the median, up to {float(errors.max()):.1g} % at "
            f"{1e6 * float(worst.approach):.3g} um and {1e3 * float(worst.tilt):.3g} mrad",
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
                raise InvalidInputError(
                    name, float(outside[0]), f"in the table, from {low:g} to {high:g} {UNITS[name]}"
                )
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
