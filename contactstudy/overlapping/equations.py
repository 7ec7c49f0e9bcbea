"""The equation set of the overlapping, for one wavenumber along y: face loads from top loads.

With the weighted spectra of axial.py, ``D = k_x**2 + k_y**2 + k_z**2`` and the coupling core

    M(k_x, k_z) = k_x**2 k_z**2 / D**2 + nu k_y**2 / D

a top load ``P`` leaves on the ends, in H, the normal stress ``-(4/pi) M / k`` per unit (cosine transform along z), and
a face load ``S`` leaves on the top, in V, ``4 M T / kappa`` per unit (cosine coefficients along x), where
``k**2 = k_x**2 + k_y**2``, ``kappa**2 = k_y**2 + k_z**2`` and ``T`` tells the slab from a half-space. The ends are
free when

    S = (4/pi) sum (M / k) (P + R),    R = int (4 M T / kappa) S dk_z,

a linear system for ``S`` at the depth nodes whose matrix is symmetric after scaling (reciprocity). It is the equation
set of Hetenyi's and Keer's alternating scheme, solved at once.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy import linalg

from contactstudy.checks import ComplexArray, FloatArray
from contactstudy.kernels.load import Load
from contactstudy.overlapping.axial import AxialModes
from contactstudy.overlapping.quadrature import (
    Resolution,
    ray_nodes,
    scale_nodes,
)


def inverse_square(axial: ComplexArray, depth: ComplexArray | FloatArray, lateral: float) -> ComplexArray:
    """``1 / D``, which all couplings share: array (depth, axial)."""
    return np.asarray(1.0 / ((axial * axial + lateral**2)[None, :] + (depth * depth)[:, None]))


def coupling_core(
    inverse: ComplexArray, axial: ComplexArray, depth: ComplexArray | FloatArray, lateral: float, poisson: float
) -> ComplexArray:
    """Core ``M(k_x, k_z)``, from ``1 / D``: array (depth, axial)."""
    core = (depth * depth)[:, None] * inverse
    core *= axial * axial
    core += poisson * lateral**2
    core *= inverse
    return core


def normal_on_end(
    inverse: ComplexArray, axial: ComplexArray, depth: ComplexArray | FloatArray, lateral: float, poisson: float
) -> ComplexArray:
    """Face load that frees the end from a unit top pressure, from ``1 / D``: array (depth, axial)."""
    k = np.sqrt(axial * axial + lateral**2)
    return np.asarray(coupling_core(inverse, axial, depth, lateral, poisson) * (4 / np.pi / k))


def lateral_on_end(
    inverse: ComplexArray, axial: ComplexArray, depth: ComplexArray | FloatArray, lateral: float, poisson: float
) -> ComplexArray:
    """Face load that frees the end from a unit top traction along y, without its factor i: array (depth, axial)."""
    axial2, depth2 = (axial * axial)[None, :], (depth * depth)[:, None]
    k2 = axial2 + lateral**2
    bracket = 2 * poisson * lateral**2 - axial2 * (k2 - depth2) * inverse
    bracket *= inverse
    bracket *= -(2 / np.pi) * lateral / k2
    return np.asarray(bracket)


def axial_on_end(
    inverse: ComplexArray, axial: ComplexArray, depth: ComplexArray | FloatArray, lateral: float, poisson: float
) -> ComplexArray:
    """Face load that frees the end from a unit top traction along x, a sine series: array (depth, axial).

    The traction leaves ``(k_x / k) [2 + 2 nu k_y**2 / k**2 - (k_x / k)**2 k z] exp(-k z)`` on the end (the column of
    `lateral_on_end` with x and y exchanged), of which this is the cosine transform along z, reversed.
    """
    axial2, depth2 = (axial * axial)[None, :], (depth * depth)[:, None]
    k2 = axial2 + lateral**2
    bracket = 2 * (k2 + poisson * lateral**2) - axial2 * (k2 - depth2) * inverse
    bracket *= inverse
    bracket *= -(2 / np.pi) * axial / k2
    return np.asarray(bracket)


ON_END = {Load.NORMAL: normal_on_end, Load.ALONG_X: axial_on_end, Load.ALONG_Y: lateral_on_end}
"""Face load that frees the end from a unit load on the top, by its direction."""


def real_product(left: ComplexArray, right: ComplexArray) -> FloatArray:
    """Real part of ``left @ right`` over the last axis of `left` and the first of `right`, as one real product."""
    # Real and imaginary parts lie side by side in memory; those of the conjugate are reversed where they multiply.
    flat_left = np.ascontiguousarray(left).reshape(-1, left.shape[-1]).view(np.float64)
    flat_right = np.ascontiguousarray(right.reshape(right.shape[0], -1).T.conj()).view(np.float64)
    return np.asarray((flat_left @ flat_right.T).reshape(*left.shape[:-1], *right.shape[1:]))


class AuxiliaryLoads(NamedTuple):
    """Loads on the auxiliary bodies, for one wavenumber along y.

    Attributes
    ----------
    equivalent : complex array (wavenumber, column)
        Weighted spectrum, before `AxialModes.cosine`, of the load that is added on the top of H.
    depth : complex array
        Depth wavenumbers on their ray, where the face loads are an analytic function.
    face_load : complex array (depth, column)
        Normal stress freed on the faces of V, times the quadrature's weights.
    """

    equivalent: ComplexArray
    depth: ComplexArray
    face_load: ComplexArray


@dataclass(frozen=True, eq=False)
class EquationSet:
    """The equation set for one wavenumber along y and one parity, factorised.

    Attributes
    ----------
    modes : AxialModes
        Axial wavenumbers.
    lateral : float
        Wavenumber ``k_y``, 1/m.
    poisson : float
        Poisson's ratio.
    depth : array
        Depth wavenumbers ``k_z``, 1/m.
    scale : array
        ``T dk_z / kappa`` at the depth nodes.
    core : complex array (depth, wavenumber)
        Coupling core ``M`` between depth nodes and axial wavenumbers.
    top : complex array (wavenumber, depth)
        Weighted spectrum, before `AxialModes.cosine`, of what a scaled face load leaves on the top.
    factor : tuple of array
        Factorised matrix ``1 / scale - N`` of the set.
    """

    modes: AxialModes
    lateral: float
    poisson: float
    depth: FloatArray
    scale: FloatArray
    core: ComplexArray
    top: ComplexArray
    factor: tuple[FloatArray, FloatArray]

    @classmethod
    def build(
        cls, modes: AxialModes, lateral: float, poisson: float, shortest: float, resolution: Resolution
    ) -> EquationSet:
        """Assemble and factorise; `shortest` is the smallest distance from a loaded corner that matters."""
        last = max(resolution.reach / shortest, 4 * lateral)
        depth, weights = scale_nodes(0.5 * lateral, last, resolution.step)
        kappa = np.sqrt(depth**2 + lateral**2)
        scale = np.real(modes.face_factor(kappa)) * weights / kappa
        axial = modes.wavenumbers
        core = coupling_core(inverse_square(axial, depth, lateral), axial, depth, lateral, poisson)
        k = np.sqrt(axial**2 + lateral**2)
        top = modes.left_on_top(core, depth, lateral, poisson)
        end = core * (4 / np.pi / k * modes.on_end)
        matrix = np.diag(1 / scale) - real_product(end, top)
        return cls(modes, lateral, poisson, depth, scale, core, top, linalg.lu_factor(matrix))

    @property
    def nbytes(self) -> int:
        """Memory held, bytes."""
        arrays = (self.depth, self.scale, self.core, self.top, *self.factor)
        return sum(array.nbytes for array in arrays)

    def solve(self, source: FloatArray) -> FloatArray:
        """Scaled face loads ``scale * S`` from what the top load alone asks for at the depth nodes."""
        return np.asarray(linalg.lu_solve(self.factor, source))

    def source(self, load: Load, spectrum: ComplexArray) -> FloatArray:
        """Face loads that free the ends from a top load of weighted `spectrum` (wavenumber, ...) in H alone.

        That of a traction along y lacks its factor i; the spectrum of one along x is that of a sine series.
        """
        axial = self.modes.wavenumbers
        if load is Load.NORMAL:  # as normal_on_end, from the core that is at hand
            operator = self.core * (4 / np.pi / np.sqrt(axial**2 + self.lateral**2))
        else:
            inverse = inverse_square(axial, self.depth, self.lateral)
            operator = ON_END[load](inverse, axial, self.depth, self.lateral, self.poisson)
        return real_product(operator, spectrum)

    def on_top(self, scaled_face_load: FloatArray) -> ComplexArray:
        """Weighted spectrum, before `cosine`, of the load that the faces leave on the top."""
        return np.asarray(self.top @ scaled_face_load)

    def auxiliary_loads(
        self, spectrum: ComplexArray, loads: Sequence[Load], *, shortest: float, resolution: Resolution
    ) -> AuxiliaryLoads:
        """Solve for the loads on H and V that free the ends from one distribution, acting in each direction in turn.

        Parameters
        ----------
        spectrum : complex array (wavenumber, column)
            Weighted spectrum of the distribution.
        loads : sequence of Load
            Directions; the columns of the first come first.
        shortest : float
            Smallest distance from a loaded corner that matters, metres.
        resolution : Resolution
            Quadrature settings.
        """
        equivalent = self.on_top(self.solve(np.hstack([self.source(load, spectrum) for load in loads])))
        last = max(resolution.ray_reach / shortest, 4 * self.lateral)
        depth, weights = ray_nodes(0.5 * self.lateral, last, resolution)
        axial = self.modes.wavenumbers
        columns = spectrum.shape[1]
        total = self.modes.on_end[:, None] * equivalent
        own = {load: slice(i * columns, (i + 1) * columns) for i, load in enumerate(loads)}
        if Load.NORMAL in own:
            total[:, own[Load.NORMAL]] += spectrum
        # Half the sum over both half-planes: at complex depth the second is not the first's conjugate.
        face_load = np.zeros((depth.size, total.shape[1]), np.complex128)
        for k, normal, asis in ((axial, total, spectrum), (axial.conj(), total.conj(), spectrum.conj())):
            given = inverse_square(k, depth, self.lateral), k, depth, self.lateral, self.poisson
            face_load += 0.5 * (normal_on_end(*given) @ normal)
            for load, place in own.items():
                if load is not Load.NORMAL:
                    face_load[:, place] += 0.5 * (ON_END[load](*given) @ asis)
        return AuxiliaryLoads(equivalent, depth, weights[:, None] * face_load)
