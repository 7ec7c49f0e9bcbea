"""Plastic flow at an instant, in all cells of the cross-section at once.

The stress is that of the passing contact plus the residual stress R e of the plastic strain e, with R symmetric and
negative. The step from the plastic strain e0 makes

    -(s, e) - (e, R e) / 2 + (2/3) H_k |e|^2 / 2 + int of the yield stress times the strain's length

least (J. C. Simo, T. J. R. Hughes, Computational Inelasticity, 1998, chapters 1 and 2). R is no stiffer than Hooke's
law with the total strain held, and with that law instead the minimum is von Mises' radial return. So radial returns,
one after the other, with the residual stress computed anew before each, go down to the minimum (the initial stress
method of O. C. Zienkiewicz, S. Valliappan, I. P. King, Int. J. Numer. Meth. Engng 1 (1969) 75). They are accelerated
by Nesterov's extrapolation, which begins anew where it leads up (B. O'Donoghue, E. Candes, Found. Comput. Math. 15
(2015) 715).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from contactstudy.checks import FloatArray

MOST_RETURNS = 400
"""Radial returns of an instant; more are needed only where nothing contains the flow."""

DOUBLED = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])[:, None]
"""How often each component stands in a tensor."""


class Residual(Protocol):
    """Residual stresses (6, cell) from plastic strains (6, cell)."""

    def stresses(self, eigenstrain: FloatArray) -> FloatArray:
        """Return the stresses."""


def deviator(stress: FloatArray) -> FloatArray:
    """Deviator of tensors (6, ...): xx, yy, zz, xy, xz, yz."""
    found = stress.copy()
    found[:3] -= stress[:3].mean(axis=0)
    return found


def length(tensor: FloatArray) -> FloatArray:
    """Euclidean length of tensors (6, cell)."""
    return np.asarray(np.sqrt((DOUBLED * tensor**2).sum(axis=0)))


class State(NamedTuple):
    """What passes have left in some cells so far.

    Attributes
    ----------
    strain : array (6, cell)
        Plastic strain.
    accumulated : array (cell)
        Equivalent plastic strain, accumulated.
    residual : array (6, cell)
        Residual stress of the strain, Pa.
    contained : bool
        Whether the flow of every instant was contained.
    """

    strain: FloatArray
    accumulated: FloatArray
    residual: FloatArray
    contained: bool


@dataclass(frozen=True, eq=False)
class Flow:
    """What decides plastic flow in some cells.

    Attributes
    ----------
    residual : Residual
        Residual stress of plastic strains in the cells.
    yield_stress : array (cell)
        Yield stress in tension, Pa.
    shear_modulus, isotropic, kinematic : float
        Shear modulus and hardening moduli, Pa.
    tolerance : float
        Change of the deviator over the yield stress between two returns below which the flow is found.
    """

    residual: Residual
    yield_stress: FloatArray
    shear_modulus: float
    isotropic: float
    kinematic: float
    tolerance: float

    def step(self, elastic: FloatArray, before: State) -> State:
        """State after the elastic stress (6, cell) of the contact has become this, Pa."""
        strain = before.strain
        radius = np.sqrt(2 / 3) * (self.yield_stress + self.isotropic * before.accumulated)
        stiffness = 2 * self.shear_modulus + 2 / 3 * (self.isotropic + self.kinematic)
        outset = deviator(elastic) - 2 / 3 * self.kinematic * strain
        left = before.residual
        if (length(outset + deviator(left)) <= radius).all():
            return before
        latest, guess, momentum, contained = strain, strain, 1.0, False
        for _ in range(MOST_RETURNS):
            trial = outset + deviator(left) + 2 * self.shear_modulus * (guess - strain)
            size = length(trial)
            multiplier = np.maximum(size - radius, 0.0) / stiffness
            found = strain + multiplier / np.maximum(size, 1e-300) * trial
            contained = bool(
                (2 * self.shear_modulus * length(found - guess) <= self.tolerance * self.yield_stress).all()
            )
            change = found - latest
            if contained:
                latest = found
                break
            if (DOUBLED * (guess - found) * change).sum() > 0:
                momentum = 1.0
            following = 0.5 * (1 + np.sqrt(1 + 4 * momentum**2))
            guess, latest = found + (momentum - 1) / following * change, found
            momentum = following
            left = self.residual.stresses(guess)
        accumulated = before.accumulated + np.sqrt(2 / 3) * length(latest - strain)
        return State(latest, accumulated, self.residual.stresses(latest), before.contained and contained)
