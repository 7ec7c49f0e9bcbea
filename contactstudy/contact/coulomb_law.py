"""What Coulomb's law asks of tractions, the tractions that follow it, and by how much some violate it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from contactstudy.checks import BoolArray, FloatArray

Operator = Callable[[FloatArray], FloatArray]


@dataclass(frozen=True, eq=False)
class CoulombProblem:
    """Coulomb's law on the cells of a contact.

    Attributes
    ----------
    relief : callable
        ``B``: slip that tractions (2, cell) take away.
    inverse : callable
        Roughly the tractions that take a slip away.
    bound : array (cell)
        Largest traction, Pa; positive.
    rigid : array (2, cell)
        Slip of rigid surfaces as far as it is prescribed.
    modes : array (mode, 2, cell)
        Rigid slips of unknown amplitude.
    works : array (mode, 2, cell)
        Weights with which the tractions sum up to the resultant of each mode.
    resultants : array (mode)
        Prescribed resultants.
    shares : array (cell)
        Areas of the cells over their mean, by which the linear systems are symmetric and their residual is a mean.
    tolerance : float
        Violation, over the largest bound and the largest rigid slip, at which the iteration stops.
    max_steps : int
        Bound on the steps of Newton's method.
    symmetric : bool
        Whether B is symmetric, so that the tractions minimise an energy.
    """

    relief: Operator
    inverse: Operator
    bound: FloatArray
    rigid: FloatArray
    modes: FloatArray
    works: FloatArray
    resultants: FloatArray
    shares: FloatArray
    tolerance: float = 1e-6
    max_steps: int = 40
    symmetric: bool = False

    def slip(self, traction: FloatArray, amplitudes: FloatArray) -> FloatArray:
        """Slip (2, cell) under tractions."""
        return self.rigid_slip(amplitudes) - self.relief(traction)

    def rigid_slip(self, amplitudes: FloatArray) -> FloatArray:
        """Slip (2, cell) of rigid surfaces."""
        return np.asarray(self.rigid + np.tensordot(amplitudes, self.modes, axes=1))


@dataclass(frozen=True, eq=False)
class CoulombSolution:
    """Tractions that follow Coulomb's law.

    Attributes
    ----------
    traction, slip : array (2, cell)
        Tractions, Pa, and slip.
    sticks : bool array (cell)
        Cells that stick.
    amplitudes : array (mode)
        Amplitudes of the rigid slips that were unknown.
    steps, applications : int
        Steps of Newton's method, and applications of the operator.
    converged : bool
        Whether the tolerance was reached.
    """

    traction: FloatArray
    slip: FloatArray
    sticks: BoolArray
    amplitudes: FloatArray
    steps: int
    applications: int
    converged: bool


def law_violation(
    traction: FloatArray, slip: FloatArray, bound: FloatArray, sticks: BoolArray, scale: float
) -> tuple[float, float]:
    """Violations of the law: of the bound, over the largest one, and of slip and its direction, over `scale`.

    Where a cell sticks its slip counts; where it slips, the part across its traction and the part against it.
    """
    size = np.hypot(*traction)
    largest = float(bound.max(initial=0.0))
    over = float(np.maximum(size - bound, 0.0).max(initial=0.0)) / largest if largest else 0.0
    direction = traction / np.where(size > 0, size, 1.0)
    along = (slip * direction).sum(axis=0)
    across = slip[0] * direction[1] - slip[1] * direction[0]
    sliding = np.hypot(across, np.minimum(along, 0.0))
    wrong = np.where(sticks, np.hypot(*slip), sliding)
    return over, float(wrong.max(initial=0.0)) / scale
