"""Stresses of the equivalent loads: what the free ends add to the mirrored half-space.

For each wavenumber along y the equivalent load ``R`` (in H) and the face loads ``S`` (in V) are evaluated on their
rays, where every factor decays with the distance from the loaded corner; the stresses are sums of separable terms
``f(k, x) g(k, z)``, taken as matrix products. Only points within reach of a corner take part at a high wavenumber.
"""

from __future__ import annotations

import numpy as np

from contactstudy.checks import ComplexArray, FloatArray
from contactstudy.overlapping.axial import DECAY_LENGTHS, axial_modes
from contactstudy.overlapping.equations import EquationSet, slab_factors
from contactstudy.overlapping.panels import POSITIONS_PER_PANEL, graded_interpolation
from contactstudy.overlapping.problem import (
    EndProblem,
    LateralAmplitudes,
    View,
    lateral_amplitudes,
    lateral_quadrature,
    lateral_synthesis,
    views_of,
)
from contactstudy.overlapping.quadrature import Resolution
from contactstudy.threads import one_blas_thread

# Wavenumbers that share one set of points and one product along y.
BATCH = 16
# Order of the components: xx, yy, zz, xy, xz, yz.
EVEN_IN_Y, ODD_IN_Y = [0, 1, 2, 4], [3, 5]


