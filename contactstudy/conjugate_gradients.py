"""Unilateral contact under a prescribed load by preconditioned conjugate gradients.

The scheme of I. A. Polonsky and L. M. Keer, Wear 231 (1999) 206, with two changes that save most of its iterations:
the descent direction is preconditioned by the inverse of the operator's spectrum, restricted to the contact (J. Zhao,
E. A. H. Vollebregt, C. W. Oosterlee, Math. Comput. Sci. 9 (2015) 375, use the like for Hertz' problem), and the gap is
updated along the search direction while the contact area stays as it is.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from contactstudy.checks import FloatArray

Operator = Callable[[FloatArray], FloatArray]


@dataclass(frozen=True)
class ContactIterate:
    """Where the iteration ended.

    Attributes
    ----------
    pressure : array (x, y)
        Pressure, Pa; its sum over the cells is the prescribed one.
    approach : float
        Rigid approach that the iteration arrived at, metres.
    applications : int
        Applications of the operator.
    converged : bool
        Whether the tolerance was reached.
    """

    pressure: FloatArray
    approach: float
    applications: int
    converged: bool


def solve_complementarity(
    operator: Operator,
    preconditioner: Operator,
    gap: FloatArray,
    total: float,
    start: FloatArray,
    *,
    tolerance: float,
    max_iterations: int,
) -> ContactIterate:
    """Pressure ``p >= 0`` with gap ``g = gap + operator(p) - approach >= 0``, ``p g = 0`` and ``sum(p) = total``.

    Parameters
    ----------
    operator, preconditioner : callable
        Symmetric positive operators on arrays (x, y): displacement from pressure, and roughly its inverse.
    gap : array (x, y)
        Initial gap, metres; infinite where contact is impossible.
    total : float
        Prescribed sum of the pressure over the cells, Pa.
    start : array (x, y)
        First guess of the pressure; not negative, zero where the gap is infinite, not zero everywhere.
    tolerance : float
        Bound on the largest violation of the gap conditions over the displacement's variation, and on the last
        change of the pressure over its sum.
    max_iterations : int
        Bound on the iterations.

    Returns
    -------
    ContactIterate
    """
    possible = np.isfinite(gap)
    pressure = start * (total / start.sum())
    applications = 1
    sunk = operator(pressure)
    direction = np.zeros_like(pressure)
    previous = np.zeros_like(pressure)
    slope = 0.0
    contact = pressure > 0
    weight = np.zeros_like(pressure)
    approach, converged, fresh = 0.0, False, True
    for _ in range(max_iterations):
        if fresh:
            weight = np.where(contact, preconditioner(contact.astype(np.float64)), 0.0)
        height = np.where(possible, gap + sunk, np.inf)
        inside = np.where(contact, height, 0.0)
        approach = float((weight * inside).sum() / weight.sum())
        residual = np.where(contact, height - approach, 0.0)
        violation = np.where(contact, np.abs(residual), np.maximum(approach - height, 0.0)).max()
        scale = np.ptp(sunk)
        descent = np.where(contact, preconditioner(residual), 0.0)
        new_slope = float((residual * descent).sum())
        if fresh or slope == 0.0:
            direction = descent
        else:
            # Polak and Ribiere's form forgives that the preconditioner is not exactly symmetric on the contact.
            direction = descent + float(((residual - previous) * descent).sum()) / slope * direction
        slope, previous = new_slope, residual
        direction = np.where(contact, direction, 0.0)
        along = operator(direction)
        applications += 1
        curvature = float((direction * along).sum())
        step = float((residual * direction).sum()) / curvature if curvature > 0 else 0.0
        moved = pressure - step * direction
        closed = ~contact & (height < approach - 0.1 * tolerance * scale)
        clipped = moved < 0
        change = abs(step) * float(np.abs(direction).sum()) / total
        fresh = bool(clipped.any() or closed.any())
        if fresh:
            moved[clipped] = 0.0
            if closed.any():
                # As in Polonsky and Keer: overlapping points enter with the step along the gap itself.
                scaled = preconditioner(np.where(closed, height - approach, 0.0))
                moved[closed] = np.maximum(-scaled[closed], 1e-12 * moved.max())
            moved *= total / moved.sum()
            pressure = moved
            contact = pressure > 0
            sunk = operator(pressure)
            applications += 1
        else:
            pressure = moved
            sunk = sunk - step * along
        if not fresh and violation <= tolerance * scale and change <= tolerance:
            converged = True
            break
        if curvature <= 0:
            break
    pressure = pressure * (total / pressure.sum())
    return ContactIterate(pressure, approach, applications, converged)
