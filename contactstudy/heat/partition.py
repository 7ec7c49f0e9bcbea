"""How two bodies share the heat of their contact: so that their surfaces are equally hot wherever they touch."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.sparse.linalg import LinearOperator, gmres

from contactstudy.checks import BoolArray, FloatArray

TOLERANCE = 1e-9
"""Difference of the two temperatures over the first guess's at which the iteration stops. Accuracy."""

RESTART, MOST_RESTARTS = 60, 20
"""Steps between restarts, and restarts. Speed."""

Heated = Callable[[FloatArray], FloatArray]
"""Temperature rise from heat."""


class Shared(NamedTuple):
    """Heat into the first body, W/m2, and how well the temperatures agree."""

    heat: FloatArray
    mismatch: float


def shared_heat(first: Heated, second: Heated, heat: FloatArray, touching: BoolArray) -> Shared:
    """Find the heat into the first body; the second takes the rest.

    Where no heat is made, as in a stick zone, it still flows from one body into the other.

    Parameters
    ----------
    first, second : callable
        Temperature rise of the bodies' surfaces from heat that goes into them.
    heat : array (x, y)
        Heat that friction makes, W/m2.
    touching : array (x, y)
        Where the surfaces touch.
    """
    if not heat.any():  # surfaces of the same speed
        return Shared(np.zeros(heat.shape), 0.0)

    def on_cells(values: FloatArray) -> FloatArray:
        full = np.zeros(heat.shape)
        full[touching] = values
        return full

    alone, other = first(heat)[touching], second(heat)[touching]
    share = other.max() / (alone.max() + other.max())  # Blok's: equal largest temperatures
    guess = share * heat[touching]
    count = guess.size

    def summed(values: FloatArray) -> FloatArray:
        full = on_cells(np.asarray(values).ravel())
        return np.asarray((first(full) + second(full))[touching])

    operator = LinearOperator((count, count), matvec=summed, dtype=np.float64)
    found, _ = gmres(operator, other, x0=guess, rtol=TOLERANCE, restart=min(RESTART, count), maxiter=MOST_RESTARTS)
    mismatch = float(np.abs(summed(found) - other).max() / max(np.abs(other).max(), np.finfo(float).tiny))
    return Shared(on_cells(found), mismatch)
