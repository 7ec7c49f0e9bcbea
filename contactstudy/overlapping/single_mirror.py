"""The scheme with one pair of mirrored loads and two separate vertical half-spaces, for comparison.

H carries ``P_h1`` on 0 .. L and its mirror images on -L .. 0 and L .. 2L, and no others; V1 and V2 are half-spaces with
their faces at x = 0 and x = L, each mirrored at the top. The equation set asks for the load on the top and for ends
free of normal stress, that of the other vertical half-space included. Of the shear on the ends only the part is gone
that the images present take away. The scheme is that of Z. M. Zhang, W. Wang and P. L. Wong (An explicit solution for
the elastic quarter-space problem in matrix formulation, Int. J. Solids Struct. 50 (2013) 976) carried to two ends.

With the body's load of one parity about mid-length all parts have that parity, and one end tells it all. Differences
from the exact set are three:

* H's normal stress on end I comes from a load and its image, and from the other image alone: per load at x' it is
  ``exp(i k x') (1 + parity exp(i k L) / 2)``, the first terms of the exact geometric series;
* a face load ``S`` meets the normal stress ``parity (1 + kappa L) exp(-kappa L) S`` of the opposite half-space, so per
  stress freed it is ``T = 1 / (1 + parity (1 + kappa L) exp(-kappa L))``;
* what V leaves on the top, ``K(x) = exp(-kappa x) (a - b kappa x)`` with ``b = k_z**2 / kappa**2`` and
  ``a = b + 2 nu k_y**2 / kappa**2``, loads H on 0 .. L only; its spectrum lacks the tail beyond L and has an image.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from contactstudy.checks import ComplexArray, FloatArray
from contactstudy.overlapping.axial import SEPARATE_ENDS, AxialModes, axial_modes
from contactstudy.overlapping.quadrature import Resolution, ray_nodes


@dataclass(frozen=True, eq=False)
class SingleMirrorModes(AxialModes):
    """Axial wavenumbers of one parity when loads are mirrored once; all lie on the ray."""

    @property
    def load_weights(self) -> ComplexArray:
        """Factor from ``int P(x) cosine(x) dx`` to the weighted spectrum of P and its two images, as end I sees it."""
        second_image = 0.5 * self.parity * np.exp(1j * self.ray * self.length)
        return np.asarray(self.weights / np.pi * (1 + second_image))

    def _seen_from_both_ends(self, x: FloatArray, sign: int) -> ComplexArray:
        near = np.exp(1j * np.outer(self.ray, x))
        far = np.exp(1j * np.outer(self.ray, self.length - x))
        return np.asarray(near + sign * self.parity * far)

    def left_on_top(self, core: ComplexArray, depth: FloatArray, lateral: float, poisson: float) -> ComplexArray:
        """Weighted spectrum of what V1 and V2 leave on 0 .. L and of its two images: array (wavenumber, depth)."""
        length, k = self.length, self.ray[:, None]
        kappa = np.sqrt(depth**2 + lateral**2)
        b = (depth / kappa) ** 2
        a = b + 2 * poisson * (lateral / kappa) ** 2
        across, decay = np.exp(1j * k * length), np.exp(-kappa * length)
        at_far_end = a - b * kappa * length
        # int_0^inf K(L + x) exp(i k x) dx: the tail that is not there, on either side
        against = kappa - 1j * k
        tail = decay * (at_far_end - b * kappa / against) / against
        # int_0^L K(x) exp(i k (L - x)) dx: V1's load in the image beyond end II, V2's in that beyond end I
        along = kappa + 1j * k
        image = (across * (a - b * kappa / along) - decay * (at_far_end - b * kappa / along)) / along
        truncation = self.parity * (image - tail) - across * tail
        return np.asarray(self.weights[:, None] / np.pi * (4 * core.T + kappa * truncation))

    def face_factor(self, kappa: ComplexArray | FloatArray) -> ComplexArray:
        """Factor ``T`` on what a normal stress freed on the ends leaves on the top: the load on a face."""
        scaled = np.asarray(kappa * self.length, dtype=np.complex128)
        decay = np.exp(-scaled)
        if self.parity > 0:
            return np.asarray(1 / (1 + (1 + scaled) * decay))
        return np.asarray(1 / (-np.expm1(-scaled) - scaled * decay))

    def applied(self, kappa: ComplexArray) -> ComplexArray:
        """Load on a face per normal stress freed there: the opposite half-space frees the rest."""
        return self.face_factor(kappa)

    def beside_face(self, kappa: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        """Amplitude of either half-space's harmonic per normal stress freed; there is no slab and no ``tau``."""
        return self.face_factor(kappa), np.zeros_like(kappa)


def modes_between_ends(
    length: float, lateral: float, shortest: float, resolution: Resolution, *, mirrored_once: bool
) -> list[AxialModes]:
    """Axial modes as `axial_modes` makes them, or with loads that are mirrored once only.

    Ends that are too far apart to know of each other are quarter spaces either way.

    Examples
    --------
    >>> [modes.parity for modes in modes_between_ends(8.0, 1.0, 0.1, Resolution(), mirrored_once=True)]
    [1, -1]
    """
    if not mirrored_once or lateral * length > SEPARATE_ENDS:
        return axial_modes(length, lateral, shortest, resolution)
    last = max(resolution.reach / shortest, 4 * lateral)
    ray, weights = ray_nodes(lateral / 36, last, resolution)
    return [SingleMirrorModes(length, parity, np.zeros(0), ray, weights) for parity in (1, -1)]
