"""A roller between two raceways: two contact laws in series."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.arrays.variables import describe
from contactstudy.bearing.energy_spline import Motion
from contactstudy.bearing.law import EDGE, MET, ContactLaw
from contactstudy.bearing.motions import Values, broadcast, dataset, each_pair, with_position_errors
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError


@dataclass(frozen=True, eq=False)
class Raceways:
    """A roller between an inner and an outer raceway, free to tilt between them.

    Parameters
    ----------
    inner, outer : ContactLaw
        Of the same roller on either raceway, with x in the same direction.

    Raises
    ------
    InvalidInputError
        If one is no ContactLaw.

    Notes
    -----
    Load and moment about mid-length are the same in both contacts, as nothing else acts on the roller: no centrifugal
    force, no flange. Approaches and tilts add up, those of the outer raceway against the inner one. Where the roller is
    elastic, each contact deforms it as if the other were absent.

    Examples
    --------
    >>> import contactstudy as cs
    >>> steel = cs.Material(210e9, 0.3)
    >>> roller = cs.Roller(radius=5e-3, length=0.3e-3, profile=cs.profiles.FullCrown(crown_radius=0.1))
    >>> case = cs.Case(body=cs.FiniteLengthSpace(length=0.3e-3, material=steel), roller=roller, load=30.0)
    >>> law = cs.bearing.contact_law(case, np.linspace(-2e-4, 2e-4, 5), 1e-6 * np.linspace(1.0, 1.8, 5), accuracy=0.1)
    >>> both = Raceways(law, law)  # of two equal contacts each takes half
    >>> round(float(both.at(2.6e-6).normal_load / law.at(1.3e-6).normal_load), 6)
    1.0
    """

    inner: ContactLaw
    outer: ContactLaw

    def __post_init__(self) -> None:
        """Check the laws."""
        for name in ("inner", "outer"):
            checks.instance(name, getattr(self, name), ContactLaw, "a ContactLaw, as contact_law returns")

    def at(self, approach: Values, tilt: Values = 0.0) -> xr.Dataset:
        """Load, moment and stiffness at an approach and a tilt of one raceway against the other.

        Parameters
        ----------
        approach, tilt : float, sequence or DataArray
            Metres and radians; broadcast as in :meth:`ContactLaw.at`.

        Returns
        -------
        Dataset
            As :meth:`ContactLaw.at`, with the shares of the contacts: `inner_approach`, `inner_tilt`, `outer_approach`
            and `outer_tilt`.

        Raises
        ------
        InvalidInputError
            If either contact would leave its table.
        """
        delta, theta = broadcast(approach=approach, tilt=tilt)
        inner = each_pair(delta, theta, self._inner_share)
        return self._dataset(inner, (delta - inner[0], theta - inner[1]))

    def under(self, normal_load: Values, moment: Values = 0.0) -> xr.Dataset:
        """Approach and tilt of the raceways under a load and a moment.

        Parameters
        ----------
        normal_load, moment : float, sequence or DataArray
            N and N m; broadcast as in :meth:`ContactLaw.at`.

        Returns
        -------
        Dataset
            As of :meth:`at`, with the errors of approach and tilt.

        Raises
        ------
        InvalidInputError
            If either contact would leave its table.
        """
        load, turn = broadcast(normal_load=normal_load, moment=moment)
        found = self._dataset(each_pair(load, turn, self.inner.position), each_pair(load, turn, self.outer.position))
        return with_position_errors(found)

    def _dataset(
        self, inner: tuple[xr.DataArray, xr.DataArray], outer: tuple[xr.DataArray, xr.DataArray]
    ) -> xr.Dataset:
        """Label the series of two contacts at their own approaches and tilts."""
        contacts = [
            law.motion(shares[0].values, shares[1].values) for law, shares in ((self.inner, inner), (self.outer, outer))
        ]
        # Compliances add up.
        stiffness = np.linalg.inv(sum(np.linalg.inv(_matrix(motion)) for motion in contacts))
        first = contacts[0]
        motion = Motion(first.load, first.moment, stiffness[..., 0, 0], stiffness[..., 0, 1], stiffness[..., 1, 1])
        # A softer contact decides; the larger error is a bound for either.
        own = [
            law.errors(shares[0].values, shares[1].values) for law, shares in ((self.inner, inner), (self.outer, outer))
        ]
        errors = [np.maximum(*each) for each in zip(*own, strict=True)]
        found = dataset(inner[0] + outer[0], inner[1] + outer[1], motion, (errors[0], errors[1]))
        for name, shares in (("inner", inner), ("outer", outer)):
            for kind, share in zip(("approach", "tilt"), shares, strict=True):
                found[f"{name}_{kind}"] = (share.dims, share.values)
        return describe(found)

    def _inner_share(self, approach: float, tilt: float) -> tuple[float, float]:
        """Approach and tilt of the inner contact at which both carry the same."""
        from scipy.optimize import least_squares

        tables = self.inner.table, self.outer.table
        whole = {"approach": approach, "tilt": tilt}
        low, high = [], []
        for name, total in whole.items():
            (first, last), (other_first, other_last) = ((float(t[name][0]), float(t[name][-1])) for t in tables)
            low.append(max(first, total - other_last))
            high.append(min(last, total - other_first))
            if not low[-1] < high[-1]:
                ends = f"from {first + other_first:g} to {last + other_last:g}"
                raise InvalidInputError(name, total, f"in the tables of both contacts together, {ends}")
        bounds, size = (
            (np.array(low), np.array(high)),
            np.array([approach, max(np.ptp(tables[0]["tilt"].values), 1e-12)]),
        )
        length = float(tables[0]["contact_length"])

        def both(scaled: FloatArray) -> tuple[Motion, Motion]:
            delta, theta = scaled * size
            return self.inner.motion(delta, theta), self.outer.motion(approach - delta, tilt - theta)

        def missed(scaled: FloatArray) -> FloatArray:
            inner, outer = both(scaled)
            scale = float(np.sqrt(inner.load * outer.load))
            return np.array([inner.load - outer.load, (inner.moment - outer.moment) / length]) / scale

        start = np.clip(0.5 * np.array([approach, tilt]), bounds[0] + EDGE * size, bounds[1] - EDGE * size)
        found = least_squares(
            missed, start / size, bounds=(bounds[0] / size, bounds[1] / size), xtol=1e-14, ftol=1e-14, gtol=1e-14
        )
        if np.abs(found.fun).max() > MET:
            raise InvalidInputError(
                "approach, tilt",
                (approach, tilt),
                "such that either contact's share is in its table",
                "make the tables for more approaches or tilts",
            )
        delta, theta = found.x * size
        return float(delta), float(theta)


def _matrix(motion: Motion) -> FloatArray:
    """Stiffness as matrices along the last two axes."""
    rows = [[motion.normal, motion.coupling], [motion.coupling, motion.tilting]]
    return np.asarray(np.moveaxis(np.array(rows), (0, 1), (-2, -1)))
