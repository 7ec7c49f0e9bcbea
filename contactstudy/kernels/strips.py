"""Strips of load along y: the kernels that all nine displacements of the top are made of, and their integrals.

``k(X, Y)`` is the displacement at a distance X from a strip, differenced over a cell along y, and ``F'' = k`` its
double primitive in X. With ``R**2 = X**2 + Y**2``:

    of 1 / R:        k = asinh(Y / |X|),  F = X**2 / 2 asinh(Y / |X|) + X Y asinh(X / |Y|) - Y X**2 / (2 R + 2 |Y|)
    of X**2 / R**3:  k = Y / R,           F = X Y asinh(X / |Y|) - Y R
    of Y / R**2:     k = ln R,            F = X**2 / 2 ln R + X Y atan(X / Y) - Y**2 / 4 ln(1 + X**2 / Y**2)
    of X / R**2:     k = atan(Y / X),     F = X**2 / 2 atan(Y / X) + X Y ln R + Y**2 / 2 atan(X / Y)
    of X Y / R**3:   k = -X / R,          F = -X R / 2 - Y**2 / 2 asinh(X / |Y|)

(Love's rectangle integrated once more; terms that cancel in the differences are left out). The first three are even in
X, the last two odd, so distances and their sign are enough.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from contactstudy.checks import FloatArray
from contactstudy.kernels.load import Load, Response
from contactstudy.kernels.patch import TINY

Function = Callable[[FloatArray, FloatArray], FloatArray]


@dataclass(frozen=True)
class Strip:
    """Kernel of a strip of load along y, at ``X >= 0`` and ``Y > 0``, and what its integrals need.

    Attributes
    ----------
    kernel : callable
        ``k(X, Y)``, up to terms that do not depend on Y.
    curvature : callable
        ``d2k / dX2``.
    slope : callable
        ``dk / dX``.
    primitive : callable
        Primitive of k in X.
    double_primitive : callable
        Double primitive of k in X, up to terms that cancel in the differences.
    sign_x, sign_y : int
        1 or -1 if what the strip is made of is even or odd in X and in Y.
    row : float or None
        For one whose row of images grows without end: its integral over X is ``2 ln(2 X / Y) + row``.
    """

    kernel: Function
    curvature: Function
    slope: Function
    primitive: Function
    double_primitive: Function
    sign_x: int
    sign_y: int
    row: float | None = None


def _squared(x: FloatArray, y: FloatArray) -> FloatArray:
    return np.asarray(x * x + y * y)


def _log(x: FloatArray, y: FloatArray) -> FloatArray:
    return np.asarray(0.5 * np.log(np.maximum(_squared(x, y), TINY)))


INVERSE = Strip(
    kernel=lambda x, y: np.arcsinh(y / x),
    curvature=lambda x, y: y * (2 * x * x + y * y) / (x * x * _squared(x, y) * np.hypot(x, y)),
    slope=lambda x, y: -y / (x * np.hypot(x, y)),
    primitive=lambda x, y: x * np.arcsinh(y / x) + y * np.arcsinh(x / y),
    double_primitive=lambda x, y: (
        0.5 * x * x * np.arcsinh(y / np.maximum(x, TINY))
        + x * y * np.arcsinh(x / y)
        - 0.5 * y * x * x / (np.hypot(x, y) + y)
    ),
    sign_x=1,
    sign_y=1,
    row=0.0,
)
"""Of 1 / R."""

ACROSS = Strip(
    kernel=lambda x, y: y / np.hypot(x, y),
    curvature=lambda x, y: y * (2 * x * x - y * y) / np.hypot(x, y) ** 5,
    slope=lambda x, y: -x * y / np.hypot(x, y) ** 3,
    primitive=lambda x, y: y * np.arcsinh(x / y),
    # less its value at X = 0, which cancels
    double_primitive=lambda x, y: x * y * np.arcsinh(x / y) - y * x * x / (np.hypot(x, y) + y),
    sign_x=1,
    sign_y=1,
    row=-2.0,
)
"""Of X**2 / R**3."""

AHEAD = Strip(
    kernel=_log,
    curvature=lambda x, y: (y * y - x * x) / _squared(x, y) ** 2,
    slope=lambda x, y: x / _squared(x, y),
    primitive=lambda x, y: x * _log(x, y) + y * np.arctan2(x, y),
    double_primitive=lambda x, y: (
        0.5 * x * x * _log(x, y) + x * y * np.arctan2(x, y) - 0.25 * y * y * np.log1p((x / y) ** 2)
    ),
    sign_x=1,
    sign_y=-1,
)
"""Of Y / R**2."""

BESIDE = Strip(
    kernel=lambda x, y: np.arctan2(y, x),
    curvature=lambda x, y: 2 * x * y / _squared(x, y) ** 2,
    slope=lambda x, y: -y / _squared(x, y),
    primitive=lambda x, y: x * np.arctan2(y, x) + y * _log(x, y),
    double_primitive=lambda x, y: 0.5 * x * x * np.arctan2(y, x) + x * y * _log(x, y) + 0.5 * y * y * np.arctan2(x, y),
    sign_x=-1,
    sign_y=1,
)
"""Of X / R**2."""

DIAGONAL = Strip(
    kernel=lambda x, y: -x / np.hypot(x, y),
    curvature=lambda x, y: 3 * x * y * y / np.hypot(x, y) ** 5,
    slope=lambda x, y: -y * y / np.hypot(x, y) ** 3,
    primitive=lambda x, y: -x * x / (np.hypot(x, y) + y),
    double_primitive=lambda x, y: -0.5 * x * np.hypot(x, y) - 0.5 * y * y * np.arcsinh(x / y),
    sign_x=-1,
    sign_y=-1,
)
"""Of X Y / R**3."""

P, X, Y = Load.NORMAL, Load.ALONG_X, Load.ALONG_Y


def strips_of(response: Response, poisson: float) -> tuple[tuple[float, Strip], ...]:
    """Return strips, with factors, whose sum is ``4 pi G u`` (surface.py)."""
    free = 1 - 2 * poisson
    return {
        Response(P, P): ((2 * (1 - poisson), INVERSE),),
        Response(X, X): ((2 * (1 - poisson), INVERSE), (2 * poisson, ACROSS)),
        Response(Y, Y): ((2.0, INVERSE), (-2 * poisson, ACROSS)),
        Response(P, X): ((free, BESIDE),),
        Response(P, Y): ((free, AHEAD),),
        Response(X, P): ((-free, BESIDE),),
        Response(Y, P): ((-free, AHEAD),),
        Response(X, Y): ((2 * poisson, DIAGONAL),),
        Response(Y, X): ((2 * poisson, DIAGONAL),),
    }[response]