def end_stress(problem: EndProblem, x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
    """Stresses that the free ends add to the half-space with all mirrored loads.

    Parameters
    ----------
    problem : EndProblem
        Body and load.
    x, y, z : array
        Points, as a tensor product, inside the body, metres.

    Returns
    -------
    array (load, 6, x, y, z)
        Under the pressure and, if wanted, under the traction: xx, yy, zz, xy, xz, yz in Pa.
    """
    fewer = graded_interpolation(x, problem.length, POSITIONS_PER_PANEL)
    if fewer is not None:
        positions, interpolation = fewer
        coarse = end_stress(problem, positions, y, z)
        return np.ascontiguousarray(np.moveaxis(np.tensordot(interpolation, coarse, axes=(1, 2)), 0, 2))
    offset = problem.corner_offset
    with one_blas_thread():
        result = _away_from_corner(problem, x, y, z)
        rows, columns = np.flatnonzero(problem.from_end(x) < offset), np.flatnonzero(z < offset)
        if rows.size and columns.size:
            at_corner = _away_from_corner(problem, x[rows], y, np.array([offset]))
            for place, row in enumerate(rows):
                result[:, :, row][..., columns] = at_corner[:, :, place]
    return result


def _away_from_corner(problem: EndProblem, x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
    distance = np.hypot(problem.from_end(x)[:, None], z[None, :])
    shortest = max(float(distance.min()), problem.corner_offset)
    lateral, weights = lateral_quadrature(problem, y, shortest)
    lateral, weights = (values[lateral * distance.min() < DECAY_LENGTHS] for values in (lateral, weights))
    loads = lateral_amplitudes(problem.pressure, problem.grid, lateral, tangential=problem.tangential)
    even, odd = lateral_synthesis(lateral, weights, y)
    syntheses = ((EVEN_IN_Y, even), (ODD_IN_Y, odd))
    result = np.zeros((1 + problem.tangential, 6, x.size, z.size, y.size))
    for start in range(0, lateral.size, BATCH):
        batch = slice(start, min(start + BATCH, lateral.size))
        near = lateral[start] * distance < DECAY_LENGTHS
        rows, columns = np.flatnonzero(near.any(axis=1)), np.flatnonzero(near.any(axis=0))
        amplitudes = _batch_amplitudes(problem, loads, lateral[batch], batch, x[rows], z[columns], shortest)
        for load, part in enumerate(np.split(amplitudes, len(result), axis=-1)):
            for components, synthesis in syntheses:
                flat = part[components].reshape(-1, 2 * part.shape[3])
                values = (flat @ synthesis[batch].reshape(-1, y.size)).reshape(-1, rows.size, columns.size, y.size)
                for component, value in zip(components, values, strict=True):
                    result[load, component, rows[:, None], columns] += value
    return np.ascontiguousarray(result.transpose(0, 1, 2, 4, 3))


def _batch_amplitudes(
    problem: EndProblem,
    loads: LateralAmplitudes,
    lateral: FloatArray,
    batch: slice,
    x: FloatArray,
    z: FloatArray,
    shortest: float,
) -> FloatArray:
    """Amplitudes of the six stresses for a batch of wavenumbers along y: array (6, x, z, wavenumber, column)."""
    resolution = problem.resolution
    views = [
        view
        for modes in axial_modes(problem.length, float(lateral[0]), shortest, resolution)
        for view in views_of(modes, problem, loads, batch, x)
    ]
    amplitudes = np.zeros((6, x.size, z.size, lateral.size, loads.pressure.shape[-1]))
    for number, wavenumber in enumerate(lateral):
        system = None
        for view in views:
            if system is None or system.modes is not view.modes:
                system = EquationSet.build(view.modes, float(wavenumber), problem.poisson, shortest, resolution)
            here = amplitudes[..., number, :]
            here[:, view.rows] += _harmonic_stress(system, view, number, z, shortest, resolution)
    return amplitudes


def _harmonic_stress(
    system: EquationSet, view: View, number: int, z: FloatArray, shortest: float, resolution: Resolution
) -> FloatArray:
    """Amplitudes of the six stresses for the batch's wavenumber `number`: array (6, x, z, column)."""
    pressure, traction = view.pressure[:, number], view.traction[:, number]
    source = system.from_pressure(pressure)
    if np.any(traction):
        source = source + system.from_traction(traction)
    equivalent = system.on_top(system.solve(source))
    depth, weights, face_load = system.on_ray(pressure, traction, equivalent, shortest, resolution)
    stress = _below_equivalent_load(system, equivalent, view.cosine, view.sine, z)
    stress += _beside_face_load(system, depth, weights[:, None] * face_load, view.x, z)
    if view.flipped:
        stress[[3, 4]] *= -1.0
    return stress


def _real_product(left: ComplexArray, right: ComplexArray) -> FloatArray:
    """Real part of ``left @ right`` over the last axis of `left` and the first of `right`, as one real product."""
    flat_left = left.reshape(-1, left.shape[-1])
    flat_right = right.reshape(right.shape[0], -1)
    product = np.hstack([flat_left.real, -flat_left.imag]) @ np.vstack([flat_right.real, flat_right.imag])
    return np.asarray(product.reshape(*left.shape[:-1], *right.shape[1:]))


def _below_equivalent_load(
    system: EquationSet, equivalent: ComplexArray, cosine: ComplexArray, sine: ComplexArray, z: FloatArray
) -> FloatArray:
    """Stresses of H under the equivalent load: array (6, x, z, column). Half-space harmonics, pressure column."""
    nu, lateral = system.poisson, system.lateral
    axial = system.modes.wavenumbers
    k = np.sqrt(axial**2 + lateral**2)
    c2, s2 = (axial / k) ** 2, (lateral / k) ** 2
    decay = np.exp(-np.outer(k, z))
    ramp = decay * z
    zero = np.zeros_like(k)
    even = [  # xx, yy, zz, yz, each as (constant, factor of z)
        (-(c2 + 2 * nu * s2), c2 * k),
        (-(s2 + 2 * nu * c2), s2 * k),
        (zero - 1, -k),
        (zero, zero + lateral),
    ]
    odd = [(-(1 - 2 * nu) * axial * lateral / k**2, axial * lateral / k), (zero, -axial)]  # xy, xz
    result = np.empty((6, cosine.shape[1], z.size, equivalent.shape[1]))
    for functions, terms, components in ((cosine, even, [0, 1, 2, 5]), (sine, odd, [3, 4])):
        along_z = np.stack([a[:, None] * decay + b[:, None] * ramp for a, b in terms], axis=1)
        right = along_z[..., None] * equivalent[:, None, None, :]
        result[components] = _real_product(functions.T, right).transpose(1, 0, 2, 3)
    return result


def _beside_face_load(
    system: EquationSet, depth: ComplexArray, face_load: ComplexArray, x: FloatArray, z: FloatArray
) -> FloatArray:
    """Stresses of V under the face loads on its two ends: array (6, x, z, column).

    The slab's harmonics, written as two half-space harmonics that start from either end; with ``X = kappa`` times the
    distance from the end, ``tau`` and ``T`` of `slab_factors`, and ``Phi = 1 - 2 nu - tau - X``, each end gives
    ``T exp(-X) / (1 - parity exp(-kappa L))`` times the terms below.
    """
    nu, lateral, modes = system.poisson, system.lateral, system.modes
    kappa = np.sqrt(depth**2 + lateral**2)
    factor, tau = slab_factors(kappa, modes.length, modes.parity)
    amplitude = factor.copy()
    if modes.parity:
        amplitude /= 1 - modes.parity * np.exp(-kappa * modes.length)
    waves = np.exp(1j * np.outer(depth, z))
    right = waves[..., None] * (amplitude[:, None] * face_load)[:, None, :]
    cosine_z: ComplexArray = np.zeros((4, x.size, depth.size), np.complex128)  # xx, yy, zz, xy
    sine_z: ComplexArray = np.zeros((2, x.size, depth.size), np.complex128)  # yz, xz
    ends = [(x, 1, 1)]
    if modes.parity:
        ends.append((modes.length - x, modes.parity, -modes.parity))
    for distance, even, odd in ends:
        scaled = np.outer(distance, kappa)
        decay = np.exp(-scaled)
        potential = (1 - 2 * nu - tau - scaled) * decay
        shear = (tau + scaled) * decay / kappa
        cosine_z[0] += even * (1 + tau + scaled) * decay
        cosine_z[1] += even * ((lateral / kappa) ** 2 * potential + 2 * nu * decay)
        cosine_z[2] += even * ((depth / kappa) ** 2 * potential + 2 * nu * decay)
        cosine_z[3] -= odd * lateral * shear
        sine_z[0] += even * lateral * depth / kappa**2 * potential
        sine_z[1] += odd * depth * shear
    result = np.empty((6, x.size, z.size, face_load.shape[1]))
    result[[0, 1, 2, 3]] = _real_product(cosine_z, right)
    result[[5, 4]] = _real_product(-1j * sine_z, right)
    return result
