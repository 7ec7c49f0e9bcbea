"""The equation set of the overlapping, for one wavenumber along y: face loads from top loads.

With the coupling core ``M``, eq. (17), a top load ``P`` has on the ends, in H, the normal stress ``-(4/pi) M / k`` per
unit (cosine transform along z), and a face load ``S`` has on the top, in V, ``4 M T / kappa`` per unit (cosine
coefficients along x), where ``k**2 = k_x**2 + k_y**2``, ``kappa**2 = k_y**2 + k_z**2`` and ``T`` is the factor of the
slab (axial_modes.py). The ends are free when ``S`` solves eqs. (26) and (26a), a linear system at the depth nodes whose
matrix is symmetric after scaling, eq. (27): Hetenyi's and Keer's alternating scheme, solved at once.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np
from scipy import linalg

from contactstudy.checks import ComplexArray, FloatArray, IntArray
from contactstudy.kernels.load import Load
from contactstudy.overlapping.axial_modes import AxialModes
from contactstudy.overlapping.quadrature import Resolution, ray_nodes, scale_nodes


def coupling_core(
    axial: ComplexArray, depth: ComplexArray | FloatArray, lateral: float, poisson: float
) -> ComplexArray:
    """Core ``M(k_x, k_z)``: array (depth, axial)."""
    depth2 = (depth * depth)[:, None]
    inverse = 1.0 / ((axial * axial + lateral**2)[None, :] + depth2)
    core = depth2 * inverse  # eq. (17)
    core *= axial * axial
    core += poisson * lateral**2
    core *= inverse
    return np.asarray(core)


def load_on_end(
    load: Load, axial: ComplexArray, depth: ComplexArray | FloatArray, lateral: float, poisson: float
) -> ComplexArray:
    """Face load that frees the end from a unit load on the top: array (depth, axial)."""
    # A traction along y omits the factor i; a traction along x uses a sine series. A traction along x causes
    # ``(k_x / k) [2 + 2 nu k_y**2 / k**2 - (k_x / k)**2 k z] exp(-k z)`` on the end (along y with x and y exchanged),
    # with the cosine transform along z of opposite sign.
    if load is Load.NORMAL:
        k = np.sqrt(axial * axial + lateral**2)
        # eq. (16), from the transforms of eq. (15)
        return np.asarray(coupling_core(axial, depth, lateral, poisson) * (4 / np.pi / k))
    axial2, depth2 = (axial * axial)[None, :], (depth * depth)[:, None]
    k2 = axial2 + lateral**2
    inverse = 1.0 / (k2 + depth2)
    along_y = load is Load.ALONG_Y
    constant = 2 * poisson * lateral**2 if along_y else 2 * (k2 + poisson * lateral**2)  # eqs. (18) and (29a)
    end_load = constant - axial2 * (k2 - depth2) * inverse
    end_load *= inverse
    end_load *= -(2 / np.pi) * (lateral if along_y else axial) / k2
    return np.asarray(end_load)


def real_product(left_factor: ComplexArray, right_factor: ComplexArray) -> FloatArray:
    """Real part of the product over the left factor's last and the right factor's first axis, by real arithmetic."""
    # Real and imaginary parts alternate in memory: the product with the conjugate is the real part.
    flat_left = np.ascontiguousarray(left_factor).reshape(-1, left_factor.shape[-1]).view(np.float64)
    flat_right = np.ascontiguousarray(right_factor.reshape(right_factor.shape[0], -1).T.conj()).view(np.float64)
    return np.asarray((flat_left @ flat_right.T).reshape(*left_factor.shape[:-1], *right_factor.shape[1:]))


class AuxiliaryLoads(NamedTuple):
    """Loads on the auxiliary bodies, for one wavenumber along y, per direction of the load."""

    equivalent: list[ComplexArray]
    """Weighted spectra (wavenumber, column), before `cosine`, of the load added on H's top."""
    depth: ComplexArray  # depth wavenumbers on their ray, where the face loads are an analytic function
    face_load: list[ComplexArray]
    """Normal stresses (depth, column) freed on the faces of V, times the quadrature's weights."""


