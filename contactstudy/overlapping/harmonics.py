"""Stresses and displacements of the free ends, without the mirrored half-space: harmonics of H and of V."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from contactstudy.checks import ComplexArray, FloatArray
from contactstudy.overlapping.equations import EquationSet, real_product
from contactstudy.overlapping.field import Harmonics


def _stress_of_equivalent_load(
    system: EquationSet, equivalent: Sequence[ComplexArray], cosine: ComplexArray, sine: ComplexArray, z: FloatArray
) -> FloatArray:
    """Stresses of H under the equivalent load, by the harmonics of a pressure: (load, 6, x, z, column)."""
    nu, lateral = system.poisson, system.lateral
    axial = system.modes.wavenumbers
    k = np.sqrt(axial**2 + lateral**2)
    c2, s2 = (axial / k) ** 2, (lateral / k) ** 2  # eq. (9)
    decay = np.exp(-np.outer(k, z))
    z_times_decay = decay * z
    zero = np.zeros_like(k)
    # eqs. (11), (12) and (13)
    cosine_terms = [  # xx, yy, zz, yz, each as (constant, factor of z)
        (-(c2 + 2 * nu * s2), c2 * k),
        (-(s2 + 2 * nu * c2), s2 * k),
        (zero - 1, -k),
        (zero, zero + lateral),
    ]
    sine_terms = [(-(1 - 2 * nu) * axial * lateral / k**2, axial * lateral / k), (zero, -axial)]  # xy, xz
    stresses = np.empty((len(equivalent), 6, cosine.shape[1], z.size, equivalent[0].shape[1]))
    for waves, terms, components in ((cosine, cosine_terms, [0, 1, 2, 5]), (sine, sine_terms, [3, 4])):
        along_z = np.stack([a[:, None] * decay + b[:, None] * z_times_decay for a, b in terms], axis=1)
        for load_stresses, spectrum in zip(stresses, equivalent, strict=True):
            along_x = spectrum.T[:, None, :] * waves.T
            load_stresses[components] = real_product(along_x, along_z).transpose(2, 1, 3, 0)
    return stresses


def _stress_of_face_load(
    system: EquationSet, depth: ComplexArray, face_load: Sequence[ComplexArray], x: FloatArray, z: FloatArray
) -> FloatArray:
    """Stresses of V under the face loads on its two ends: (load, 6, x, z, column)."""
    # The slab's harmonics are two half-space harmonics that start from either end; with ``X = kappa`` times the
    # distance from the end and ``Phi = 1 - 2 nu - tau - X`` each adds its amplitude and ``exp(-X)`` times the terms
    # below.
    nu, lateral, modes = system.poisson, system.lateral, system.modes
    kappa, tau, along_z = _face_waves(system, depth, z)
    # Sums over both ends of exp(-X), and of (tau + X) exp(-X) for even and odd components.
    decay, x_times_decay = _decay_from_end(x, kappa, tau)
    even_growth = odd_growth = x_times_decay
    if modes.parity:
        far_decay, x_times_decay = _decay_from_end(modes.length - x, kappa, tau)
        decay += modes.parity * far_decay
        even_growth = even_growth + modes.parity * x_times_decay
        odd_growth = odd_growth - modes.parity * x_times_decay
    potential = (1 - 2 * nu) * decay - even_growth
    lateral_part = 2 * nu * decay
    # eqs. (11) and (12) with the waves of eq. (25)
    cosine_z: ComplexArray = np.empty((4, x.size, depth.size), np.complex128)  # xx, yy, zz, xy
    sine_z: ComplexArray = np.empty((2, x.size, depth.size), np.complex128)  # yz, xz
    np.add(decay, even_growth, out=cosine_z[0])
    np.add((lateral / kappa) ** 2 * potential, lateral_part, out=cosine_z[1])
    np.add((depth / kappa) ** 2 * potential, lateral_part, out=cosine_z[2])
    np.multiply(-lateral / kappa, odd_growth, out=cosine_z[3])
    np.multiply(lateral * depth / kappa**2, potential, out=sine_z[0])
    np.multiply(depth / kappa, odd_growth, out=sine_z[1])
    sine_z *= -1j
    stresses = np.empty((len(face_load), 6, x.size, z.size, face_load[0].shape[1]))
    for load_stresses, loads in zip(stresses, face_load, strict=True):
        face_waves = along_z[..., None] * loads[:, None, :]
        load_stresses[[0, 1, 2, 3]] = real_product(cosine_z, face_waves)
        load_stresses[[5, 4]] = real_product(sine_z, face_waves)
    return stresses


def _face_waves(
    system: EquationSet, depth: ComplexArray, z: FloatArray
) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """``kappa`` and ``tau`` of depth wavenumbers, and the waves (depth, z) of V from either face per unit load."""
    kappa = np.sqrt(depth**2 + system.lateral**2)
    amplitude, tau = system.modes.face_amplitude(kappa)
    return kappa, tau, amplitude[:, None] * np.exp(1j * np.outer(depth, z))


def _decay_from_end(distance: FloatArray, kappa: ComplexArray, tau: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
    """Return ``exp(-X)`` and ``(tau + X) exp(-X)`` at distances from an end: arrays (distance, depth)."""
    scaled_distance = np.outer(distance, kappa)
    decay = np.exp(-scaled_distance)
    scaled_distance += tau
    scaled_distance *= decay
    return decay, scaled_distance


STRESS = Harmonics(  # components xx, yy, zz, xy, xz, yz
    of_equivalent_load=_stress_of_equivalent_load,
    of_face_load=_stress_of_face_load,
    count=6,
    even_in_y=[0, 1, 2, 4],
    odd_along_x=[3, 4],
    growing_signs=(-1,),  # bending
)


def _displacement_of_equivalent_load(
    system: EquationSet, equivalent: Sequence[ComplexArray], cosine: ComplexArray, sine: ComplexArray, z: FloatArray
) -> FloatArray:
    """``2 G u`` of H under the equivalent load, by the harmonics of a pressure: (load, 3, x, z, column)."""
    nu, lateral = system.poisson, system.lateral
    axial = system.modes.wavenumbers
    k = np.sqrt(axial**2 + lateral**2)
    decay = np.exp(-np.outer(k, z))
    compressibility = 1 - 2 * nu
    displacements = np.empty((len(equivalent), 3, cosine.shape[1], z.size, equivalent[0].shape[1]))
    # eqs. (10) and (13)
    terms = (  # component, function of x, constant, factor of k z
        (0, sine, -compressibility * axial / k**2, axial / k**2),
        (1, cosine, compressibility * lateral / k**2, -lateral / k**2),
        (2, cosine, 2 * (1 - nu) / k, 1 / k),
    )
    for component, function, constant, slope in terms:
        along_z = decay * (constant[:, None] + slope[:, None] * np.outer(k, z))
        for load_displacements, spectrum in zip(displacements, equivalent, strict=True):
            load_displacements[component] = real_product(function.T, along_z[..., None] * spectrum[:, None, :])
    return displacements


def _displacement_of_face_load(
    system: EquationSet, depth: ComplexArray, face_load: Sequence[ComplexArray], x: FloatArray, z: FloatArray
) -> FloatArray:
    """``2 G u`` of V under the face loads on its two ends: (load, 3, x, z, column)."""
    # With the potential ``psi = -exp(-X) / kappa`` of either end: ``2 G u = -grad(Phi) + 4 (1 - nu) psi e_x``.
    nu, lateral, modes = system.poisson, system.lateral, system.modes
    kappa, tau, along_z = _face_waves(system, depth, z)
    along_x: ComplexArray = np.zeros((3, x.size, depth.size), np.complex128)
    ends = [(x, 1, 1)]
    if modes.parity:
        ends.append((modes.length - x, modes.parity, -modes.parity))
    for distance, even_sign, odd_sign in ends:
        scaled_distance = np.outer(distance, kappa)
        decay = np.exp(-scaled_distance)
        potential = (1 - 2 * nu - tau - scaled_distance) * decay  # eq. (10)
        along_x[0] -= odd_sign * (tau + scaled_distance + 2 * (1 - nu)) * decay / kappa
        along_x[1] -= even_sign * lateral / kappa**2 * potential
        along_x[2] += even_sign * depth / kappa**2 * potential
    along_x[2] *= -1j
    return np.stack([real_product(along_x, along_z[..., None] * loads[:, None, :]) for loads in face_load])


DISPLACEMENT = Harmonics(  # components along x, y, z, times ``2 G``
    of_equivalent_load=_displacement_of_equivalent_load,
    of_face_load=_displacement_of_face_load,
    count=3,
    even_in_y=[0, 2],
    odd_along_x=[0],
    growing_signs=(1, -1),
)
