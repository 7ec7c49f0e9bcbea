"""Rough surfaces in a film: pressure of the asperities and mean height of the film."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.special import erf

from contactstudy import checks
from contactstudy.checks import FloatArray
from contactstudy.film.reynolds import Law

NODE_COUNT = 64  # Gauss points of the integral over the asperities. Accuracy.
MAX_HEIGHT = 6.0  # Highest asperity over the composite rms roughness; 1e-9 of the asperities are higher. Accuracy.


@dataclass(frozen=True, kw_only=True)
class Asperities:
    """Composite roughness of both surfaces, and the pressure that its asperities carry.

    Greenwood and Tripp (1970): ``p_c = 16 sqrt(2) pi / 15 (eta beta sigma)**2 sqrt(sigma / beta) E* F_5/2(h / sigma)``.

    Parameters
    ----------
    rms : float
        Composite rms roughness ``sigma``, metres.
    density : float
        ``eta beta sigma``: number of asperities per area times their radius times `rms`; 0.03 to 0.05.
    sharpness : float
        ``sigma / beta``: `rms` over the asperities' radius; 1e-4 to 1e-2.
    pressure : callable, optional
        Replaces this law: pressure, Pa, at distances of the mean planes, metres (array to array); falls with distance.

    Raises
    ------
    InvalidInputError
        If a value is not a positive number.

    Examples
    --------
    >>> rough = Asperities(rms=0.2e-6)
    >>> [round(1e-6 * float(rough.pressure_at(np.array(h * 0.2e-6), 115e9)), 3) for h in (0.0, 1.0, 3.0)]
    [26.568, 3.471, 0.007]
    """

    rms: float
    density: float = 0.05
    sharpness: float = 1e-3
    pressure: Callable[[FloatArray], FloatArray] | None = None

    def __post_init__(self) -> None:
        """Check the values."""
        checks.store(self, rms=checks.positive("rms", self.rms, "metres"))
        for name in ("density", "sharpness"):
            checks.store(self, **{name: checks.positive(name, getattr(self, name))})

    def pressure_at(self, distance: FloatArray, modulus: float) -> FloatArray:
        """Pressure of the asperities, Pa, at distances of the mean planes, metres; `modulus` is E*, Pa."""
        return self._law(distance, modulus).value

    def _law(self, distance: FloatArray, modulus: float) -> Law:
        if self.pressure is not None:
            step = 1e-4 * self.rms
            pressures = [np.asarray(self.pressure(distance + offset * step), dtype=np.float64) for offset in (-1, 0, 1)]
            return Law(pressures[1], (pressures[2] - pressures[0]) / (2 * step))
        factor = 16 * np.sqrt(2) * np.pi / 15 * self.density**2 * np.sqrt(self.sharpness) * modulus  # eq. (412)
        ratio = distance / self.rms
        return Law(factor * _integrate_overlap(ratio, 2.5), -2.5 * factor * _integrate_overlap(ratio, 1.5) / self.rms)

    def scaled_law(self, height: float, pressure: float, modulus: float) -> Callable[[FloatArray], Law]:
        """Return the asperities' law with heights in units of `height`, m, and pressures in units of `pressure`, Pa."""

        def law(distance: FloatArray) -> Law:
            dimensional_law = self._law(distance * height, modulus)
            return Law(dimensional_law.value / pressure, dimensional_law.slope * height / pressure)

        return law

    def mean_height(self, height: float) -> Callable[[FloatArray], Law]:
        """Return the law of the mean film between rough surfaces, in units of `height`, m: Patir and Cheng (1979)."""
        scale = self.rms / height

        def law(distance: FloatArray) -> Law:
            ratio = distance / scale
            contact_fraction = 0.5 * (1 + erf(ratio / np.sqrt(2)))
            # At ratios far below zero the two terms cancel.
            gaussian = np.exp(-0.5 * np.minimum(ratio**2, 1e3)) / np.sqrt(2 * np.pi)
            film = scale * np.maximum(ratio * contact_fraction + gaussian, gaussian / (2 + ratio**2))  # eq. (413)
            return Law(film, np.maximum(contact_fraction, 1e-300))

        return law


def _integrate_overlap(height_ratio: FloatArray, power: float) -> FloatArray:
    """Integral of ``(s - height_ratio)**power`` over the normal distribution of s, from `height_ratio` up."""
    nodes, weights = np.polynomial.legendre.leggauss(NODE_COUNT)
    lower_limit = np.minimum(height_ratio, MAX_HEIGHT)
    half_range = 0.5 * (MAX_HEIGHT - np.maximum(lower_limit, -MAX_HEIGHT))
    heights = MAX_HEIGHT - half_range[..., None] * (1 - nodes)
    depth = np.maximum(heights - lower_limit[..., None], 0.0)
    density = np.exp(-0.5 * heights**2) / np.sqrt(2 * np.pi)
    return np.asarray(half_range * ((depth**power * density) @ weights))