@dataclass(frozen=True, kw_only=True, eq=False)
class EquationSet:
    """The equation set for one wavenumber along y and one parity, factorised."""

    modes: AxialModes  # axial wavenumbers
    lateral: float  # wavenumber ``k_y``, 1/m
    poisson: float
    depth: FloatArray  # depth wavenumbers ``k_z``, 1/m
    scale: FloatArray  # ``T dk_z / kappa`` at the depth nodes
    core: ComplexArray  # (depth, wavenumber): coupling core ``M`` between depth nodes and axial wavenumbers
    top: ComplexArray  # (wavenumber, depth): weighted spectrum of the top load, before `cosine`, per scaled face load
    rows: IntArray  # rows of the set's matrix ``1 / scale - N`` in the order of its LU factors
    factors: FloatArray

    @classmethod
    def build(
        cls, modes: AxialModes, lateral: float, poisson: float, shortest: float, resolution: Resolution
    ) -> EquationSet:
        """Assemble and factorise; `shortest` is the smallest distance from a loaded corner that matters."""
        last_wavenumber = max(resolution.reach / shortest, 4 * lateral)
        depth, weights = scale_nodes(0.5 * lateral, last_wavenumber, resolution.step)
        kappa = np.sqrt(depth**2 + lateral**2)
        scale = np.real(modes.face_factor(kappa)) * weights / kappa
        axial = modes.wavenumbers
        core = coupling_core(axial, depth, lateral, poisson)
        k = np.sqrt(axial**2 + lateral**2)
        top = modes.load_on_top(core, depth, lateral, poisson)
        end_load = core * (4 / np.pi / k * modes.on_end)
        factors, pivots = linalg.lu_factor(np.diag(1 / scale) - real_product(end_load, top))  # eq. (27)
        rows = list(range(pivots.size))
        for row, pivot in enumerate(pivots.tolist()):
            rows[row], rows[pivot] = rows[pivot], rows[row]
        return cls(
            modes=modes,
            lateral=lateral,
            poisson=poisson,
            depth=depth,
            scale=scale,
            core=core,
            top=top,
            rows=np.array(rows),
            factors=factors,
        )

    def solve(self, source: FloatArray, *, transposed: bool = False) -> FloatArray:
        """Scaled face loads ``scale * S`` from the source of a top load at the depth nodes, or the transposed map."""
        # `scipy.linalg.lu_solve` changes its pivots during the call (SciPy 1.17), and threads share the factors.
        solve = partial(linalg.blas.dtrsm, 1.0, self.factors, trans_a=int(transposed))
        if not transposed:
            return np.asarray(solve(solve(source[self.rows], lower=1, diag=1)))
        solution = np.empty(source.shape)
        solution[self.rows] = solve(solve(source), lower=1, diag=1)
        return solution

    def load_to_faces(self, load: Load) -> ComplexArray:
        """Face loads that free the ends from unit modes of a top load in H: array (depth, wavenumber)."""
        # The matrix of a traction along y lacks its factor i; the modes of a traction along x are sines.
        axial = self.modes.wavenumbers
        if load is Load.NORMAL:  # as load_on_end, from the stored core
            return self.core * (4 / np.pi / np.sqrt(axial**2 + self.lateral**2))
        return load_on_end(load, axial, self.depth, self.lateral, self.poisson)

    def source(self, load: Load, spectrum: ComplexArray) -> FloatArray:
        """Face loads that free the ends from a top load of weighted `spectrum` (wavenumber, ...) in H alone."""
        return real_product(self.load_to_faces(load), spectrum)

    def spectrum_on_top(self, scaled_face_load: FloatArray) -> ComplexArray:
        """Weighted spectrum, before `cosine`, of the load on the top from scaled face loads."""
        return np.asarray(self.top @ scaled_face_load)  # eq. (26a)

    def auxiliary_loads(
        self, spectrum: ComplexArray, loads: Sequence[Load], *, shortest: float, resolution: Resolution
    ) -> AuxiliaryLoads:
        """Solve for the loads on H and V that free the ends from one distribution, acting in each direction in turn."""
        # Separate products: the result in one direction is bit for bit independent of the other directions.
        depth, weights = self.ray_nodes(shortest, resolution)
        top_modes, top_conjugates = self.ray_to_faces(Load.NORMAL, depth)
        equivalent_loads, face_loads = [], []
        for load in loads:
            equivalent = self.spectrum_on_top(self.solve(self.source(load, spectrum)))
            top_spectrum = self.modes.on_end[:, None] * equivalent
            if load is Load.NORMAL:
                top_spectrum += spectrum
            face_load = top_modes @ top_spectrum + top_conjugates @ top_spectrum.conj()  # eq. (26)
            if load is not Load.NORMAL:
                mode_matrix, conjugate_matrix = self.ray_to_faces(load, depth)
                face_load += mode_matrix @ spectrum + conjugate_matrix @ spectrum.conj()
            equivalent_loads.append(equivalent)
            face_loads.append(weights[:, None] * face_load)
        return AuxiliaryLoads(equivalent_loads, depth, face_loads)

    def ray_nodes(self, shortest: float, resolution: Resolution) -> tuple[ComplexArray, ComplexArray]:
        """Depth wavenumbers on their ray, and the weights of the quadrature."""
        return ray_nodes(0.5 * self.lateral, max(resolution.ray_reach / shortest, 4 * self.lateral), resolution)

    def ray_to_faces(self, load: Load, depth: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        """Face loads at complex `depth` wavenumbers from modes and from their conjugate: arrays (depth, wavenumber)."""
        # The sum over both half-planes is halved: at complex depth the second matrix is not the first's conjugate.
        axial = self.modes.wavenumbers
        mode_matrix, conjugate_matrix = (
            0.5 * load_on_end(load, k, depth, self.lateral, self.poisson) for k in (axial, axial.conj())
        )
        return mode_matrix, conjugate_matrix
