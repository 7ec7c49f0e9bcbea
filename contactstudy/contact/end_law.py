"""The law of a singular end: how the pressure grows towards it, and its intensity.

A sharp rigid end inside the face of a body is pressed like a flat punch: at the distance d from it ``p = K / sqrt(d)``.
At a sharp elastic end the pressure grows with a smaller power, which follows from the two materials; where theory knows
none, it is fitted here. The pressure has no peak, only an intensity K. An edge of small radius ``r0`` bounds it to

    p_max = 1.0734 (K**2 E* / r0)**(1/3),

the limit for ``r0`` much smaller than the half-width.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from contactstudy import checks
from contactstudy.checks import FloatArray

RIGID = 0.5
"""Exponent at a sharp rigid end."""

LEAST_GROWTH = 0.12
"""Exponent of the growth between two halvings from which on an end counts as a power law. Accuracy."""

LASTING_STEPS = 0.5
"""Sum of the last two steps over that of the two before from which on a growth counts as a logarithm. Accuracy."""

NEAREST, FARTHEST = 3.0, 64.0
"""Distances, over the outermost column's width, between which the intensity is fitted. Accuracy."""

FEWEST = 3
"""Columns from which an intensity is fitted."""

LEAST_ROOM, NARROW_ERROR = 0.5, 0.08
"""Part of the room beyond an end that the fit may reach, and what is added to the error beyond it, over K. Accuracy:
measured as 5 % where it reaches 2.5 times the room, 0.8 % where it reaches 0.6 of it."""

STEP_ERROR = 3e-3
"""Part of the intensity that steps of pressure leave. Accuracy: measured as the residual of every fit."""

ELASTIC_SHARE = 1.5
"""What the intensity of an elastic end may move by nearer to it, over what it moves by when both limits of the fit
double. Accuracy: its next power is not a whole number, as it is at a rigid end."""

EDGE_FACTOR = 1.0734
"""Factor of the peak at an edge of small radius, computed for a half-space."""


class Sample(NamedTuple):
    """Width of the outermost column and the largest pressure on it."""

    width: float
    pressure: float


@dataclass(frozen=True)
class EndLaw:
    """How the pressure grows towards a singular end.

    Attributes
    ----------
    kind : str
        "power" or "logarithm".
    exponent : float
        ``m`` of ``p = K d**-m``: that of theory, else fitted (NaN until then); 0 for a logarithm.
    intensity, intensity_error : float
        ``K`` and its estimated error, Pa m**m; NaN for a logarithm.
    fitted : bool
        Whether the exponent is fitted.
    """

    kind: str
    exponent: float
    intensity: float = np.nan
    intensity_error: float = np.nan
    fitted: bool = False

    def with_intensity(self, edges: FloatArray, pressure: FloatArray, room: float) -> EndLaw:
        """Return the law with the intensity fitted to the pressure (column, y), at distances from the end.

        The law holds for distances much smaller than the `room` from the end to the body's own. Where friction has
        lifted the end, the intensity is 0 with an infinite error. Where the contact is too narrow for a fit, it is that
        of the outermost column with an infinite error.
        """
        if self.kind != "power":
            return self
        # Friction moves the contact along y, and not alike at both ends.
        row = pressure[:, int(pressure[0].argmax())]
        if row[0] <= 0:
            return replace(self, intensity=0.0, intensity_error=np.inf)
        width, exponent, fitted = edges[1], self.exponent, bool(np.isnan(self.exponent))
        if fitted:
            from scipy.optimize import minimize_scalar

            bounds = (LEAST_GROWTH, RIGID)
            found = minimize_scalar(lambda m: _fit(edges, row, width, m)[1], bounds=bounds, method="bounded")
            exponent = float(found.x)
        fits = [_fit(edges, row, width * factor, exponent)[0] for factor in (1.0, 2.0)]
        if not np.isfinite(fits).all():  # pressed on too few columns
            outermost = (1 - exponent) * row[0] * width**exponent
            return EndLaw(self.kind, exponent, float(outermost), np.inf, fitted)
        share = 1.0 if exponent == RIGID else ELASTIC_SHARE
        error = share * abs(fits[0] - fits[1]) + STEP_ERROR * fits[0]
        if FARTHEST * width > LEAST_ROOM * room:
            error += NARROW_ERROR * fits[0]
        return EndLaw(self.kind, exponent, fits[0], error, fitted)


