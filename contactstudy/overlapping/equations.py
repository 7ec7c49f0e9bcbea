"""Axial wavenumbers, and the equation set of the overlapping for one wavenumber along y: face loads from top loads.

The sum over all mirrored loads is a few real axial modes and a decaying ray, by the formula of Abel and Plana, eqs.
(31) and (32) of docs/explanation/numerics.md. Loads even and odd about mid-length (``parity = +1, -1``) never mix; a
quarter space has one end (``parity = 0``). The single-mirror scheme serves comparisons (docs/explanation/theory.md,
section 10).

With the coupling core ``M``, eq. (17), a top load ``P`` has on the ends, in H, the normal stress ``-(4/pi) M / k`` per
unit (cosine transform along z), and a face load ``S`` has on the top, in V, ``4 M T / kappa`` per unit (cosine
coefficients along x), where ``k**2 = k_x**2 + k_y**2``, ``kappa**2 = k_y**2 + k_z**2`` and ``T`` is the factor of the
slab. The ends are free when ``S`` solves eqs. (26) and (26a), a linear system at the depth nodes whose matrix is
symmetric after scaling, eq. (27): Hetenyi's and Keer's alternating scheme, solved at once.
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
from contactstudy.overlapping.quadrature import Resolution, ray_nodes, scale_nodes


@dataclass(frozen=True, kw_only=True, eq=False)
class AxialModes:
    """Axial wavenumbers of one parity."""

    length: float  # distance between the ends, metres; infinite for a quarter space
    parity: int  # +1 or -1 for loads even or odd about mid-length, 0 for one end only
    discrete: FloatArray  # wavenumbers ``k_n`` that are summed one by one, 1/m
    ray: ComplexArray  # nodes and weights on the ray, for all further wavenumbers, 1/m
    weights: ComplexArray
    reach: float = np.inf  # from the end, metres, beyond which waves of these wavenumbers are negligible

    @property
    def wavenumbers(self) -> ComplexArray:
        """All wavenumbers: the discrete ones, then the ray's."""
        return np.concatenate([self.discrete.astype(np.complex128), self.ray])

    @property
    def load_weights(self) -> ComplexArray:
        """Factor from ``int P(x) cosine(x) dx`` to the weighted spectrum of P."""
        discrete_weights = np.where(self.discrete == 0, 1.0, 2.0) / self.length  # eq. (7)
        return np.concatenate([discrete_weights, self.weights * (1 if self.parity else 2) / np.pi])

    def load_on_top(self, core: ComplexArray, depth: FloatArray, lateral: float, poisson: float) -> ComplexArray:
        """Weighted spectrum of the load of V on the top per scaled face load: array (wavenumber, depth)."""
        # Factor from the face loads' ``int M T S / kappa dk_z``: eq. (23), without T / kappa.
        return np.asarray((self.load_weights * (4 if self.parity else 2))[:, None] * core.T)

    def face_factor(self, kappa: ComplexArray | FloatArray) -> ComplexArray:
        """Factor ``T``: load on the top per normal stress removed from the ends."""
        return slab_factors(kappa, self.length, self.parity)[0]

    def load_on_face(self, kappa: ComplexArray) -> ComplexArray:
        """Load on a face per normal stress freed on this face."""
        return np.ones_like(kappa)

    def face_amplitude(self, kappa: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        """Amplitude of V's harmonic from either face per normal stress removed, and its ``tau``."""
        factor, tau = slab_factors(kappa, self.length, self.parity)
        # eq. (25), the slab of eqs. (19) and (20) as two waves
        return factor / (1 - self.parity * np.exp(-kappa * self.length) if self.parity else 1.0), tau

    @property
    def on_end(self) -> ComplexArray:
        """``cosine(0)``: factor from a weighted spectrum to the value on end I."""
        return self.cosine(np.zeros(1))[:, 0]

    def _waves_of_ends(self, x: FloatArray, sign: int) -> ComplexArray:
        first_end = np.exp(1j * np.outer(self.ray, x))
        if not self.parity:
            return np.asarray(np.where(x > self.reach, 0.0, first_end))
        second_end = np.exp(1j * np.outer(self.ray, self.length - x))
        image_sum = 1 - self.parity * np.exp(1j * self.ray * self.length)  # eq. (31)
        return np.asarray((first_end + sign * self.parity * second_end) / image_sum[:, None])

    def cosine(self, x: FloatArray) -> ComplexArray:
        """Return waves ``cos(k x)``, on the ray the sum of both ends, at positions `x`: array (wavenumber, x)."""
        return np.concatenate([np.cos(np.outer(self.discrete, x)), self._waves_of_ends(x, +1)])

    def sine(self, x: FloatArray) -> ComplexArray:
        """Return waves ``sin(k x)``, on the ray the sum of both ends, at positions `x`: array (wavenumber, x)."""
        return np.concatenate([np.sin(np.outer(self.discrete, x)), -1j * self._waves_of_ends(x, -1)])

    def wave(self, load: Load, x: FloatArray) -> ComplexArray:
        """Waves that sum up to a load in one direction: `cosine`, or `sine` if a mirror image reverses the load."""
        return self.cosine(x) if load.sign_x > 0 else self.sine(x)

    def cell_integrals(self, load: Load, edges: FloatArray) -> ComplexArray:
        """Integrals of `wave` over the cells between `edges`, as in eq. (7): array (wavenumber, cell)."""
        edges = np.minimum(edges, self.reach)
        k = np.where(self.wavenumbers == 0, 1.0, self.wavenumbers)[:, None]
        if load.sign_x < 0:
            return np.asarray(-np.diff(self.cosine(edges), axis=1) / k)
        integral = np.diff(self.sine(edges), axis=1) / k
        integral[self.wavenumbers == 0] = np.diff(edges)
        return np.asarray(integral)


DECAY_LENGTHS = 14.0
"""Decay lengths from the corner beyond which a wavenumber along y contributes nothing: exp(-14) = 8e-7. Accuracy."""

SEPARATE_ENDS = 20.0  # decay lengths beyond which the two ends do not affect each other: exp(-20) = 2e-9. Accuracy.


def axial_modes(
    length: float, lateral: float, shortest: float, resolution: Resolution, *, mirrored_once: bool = False
) -> list[AxialModes]:
    """Even and odd axial modes for wavenumbers along y from `lateral` on; modes of parity 0 for a single or far end."""
    # `shortest` is the least distance that matters, and bounds the ray. Loads have all images or are mirrored once;
    # ends far apart are quarter spaces in both schemes.
    last_wavenumber = max(resolution.reach / shortest, 4 * lateral)
    if lateral * length > SEPARATE_ENDS:
        reach = DECAY_LENGTHS / lateral
        ray, weights = ray_nodes(0.5 / reach, last_wavenumber, resolution)
        return [AxialModes(length=np.inf, parity=0, discrete=np.zeros(0), ray=ray, weights=weights, reach=reach)]
    if mirrored_once:
        ray, weights = ray_nodes(lateral / 36, last_wavenumber, resolution)
        return [
            SingleMirrorModes(length=length, parity=parity, discrete=np.zeros(0), ray=ray, weights=weights)
            for parity in (1, -1)
        ]
    spacing = np.pi / length
    # The ray starts half a spacing from the nearest mode of either parity: the modes are poles of the integrand.
    ray_start = (resolution.modes - 0.5) * spacing  # eq. (32)
    ray, weights = ray_nodes(0.5 * spacing, last_wavenumber, resolution)
    indices = np.arange(resolution.modes)
    return [
        AxialModes(
            length=length,
            parity=parity,
            discrete=spacing * indices[indices % 2 == remainder],
            ray=ray_start + ray,
            weights=weights,
        )
        for parity, remainder in ((1, 0), (-1, 1))
    ]


def slab_factors(kappa: ComplexArray | FloatArray, length: float, parity: int) -> tuple[ComplexArray, ComplexArray]:
    """Factors ``T`` and ``tau`` of a slab; 1 and 0 for a half-space."""
    if not parity:
        return np.ones(kappa.shape, np.complex128), np.zeros(kappa.shape, np.complex128)
    scaled_length = np.asarray(kappa * length, dtype=np.complex128)
    decay = np.exp(-scaled_length)
    denominator = 1 - decay**2 + parity * 2 * scaled_length * decay
    if parity < 0:  # bending: sinh(2t) - 2t would cancel
        square = scaled_length**2
        series = 1 + square / 20 * (1 + square / 42 * (1 + square / 72 * (1 + square / 110)))
        denominator = np.where(np.abs(scaled_length) < 0.5, decay * scaled_length**3 / 3 * series, denominator)
    factor = (1 - parity * decay) ** 2 / denominator  # eq. (24)
    return factor, parity * scaled_length * decay / (1 - parity * decay)


@dataclass(frozen=True, kw_only=True, eq=False)
class SingleMirrorModes(AxialModes):
    """Axial wavenumbers of one parity when loads are mirrored once; all lie on the ray."""

    @property
    def load_weights(self) -> ComplexArray:
        """Factor from ``int P(x) cosine(x) dx`` to the weighted spectrum of P and its two images at end I."""
        second_image = 0.5 * self.parity * np.exp(1j * self.ray * self.length)
        return np.asarray(self.weights / np.pi * (1 + second_image))

    def _waves_of_ends(self, x: FloatArray, sign: int) -> ComplexArray:
        first_end = np.exp(1j * np.outer(self.ray, x))
        second_end = np.exp(1j * np.outer(self.ray, self.length - x))
        return np.asarray(first_end + sign * self.parity * second_end)

    def load_on_top(self, core: ComplexArray, depth: FloatArray, lateral: float, poisson: float) -> ComplexArray:
        """Weighted spectrum of the load of V1 and V2 on 0 .. L, with its two images: array (wavenumber, depth)."""
        length, k = self.length, self.ray[:, None]
        kappa = np.sqrt(depth**2 + lateral**2)
        # V's load on the top: K(x) = exp(-kappa x) (a - b kappa x).
        slope = (depth / kappa) ** 2
        constant = slope + 2 * poisson * (lateral / kappa) ** 2
        end_wave, decay = np.exp(1j * k * length), np.exp(-kappa * length)
        end_value = constant - slope * kappa * length
        # int_0^inf K(L + x) exp(i k x) dx: the missing tail of the load beyond either end
        decay_rate = kappa - 1j * k
        tail = decay * (end_value - slope * kappa / decay_rate) / decay_rate
        # int_0^L K(x) exp(i k (L - x)) dx: V1's load in the image beyond end II, V2's load in the image beyond end I
        conjugate_rate = kappa + 1j * k
        image = (
            end_wave * (constant - slope * kappa / conjugate_rate)
            - decay * (end_value - slope * kappa / conjugate_rate)
        ) / conjugate_rate
        truncation = self.parity * (image - tail) - end_wave * tail
        return np.asarray(self.weights[:, None] / np.pi * (4 * core.T + kappa * truncation))

    def face_factor(self, kappa: ComplexArray | FloatArray) -> ComplexArray:
        """Factor ``T``: the load on a face per normal stress removed."""
        scaled_length = np.asarray(kappa * self.length, dtype=np.complex128)
        decay = np.exp(-scaled_length)
        if self.parity > 0:
            return np.asarray(1 / (1 + (1 + scaled_length) * decay))
        return np.asarray(1 / (-np.expm1(-scaled_length) - scaled_length * decay))

    def load_on_face(self, kappa: ComplexArray) -> ComplexArray:
        """Load on a face per normal stress removed: the load on the opposite half-space contributes."""
        return self.face_factor(kappa)

    def face_amplitude(self, kappa: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
        """Amplitude of either half-space's harmonic per normal stress removed, and ``tau = 0``."""
        return self.face_factor(kappa), np.zeros_like(kappa)


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
    """Loads on the auxiliary bodies, for some wavenumbers along y, per direction of the load."""

    modes: AxialModes
    lateral: FloatArray  # wavenumbers ``k_y`` (node), 1/m
    poisson: float
    equivalent_load: list[ComplexArray]
    """Weighted spectra (node, wavenumber, column), before `cosine`, of the load added on H's top."""
    depth: ComplexArray
    """Depth wavenumbers of one node after another on their rays, where the face loads are an analytic function."""
    counts: list[int]  # number of depth wavenumbers of each node
    face_load: list[ComplexArray]
    """Normal stresses (depth, column) freed on the faces of V, times the quadrature's weights."""

    @classmethod
    def join(cls, node_loads: Sequence[AuxiliaryLoads]) -> AuxiliaryLoads:
        """Join the loads of all nodes."""
        return node_loads[0]._replace(
            lateral=np.concatenate([loads.lateral for loads in node_loads]),
            equivalent_load=[
                np.concatenate(nodes) for nodes in zip(*(loads.equivalent_load for loads in node_loads), strict=True)
            ],
            depth=np.concatenate([loads.depth for loads in node_loads]),
            counts=[loads.depth.size for loads in node_loads],
            face_load=[np.concatenate(nodes) for nodes in zip(*(loads.face_load for loads in node_loads), strict=True)],
        )


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
            equivalent_load = self.spectrum_on_top(self.solve(self.source(load, spectrum)))
            top_spectrum = self.modes.on_end[:, None] * equivalent_load
            if load is Load.NORMAL:
                top_spectrum += spectrum
            face_load = top_modes @ top_spectrum + top_conjugates @ top_spectrum.conj()  # eq. (26)
            if load is not Load.NORMAL:
                mode_matrix, conjugate_matrix = self.ray_to_faces(load, depth)
                face_load += mode_matrix @ spectrum + conjugate_matrix @ spectrum.conj()
            equivalent_loads.append(equivalent_load[None])
            face_loads.append(weights[:, None] * face_load)
        return AuxiliaryLoads(
            modes=self.modes,
            lateral=np.array([self.lateral]),
            poisson=self.poisson,
            equivalent_load=equivalent_loads,
            depth=depth,
            counts=[depth.size],
            face_load=face_loads,
        )

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
