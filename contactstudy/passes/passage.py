"""Plastic flow during one pass of a contact, at all places along the way at once.

The contact has come from far and goes on: seen from it the pass is steady. What it meets is the state that the pass
before has left, uniform along the way; what it leaves is uniform again, and between the two the plastic strain changes
along y. The residual stress at each place is that of the strain at all places. Two steps are repeated until the strain
does not change any more (K. Dang Van, M. H. Maitournam, J. Mech. Phys. Solids 41 (1993) 1691):

* with the total strain held at each place, every point is taken along the way, and von Mises' radial return gives its
  plastic strain (J. C. Simo, T. J. R. Hughes, Computational Inelasticity, 1998, chapter 3);
* the body's answer to this plastic strain gives the total strain anew.

The repetition is accelerated by D. G. Anderson's mixing of the latest iterates (J. ACM 12 (1965) 547).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from contactstudy.checks import FloatArray, IntArray
from contactstudy.passes.tensors import DOUBLED, deviator, length

MOST_REPETITIONS = 300
"""Bound on the repetitions of a pass. Speed."""

MIXED = 6
"""Latest iterates that are mixed. Speed."""

RANK = 1e-10
"""Part of the largest below which differences between iterates are not told apart. Accuracy."""


class Residual(Protocol):
    """Residual stresses (6, cell) from plastic strains (6, cell) that are uniform along y."""

    def stresses(self, eigenstrain: FloatArray) -> FloatArray:
        """Return the stresses."""


class Along(Protocol):
    """Residual stresses (6, place, column, layer) from plastic strains that change along y."""

    def stresses(self, eigenstrain: FloatArray) -> FloatArray:
        """Return the stresses."""


class State(NamedTuple):
    """What passes have left in some cells so far.

    Attributes
    ----------
    strain : array (6, cell)
        Plastic strain.
    accumulated : array (cell)
        Equivalent plastic strain, accumulated.
    converged : bool
        Whether every pass reached its tolerance.
    """

    strain: FloatArray
    accumulated: FloatArray
    converged: bool


@dataclass(frozen=True, eq=False)
class Passage:
    """A pass over some cells of the cross-section.

    Attributes
    ----------
    elastic : array (6, place, cell)
        Stress of the contact along the way, Pa.
    residual, layers : Residual
        Residual stress of strains that are uniform along y: of the body, and of layers without an end.
    along : Along
        The same of layers with strains that change along y, on a closed way whose first places are those of `elastic`.
    places : int
        Places on the closed way.
    box : tuple of array (cell)
        Column and layer of each cell in `along`.
    yield_stress : array (cell)
        Yield stress in tension, Pa.
    shear_modulus, isotropic, kinematic : float
        Shear modulus and hardening moduli, Pa.
    tolerance : float
        Change of the deviator over the yield stress between two repetitions below which the flow is found.
    """

    elastic: FloatArray
    residual: Residual
    layers: Residual
    along: Along
    places: int
    box: tuple[IntArray, IntArray]
    yield_stress: FloatArray
    shear_modulus: float
    isotropic: float
    kinematic: float
    tolerance: float

    def after(self, before: State) -> State:
        """State that the pass leaves."""
        held = 2 * self.shear_modulus
        start = self.elastic + self.residual.stresses(before.strain)[:, None]
        flowed = np.zeros_like(start)
        mixing = _Mixing()
        for _ in range(MOST_REPETITIONS):
            trial = deviator(start + self._answer(flowed)) + held * (before.strain[:, None] + flowed)
            found, accumulated = self._returned(trial, before)
            change = found - flowed
            converged = bool((held * length(change).max(axis=0) <= self.tolerance * self.yield_stress).all())
            if converged:
                break
            flowed = mixing.next(flowed, change)
        return State(before.strain + found[:, -1], accumulated, before.converged and converged)

    def _answer(self, flowed: FloatArray) -> FloatArray:
        """Residual stress (6, place, cell) of plastic strain (6, place, cell) that this pass has made so far.

        Columns side by side answer for themselves to what changes along y. The difference that the whole body makes for
        the strain that stays grows like the part of it that is there already.
        """
        last = flowed[:, -1]
        column, layer = self.box
        inside = np.zeros((6, self.places, column.max() + 1, layer.max() + 1))
        behind = flowed.shape[1]
        inside[:, :behind, column, layer] = flowed
        inside[:, behind:, column, layer] = _fading(self.places - behind)[:, None] * last[:, None]
        found = self.along.stresses(inside)[:, :behind, column, layer]
        size = float(DOUBLED @ (last**2).sum(axis=1))
        if size:
            share = np.einsum("i,ipc,ic->p", DOUBLED, flowed, last) / size
            difference = self.residual.stresses(last) - self.layers.stresses(last)
            found += np.clip(share, 0.0, 1.0)[:, None] * difference[:, None]
        return np.asarray(found)

    def _returned(self, trial: FloatArray, before: State) -> tuple[FloatArray, FloatArray]:
        """Plastic strain that this pass has made at each place, and the equivalent one accumulated after it.

        `trial` is the deviator of stress that there would be without plastic strain, with the same total strain.
        """
        kinematic = 2 / 3 * self.kinematic
        held = 2 * self.shear_modulus + kinematic
        stiffness = held + 2 / 3 * self.isotropic
        strain, accumulated = before.strain, before.accumulated
        found = np.empty_like(trial)
        for place in range(trial.shape[1]):
            relative = trial[:, place] - held * strain
            size = length(relative)
            radius = np.sqrt(2 / 3) * (self.yield_stress + self.isotropic * accumulated)
            if (size > radius).any():
                multiplier = np.maximum(size - radius, 0.0) / stiffness
                strain = strain + multiplier / np.maximum(size, radius) * relative
                accumulated = accumulated + np.sqrt(2 / 3) * multiplier
            found[:, place] = strain - before.strain
        return found, accumulated


class _Mixing:
    """Anderson's mixing."""

    def __init__(self) -> None:
        self._iterates: list[FloatArray] = []
        self._changes: list[FloatArray] = []

    def next(self, iterate: FloatArray, change: FloatArray) -> FloatArray:
        """Return the iterate to go on with after one, and what the repetition changed it by."""
        self._iterates = [*self._iterates[-MIXED:], iterate]
        self._changes = [*self._changes[-MIXED:], change]
        if len(self._changes) == 1:
            return np.asarray(iterate + change)
        steps, bends = (np.diff(np.stack(kept), axis=0) for kept in (self._iterates, self._changes))
        flat = bends.reshape(len(bends), -1)
        weights = np.linalg.lstsq(flat @ flat.T, flat @ change.ravel(), rcond=RANK)[0]
        return np.asarray(iterate + change - np.tensordot(weights, steps + bends, axes=1))


def _fading(places: int) -> FloatArray:
    """Part of the strain that stays at the places that close the way: all of it first, none in the end.

    Examples
    --------
    >>> _fading(6).round(2).tolist()
    [1.0, 1.0, 1.0, 0.93, 0.5, 0.07]
    """
    left = np.clip(2 - 2 * (np.arange(places) + 0.5) / places, 0.0, 1.0)
    return np.asarray(left**2 * (3 - 2 * left))