def elastic_exponent(edge: float, face: float) -> float:
    """Exponent ``m`` of the pressure at a sharp edge of 90 degrees on a face that goes on, without friction.

    Under the pressure ``r**(s - 1)`` with ``s = 1 - m`` the slopes of a quarter-plane and of a half-plane follow from
    Airy's stress function of a wedge (Williams, J. Appl. Mech. 19 (1952) 526). They cancel where

        k_e sin(pi s) / (2 (sin(pi s / 2)**2 - s**2)) + k_f cot(pi s) = 0,

    as in Dundurs and Lee, J. Elasticity 2 (1972) 109.

    Parameters
    ----------
    edge, face : float
        Compliances ``(1 - poisson**2) / young`` of the body with the edge, 0 if it is rigid, and of that with the face.

    Examples
    --------
    >>> elastic_exponent(0.0, 1.0), round(elastic_exponent(1.0, 1.0), 4)
    (0.5, 0.226)
    """
    from scipy.optimize import brentq

    def slopes(s: float) -> float:
        quarter = np.sin(np.pi * s) / (2 * (np.sin(0.5 * np.pi * s) ** 2 - s**2))
        return float(edge * quarter + face / np.tan(np.pi * s))

    return 1 - float(brentq(slopes, 0.5, 1 - 1e-9)) if edge > 0 else RIGID


def law_of(samples: list[Sample], exponent: float) -> EndLaw | None:
    """Decide on the law of an end from its outermost column between splittings; None if it settles.

    Where theory knows the exponent, whatever grows is a power. Else `exponent` is NaN.
    """
    if len(samples) < 4 or samples[-1].pressure <= samples[-2].pressure:
        return None
    if min(sample.pressure for sample in samples[-3:]) <= 0:
        return None
    growth = [
        np.log(after.pressure / before.pressure) / np.log(before.width / after.width)
        for before, after in pairwise(samples[-3:])
    ]
    if min(growth) > LEAST_GROWTH:
        return EndLaw("power", exponent)
    steps = [
        (after.pressure - before.pressure) / np.log(before.width / after.width) for before, after in pairwise(samples)
    ]
    if len(steps) >= 4 and sum(steps[-2:]) > LASTING_STEPS * sum(steps[-4:-2]) > 0:
        return EndLaw("logarithm", 0.0) if np.isnan(exponent) else EndLaw("power", exponent)
    return None


def _fit(edges: FloatArray, row: FloatArray, width: float, exponent: float) -> tuple[float, float]:
    """Least-squares K of the columns' means of ``K d**-m (1 + c d)``, relative to each, and the residual."""
    low, high = edges[:-1], edges[1:]
    used = (low >= 0.999 * NEAREST * width) & (high <= 1.001 * FARTHEST * width) & (row > 0)
    low, high, values = low[used], high[used], row[used]
    if values.size < FEWEST:
        return np.nan, np.inf
    powers = [1 - exponent, 2 - exponent]
    means = [(high**power - low**power) / (power * (high - low)) for power in powers]
    matrix = np.stack(means, axis=1) / values[:, None]
    found = np.linalg.lstsq(matrix, np.ones(values.size), rcond=None)[0]
    return float(found[0]), float(np.sqrt(np.mean((matrix @ found - 1) ** 2)))


def edge_peak(intensity: float, modulus: float, edge_radius: float) -> float:
    """Peak pressure at an edge of small radius on an end that would be singular if it were sharp.

    Parameters
    ----------
    intensity : float
        ``K`` of the sharp end, ``p = K / sqrt(d)``, Pa m**0.5.
    modulus : float
        Contact modulus ``E*``, Pa.
    edge_radius : float
        Radius ``r0`` of the edge, metres; much smaller than the half-width.

    Returns
    -------
    float
        Pa.

    Raises
    ------
    InvalidInputError
        If an argument is not positive.

    Examples
    --------
    >>> round(edge_peak(1e7, 231e9, 1e-5) / 1e9, 3)
    14.189
    """
    k = checks.positive("intensity", intensity, "Pa m**0.5")
    modulus = checks.positive("modulus", modulus, "Pa")
    return float(EDGE_FACTOR * (k**2 * modulus / checks.positive("edge_radius", edge_radius, "metres")) ** (1 / 3))
