"""Dimensions of Hertz contacts: point, line and ellipse.

The line contact also stands in :mod:`contactstudy.bodies.hertz`, which the solver uses. It is written here a second
time on purpose: a reference that called the code under test would repeat its mistakes.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy import optimize, special

from contactstudy.errors import InvalidInputError


def composite_modulus(young: float, poisson: float, young_2: float = np.inf, poisson_2: float = 0.0) -> float:
    """`E*` of two bodies; the second one is rigid unless given."""
    return 1 / ((1 - poisson**2) / young + (1 - poisson_2**2) / young_2)


def hertz_point(load: float, radius: float, modulus: float) -> tuple[float, float, float]:
    """Contact radius, peak pressure and approach of a sphere (Johnson 4.22 to 4.24); `modulus` is `E*`."""
    a = float(np.cbrt(0.75 * load * radius / modulus))
    return a, 1.5 * load / (np.pi * a**2), a**2 / radius


def hertz_line(load_per_length: float, radius: float, modulus: float) -> tuple[float, float]:
    """Half-width and peak pressure of a line contact (Johnson 4.43, 4.45)."""
    a = float(np.sqrt(4 * load_per_length * radius / (np.pi * modulus)))
    return a, 2 * load_per_length / (np.pi * a)


def hertz_line_from_pressure(max_pressure: float, radius: float, modulus: float) -> tuple[float, float]:
    """Half-width and load per length of the line contact that has this peak pressure."""
    a = 2 * max_pressure * radius / modulus
    return a, 0.5 * np.pi * a * max_pressure


class EllipticContact(NamedTuple):
    """Semi-axes, peak pressure and approach of an elliptic contact."""

    long: float
    short: float
    max_pressure: float
    approach: float


def hertz_ellipse(load: float, long_radius: float, short_radius: float, modulus: float) -> EllipticContact:
    """Elliptic contact of a body with two radii of curvature and a plane (Johnson 4.26 to 4.32).

    With ``e`` the eccentricity of the ellipse and the complete elliptic integrals ``K`` and ``E`` of ``e**2`` the ratio
    of the curvatures is ``[E / (1 - e**2) - K] / (K - E)``; the ellipse's long axis lies along the long radius.

    Parameters
    ----------
    load : float
        Normal load.
    long_radius, short_radius : float
        Radii of curvature in the two principal directions, the first one the larger.
    modulus : float
        Contact modulus ``E*``.

    Raises
    ------
    InvalidInputError
        If the first radius is the smaller.

    Examples
    --------
    >>> [round(float(value), 4) for value in hertz_ellipse(4 / 3, 1.0, 1.0, 1.0)]
    [1.0, 1.0, 0.6366, 1.0]
    """
    if not long_radius >= short_radius:
        raise InvalidInputError("long_radius", long_radius, f"at least short_radius, {short_radius:g}", "exchange them")
    if np.isclose(long_radius, short_radius, rtol=1e-9):
        a, peak, approach = hertz_point(load, long_radius, modulus)
        return EllipticContact(a, a, peak, approach)

    def ratio(squared: float) -> float:
        k, e = special.ellipk(squared), special.ellipe(squared)
        return float((e / (1 - squared) - k) / (k - e))

    squared = optimize.brentq(lambda m: ratio(m) - long_radius / short_radius, 1e-9, 1 - 1e-12, xtol=1e-15)
    k, e = special.ellipk(squared), special.ellipe(squared)
    # Curvature along the long axis: 1 / (2 R') = p0 b / (E* e**2 a**2) (K - E).
    shape = np.sqrt(1 - squared)
    long = float(np.cbrt(3 * load * long_radius * (k - e) / (np.pi * modulus * squared)))
    short = float(shape * long)
    peak = 1.5 * load / (np.pi * long * short)
    return EllipticContact(long, short, float(peak), float(peak * short * k / modulus))
