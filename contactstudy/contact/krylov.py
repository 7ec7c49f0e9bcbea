"""Generalised minimal residuals: a linear system that is not symmetric, by products with its matrix alone.

Y. Saad and M. H. Schultz, SIAM J. Sci. Stat. Comput. 7 (1986) 856, preconditioned from the right, so that the residual
that is made small is that of the system itself.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from contactstudy.checks import FloatArray

Operator = Callable[[FloatArray], FloatArray]


def minimal_residual(
    matrix: Operator, inverse: Operator, residual: FloatArray, accuracy: float, *, directions: int, restarts: int
) -> FloatArray:
    """Change of the unknowns that takes a residual away, to some accuracy.

    Parameters
    ----------
    matrix, inverse : callable
        The matrix times a vector, and roughly its inverse times a vector.
    residual : array (unknown)
        What the change is to take away.
    accuracy : float
        Part of the residual's norm that may be left.
    directions, restarts : int
        Directions that are kept at a time, and how often they begin anew.

    Returns
    -------
    array (unknown)
        The change; if the accuracy was not reached, the best that was found.

    Examples
    --------
    >>> skew = np.array([[1.0, 2.0], [-2.0, 1.0]])
    >>> minimal_residual(skew.__matmul__, np.copy, np.array([5.0, 0.0]), 1e-10, directions=2, restarts=1).round(9)
    array([1., 2.])
    """
    change = np.zeros_like(residual)
    allowed = accuracy * float(np.linalg.norm(residual))
    for restart in range(restarts):
        size = float(np.linalg.norm(residual))
        if size <= allowed:
            break
        basis = np.empty((min(directions, residual.size) + 1, residual.size))
        basis[0] = residual / size
        triangle, turned = np.zeros((len(basis), len(basis) - 1)), np.zeros(len(basis))
        turned[0] = size
        rotations: list[tuple[float, float]] = []
        for number in range(len(basis) - 1):
            new = matrix(inverse(basis[number]))
            before = basis[: number + 1]
            column = before @ new
            new = new - column @ before
            # Once more: the first time leaves rounding errors of the large part along the others.
            again = before @ new
            new -= again @ before
            column, length = column + again, float(np.linalg.norm(new))
            for place, (cosine, sine) in enumerate(rotations):
                upper, lower = column[place : place + 2]
                column[place], column[place + 1] = cosine * upper + sine * lower, cosine * lower - sine * upper
            whole = float(np.hypot(column[-1], length))
            if whole == 0:  # the matrix gives nothing new, nor what is asked for
                break
            cosine, sine = float(column[-1]) / whole, length / whole
            rotations.append((cosine, sine))
            column[-1] = whole
            triangle[: number + 1, number] = column
            turned[number : number + 2] = cosine * turned[number], -sine * turned[number]
            if abs(turned[number + 1]) <= allowed or length <= np.finfo(float).eps * whole:
                break
            basis[number + 1] = new / length
        count = len(rotations)
        if not count:
            break
        parts = np.linalg.solve(triangle[:count, :count], turned[:count])
        change += inverse(parts @ basis[:count])
        if abs(turned[count]) <= allowed or restart == restarts - 1:
            break
        residual = residual - matrix(inverse(parts @ basis[:count]))
    return change
