"""Axial wavenumbers: the sum over all mirrored loads, written as a few real modes and a decaying ray.

In H every load is extended evenly about both ends, so it is a sum of modes ``cos(k_n x)``, ``k_n = n pi / L``. Modes
with even and odd ``n`` (loads symmetric and antisymmetric about mid-length, ``parity = +1, -1``) never mix. The first
few terms are summed as they stand; for the others the sum is turned into an integral along a ray that leaves the real
axis (Abel and Plana's formula): with ``g`` analytic and real on the real axis,

    sum_n g(k_n) cos(k_n x) = Re int_ray g(k) e(k) L dk / (2 pi),
    e(k) = [exp(i k x) + parity exp(i k (L - x))] / (1 - parity exp(i k L)).

The two exponentials are the contributions seen from either end, and both decay along the ray. A quarter space is the
limit of one end only: the ray starts at ``k = 0`` and the second exponential is gone (``parity = 0``).
"""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from contactstudy.cache import ArrayKey
from contactstudy.checks import ComplexArray, FloatArray
from contactstudy.kernels.load import Load
from contactstudy.overlapping.quadrature import Resolution, ray_nodes
from contactstudy.overlapping.slab import slab_factors


@dataclass(frozen=True, eq=False)
class AxialModes:
    """Axial wavenumbers of one parity; compared by value, because equation sets are kept for them.

    Attributes
    ----------
    length : float
        Distance between the ends, metres; infinite for a quarter space.
    parity : int
        +1 or -1 for loads even or odd about mid-length, 0 for one end only.
    discrete : array
        Wavenumbers ``k_n`` that are summed one by one, 1/m.
    ray, weights : complex array
        Nodes and weights of the rest, 1/m.
    reach : float
        Distance from the end beyond which nothing counts at these wavenumbers, metres; infinite with two ends.
    """

    length: float
    parity: int
    discrete: FloatArray
    ray: ComplexArray
    weights: ComplexArray
    reach: float = np.inf

    @cached_property
    def _identity(self) -> tuple[Hashable, ...]:
        arrays = (self.discrete, self.ray.view(np.float64), self.weights.view(np.float64))
        return type(self), self.length, self.parity, self.reach, *(ArrayKey(array) for array in arrays)

    def __eq__(self, other: object) -> bool:
        """Whether all wavenumbers and weights are the same."""
        return isinstance(other, AxialModes) and self._identity == other._identity

    def __hash__(self) -> int:
        """Hash of the wavenumbers and weights."""
        return hash(self._identity)

    @property
    def wavenumbers(self) -> ComplexArray:
        """All wavenumbers: the discrete ones, then the ray's."""
        return np.concatenate([self.discrete.astype(np.complex128), self.ray])

    @property
    def load_weights(self) -> ComplexArray:
        """Factor from ``int P(x) cosine(x) dx`` to the weighted spectrum of P."""
        single = np.where(self.discrete == 0, 1.0, 2.0) / self.length
        return np.concatenate([single, self.weights * (1 if self.parity else 2) / np.pi])

    @property
    def face_weights(self) -> ComplexArray:
        """Factor from the face loads' ``int M T S / kappa dk_z`` to the weighted spectrum of what they leave on top."""
        return self.load_weights * (4 if self.parity else 2)

    def left_on_top(self, core: ComplexArray, depth: FloatArray, lateral: float, poisson: float) -> ComplexArray:
        """Weighted spectrum of what V leaves on the top per scaled face load: array (wavenumber, depth).

        Parameters
        ----------
        core : complex array (depth, wavenumber)
            Coupling core ``M`` of equations.py.
        depth : array
            Depth wavenumbers ``k_z``, 1/m.
        lateral, poisson : float
            Wavenumber ``k_y``, 1/m, and Poisson's ratio.
        """
        return np.asarray(self.face_weights[:, None] * core.T)

    def face_factor(self, kappa: ComplexArray | FloatArray) -> ComplexArray:
        """Factor ``T`` on what a normal stress freed on the ends leaves on the top."""
        return slab_factors(kappa, self.length, self.parity)[0]

    def applied(self, kappa: ComplexArray) -> ComplexArray:
        """Load on a face per normal stress freed there."""
        return np.ones_like(kappa)

    def beside_face(self, kappa: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        """Amplitude of V's harmonic from either face per normal stress freed there, and its ``tau`` (slab.py)."""
        factor, tau = slab_factors(kappa, self.length, self.parity)
        return factor / (1 - self.parity * np.exp(-kappa * self.length) if self.parity else 1.0), tau

    @property
    def on_end(self) -> ComplexArray:
        """``cosine(0)``: from weighted spectrum to the value on end I."""
        return self.cosine(np.zeros(1))[:, 0]

    def _seen_from_both_ends(self, x: FloatArray, sign: int) -> ComplexArray:
        near = np.exp(1j * np.outer(self.ray, x))
        if not self.parity:
            return np.asarray(np.where(x > self.reach, 0.0, near))
        far = np.exp(1j * np.outer(self.ray, self.length - x))
        closing = 1 - self.parity * np.exp(1j * self.ray * self.length)
        return np.asarray((near + sign * self.parity * far) / closing[:, None])

    def cosine(self, x: FloatArray) -> ComplexArray:
        """Return what stands for ``cos(k x)`` at positions `x`: array (wavenumber, x)."""
        return np.concatenate([np.cos(np.outer(self.discrete, x)), self._seen_from_both_ends(x, +1)])

    def sine(self, x: FloatArray) -> ComplexArray:
        """Return what stands for ``sin(k x)`` at positions `x`: array (wavenumber, x)."""
        return np.concatenate([np.sin(np.outer(self.discrete, x)), -1j * self._seen_from_both_ends(x, -1)])

    def wave(self, load: Load, x: FloatArray) -> ComplexArray:
        """Waves that a load in one direction is a sum of: `cosine`, or `sine` for one that its image reverses."""
        return self.cosine(x) if load.sign_x > 0 else self.sine(x)

    def cell_integrals(self, load: Load, edges: FloatArray) -> ComplexArray:
        """Integrals of `wave` over the cells between `edges`: array (wavenumber, cell)."""
        edges = np.minimum(edges, self.reach)
        k = np.where(self.wavenumbers == 0, 1.0, self.wavenumbers)[:, None]
        if load.sign_x < 0:
            return np.asarray(-np.diff(self.cosine(edges), axis=1) / k)
        integral = np.diff(self.sine(edges), axis=1) / k
        integral[self.wavenumbers == 0] = np.diff(edges)
        return np.asarray(integral)


DECAY_LENGTHS = 14.0
"""Decay lengths from the corner beyond which a wavenumber along y adds nothing: exp(-14) = 8e-7. Accuracy."""

SEPARATE_ENDS = 20.0
"""Decay lengths beyond which the two ends do not affect each other: exp(-20) = 2e-9. Accuracy."""


def axial_modes(length: float, lateral: float, shortest: float, resolution: Resolution) -> list[AxialModes]:
    """Axial modes of a body for wavenumbers along y from `lateral` on.

    Parameters
    ----------
    length : float
        Distance between the ends, metres; infinite for a quarter space.
    lateral : float
        Smallest wavenumber along y that they serve, 1/m.
    shortest : float
        Shortest distance that matters, metres; it bounds the ray.
    resolution : Resolution
        Quadrature settings.

    Returns
    -------
    list of AxialModes
        Even and odd for two ends; one entry, with infinite length and parity 0, for a quarter space and for ends too
        far apart to know of each other, each of which is then a quarter space.
    """
    last = max(resolution.reach / shortest, 4 * lateral)
    if lateral * length > SEPARATE_ENDS:
        reach = DECAY_LENGTHS / lateral
        ray, weights = ray_nodes(0.5 / reach, last, resolution)
        return [AxialModes(np.inf, 0, np.zeros(0), ray, weights, reach)]
    spacing = np.pi / length
    # Between two modes of either parity, half a spacing from the nearest: the ray's integrand has its poles there.
    start = (resolution.modes - 0.5) * spacing
    ray, weights = ray_nodes(0.5 * spacing, last, resolution)
    numbers = np.arange(resolution.modes)
    return [
        AxialModes(length, parity, spacing * numbers[numbers % 2 == remainder], start + ray, weights)
        for parity, remainder in ((1, 0), (-1, 1))
    ]
