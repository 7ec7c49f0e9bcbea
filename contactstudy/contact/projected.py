"""Coulomb's law without a guess of the cells that slip: tractions that minimise an energy, by projected gradients.

Under a shift the slip ``s = w - B q`` has a symmetric B, and the tractions that follow the law minimise

    q B q / 2 - w q    for    |q| <= g    in every cell.

The energy is convex, so a descent along the slip, with tractions beyond their bound put back onto it, cannot go round
in circles. It is slow in its last digits, which Newton's method then finds. The length of the steps is that of Barzilai
and Borwein, IMA J. Numer. Anal. 8 (1988) 141, projected as by Birgin, Martinez and Raydan, SIAM J. Optim. 10 (2000)
1196.

Where resultants are prescribed, the rigid slips that make them are those at which the least energy, less their work on
the resultants, is largest: a smooth concave function of few numbers, whose gradient is what the resultants miss.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from contactstudy.checks import FloatArray

STEPS = 500
"""Steps of one descent. Speed."""

SETTLED = 1e-7
"""Change of the tractions in a step, over the largest bound, at which the descent stops. Speed."""

MISSED = 1e-5
"""What resultants miss, over those of full sliding, at which the search for the rigid slips stops. Speed."""

Operator = Callable[[FloatArray], FloatArray]


def balanced_tractions(
    relief: Operator,
    rigid: Callable[[FloatArray], FloatArray],
    works: FloatArray,
    resultants: FloatArray,
    traction: FloatArray,
    amplitudes: FloatArray,
    scale: float,
    bound: FloatArray,
    shares: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Tractions that nearly follow the law, and the amplitudes of the unknown rigid slips.

    Parameters
    ----------
    relief : callable
        ``B``: slip that tractions (2, cell) take away.
    rigid : callable
        Slip (2, cell) of rigid surfaces, from the amplitudes of the unknown ones.
    works, resultants : array (mode, 2, cell), array (mode)
        Weights with which the tractions sum up to each resultant, and what they are to be.
    traction, amplitudes : array (2, cell), array (mode)
        What to begin from; tractions within their bound.
    scale : float
        Size of the rigid slips.
    bound, shares : array (cell)
        Largest traction, Pa, and areas of the cells over their mean, with which B is symmetric.
    """
    from scipy.optimize import minimize

    held = traction

    def descended(some: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        nonlocal held
        whole = rigid(some)
        held, slip = projected_tractions(relief, whole - relief(held), held, bound, shares)
        return held, slip, whole

    if not amplitudes.size:
        return descended(amplitudes)[0], amplitudes
    area = float((works[0] / shares).max())
    largest = np.abs(works).sum(axis=1) @ bound
    unit = scale * float(largest.max())

    def dual(some: FloatArray) -> tuple[float, FloatArray]:
        found, slip, whole = descended(scale * some)
        least = 0.5 * area * float((shares * found * (whole + slip)).sum()) - float(scale * some @ resultants)
        return least / unit, ((works * found).sum(axis=(1, 2)) - resultants) * scale / unit

    found = minimize(dual, amplitudes / scale, jac=True, method="BFGS", options={"gtol": MISSED})
    amplitudes = np.asarray(scale * found.x)
    return descended(amplitudes)[0], amplitudes


def projected_tractions(
    relief: Operator, slip: FloatArray, traction: FloatArray, bound: FloatArray, shares: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Descend from tractions (2, cell) within their bound and the slip under them; return both."""

    def product(first: FloatArray, second: FloatArray) -> float:
        return float((shares * first * second).sum())

    def within(values: FloatArray) -> FloatArray:
        size = np.hypot(*values)
        return np.asarray(values * np.where(size > bound, bound / np.where(size > 0, size, 1.0), 1.0))

    taken = relief(slip)
    curvature = product(slip, taken)
    length = product(slip, slip) / curvature if curvature > 0 else 0.0
    for _ in range(STEPS):
        change = within(traction + length * slip) - traction
        if float(np.abs(change).max()) <= SETTLED * float(bound.max()):
            break
        taken = relief(change)
        curvature = product(change, taken)
        # The energy is least on the way to the projected point, or at it.
        part = min(1.0, product(slip, change) / curvature) if curvature > 0 else 1.0
        traction, slip = traction + part * change, slip - part * taken
        if curvature > 0:
            length = product(change, change) / curvature
    return traction, slip
