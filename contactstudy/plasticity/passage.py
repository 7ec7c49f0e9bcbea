"""Plastic flow during one pass of a contact, at all positions along y at once.

In coordinates that move with the contact the pass is steady. Ahead of the contact the state of the former pass is
uniform along y; behind it the state is uniform again, and between the two the plastic strain changes along y. The
residual stress at each position depends on the strain at all positions. Two steps alternate until the strain is
stationary (K. Dang Van, M. H. Maitournam, J. Mech. Phys. Solids 41 (1993) 1691):

* at fixed total strain, von Mises' radial return along y gives the plastic strain of every point
  (J. C. Simo, T. J. R. Hughes, Computational Inelasticity, 1998, chapter 3);
* the elastic body's stress of this plastic strain gives the total strain.

D. G. Anderson's mixing of the latest iterates (J. ACM 12 (1965) 547) accelerates the iteration.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from contactstudy.checks import FloatArray, IntArray

DOUBLED = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])  # How often each component stands in a tensor


def deviator(tensor: FloatArray) -> FloatArray:
    """Deviator of tensors."""
    deviatoric = tensor.copy()
    deviatoric[:3] -= tensor[:3].mean(axis=0)
    return deviatoric


def length(tensor: FloatArray) -> FloatArray:
    """Euclidean length of tensors."""
    return np.asarray(np.sqrt(np.tensordot(DOUBLED, tensor**2, axes=1)))


MOST_REPETITIONS = 300  # Bound on the repetitions of a pass
MIXED = 6  # Latest iterates that are mixed


class Residual(Protocol):
    """Residual stresses (6, cell) from plastic strains (6, cell) that are uniform along y."""

    def stresses(self, eigenstrain: FloatArray) -> FloatArray:
        """Return the stresses."""


class Along(Protocol):
    """Residual stresses (6, place, column, layer) from plastic strains that change along y."""

    def stresses(self, eigenstrain: FloatArray) -> FloatArray:
        """Return the stresses."""


class State(NamedTuple):
    """State of some cells after passes."""

    strain: FloatArray  # (6, cell), plastic
    accumulated: FloatArray  # (cell), equivalent plastic strain
    converged: bool


@dataclass(frozen=True, eq=False)
class Passage:
    """A pass over some cells of the cross-section."""

    elastic: FloatArray  # (6, place, cell), stress of the contact, Pa
    residual: Residual  # of the body, strains uniform along y
    layers: Residual  # of layers without an end
    along: Along  # of layers, strains that change along y on a closed way
    places: int  # on the closed way
    box: tuple[IntArray, IntArray]  # column and layer (cell) in `along`
    yield_stress: FloatArray  # (cell), in tension, Pa
    shear_modulus: float  # Pa
    isotropic: float  # Pa
    kinematic: float  # Pa
    tolerance: float  # change of the deviator over the yield stress

    def after(self, before: State) -> State:
        """State that the pass leaves."""
        stiffness = 2 * self.shear_modulus
        start = self.elastic + self.residual.stresses(before.strain)[:, None]
        flowed = np.zeros_like(start)
        mixing = _Mixing()
        for _ in range(MOST_REPETITIONS):
            trial = deviator(start + self._evaluate(flowed)) + stiffness * (before.strain[:, None] + flowed)
            plastic, accumulated = self._return_mapping(trial, before)
            change = plastic - flowed
            converged = bool((stiffness * length(change).max(axis=0) <= self.tolerance * self.yield_stress).all())
            if converged:
                break
            flowed = mixing.next(flowed, change)
        return State(before.strain + plastic[:, -1], accumulated, before.converged and converged)

    def _evaluate(self, flowed: FloatArray) -> FloatArray:
        """Residual stress (6, place, cell) of this pass's plastic strain (6, place, cell), columns in plane strain.

        The correction to the whole body grows with the part of the final strain that the pass has made.
        """
        last = flowed[:, -1]
        column, layer = self.box
        inside = np.zeros((6, self.places, column.max() + 1, layer.max() + 1))
        behind = flowed.shape[1]
        inside[:, :behind, column, layer] = flowed
        inside[:, behind:, column, layer] = _fading(self.places - behind)[:, None] * last[:, None]
        stress = self.along.stresses(inside)[:, :behind, column, layer]
        size = float(DOUBLED @ (last**2).sum(axis=1))
        if size:
            share = np.einsum("i,ipc,ic->p", DOUBLED, flowed, last) / size
            difference = self.residual.stresses(last) - self.layers.stresses(last)
            stress += np.clip(share, 0.0, 1.0)[:, None] * difference[:, None]
        return np.asarray(stress)

    def _return_mapping(self, trial: FloatArray, before: State) -> tuple[FloatArray, FloatArray]:
        """Plastic strain of this pass and the accumulated one; `trial`: the deviator without plastic strain."""
        kinematic = 2 / 3 * self.kinematic
        modulus = 2 * self.shear_modulus + kinematic
        stiffness = modulus + 2 / 3 * self.isotropic
        strain, accumulated = before.strain, before.accumulated
        flow = np.empty_like(trial)
        for position in range(trial.shape[1]):
            relative = trial[:, position] - modulus * strain
            size = length(relative)
            radius = np.sqrt(2 / 3) * (self.yield_stress + self.isotropic * accumulated)
            if (size > radius).any():
                multiplier = np.maximum(size - radius, 0.0) / stiffness
                strain = strain + multiplier / np.maximum(size, radius) * relative
                accumulated = accumulated + np.sqrt(2 / 3) * multiplier
            flow[:, position] = strain - before.strain
        return flow, accumulated


class _Mixing:
    """Anderson's mixing."""

    def __init__(self) -> None:
        self._iterates: list[FloatArray] = []
        self._changes: list[FloatArray] = []

    def next(self, iterate: FloatArray, change: FloatArray) -> FloatArray:
        """Next iterate from an iterate and its change."""
        self._iterates = [*self._iterates[-MIXED:], iterate]
        self._changes = [*self._changes[-MIXED:], change]
        if len(self._changes) == 1:
            return np.asarray(iterate + change)
        steps, bends = (np.diff(np.stack(history), axis=0) for history in (self._iterates, self._changes))
        flat = bends.reshape(len(bends), -1)
        # Singular value over the largest below which differences between iterates count as dependent
        weights = np.linalg.lstsq(flat @ flat.T, flat @ change.ravel(), rcond=1e-10)[0]
        return np.asarray(iterate + change - np.tensordot(weights, steps + bends, axes=1))


def _fading(places: int) -> FloatArray:
    """Part of the strain that stays at the places that close the way: all of it first, none in the end."""
    ramp = np.clip(2 - 2 * (np.arange(places) + 0.5) / places, 0.0, 1.0)
    return np.asarray(ramp**2 * (3 - 2 * ramp))
