"""Stresses that the free ends add to the mirrored half-space: harmonics of H and of V."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from contactstudy.checks import ComplexArray, FloatArray
from contactstudy.kernels.load import Load
from contactstudy.overlapping.equations import EquationSet, real_product
from contactstudy.overlapping.field import Harmonics, Place, end_fields
from contactstudy.overlapping.problem import EndProblem


def end_stress(problem: EndProblem, places: Sequence[Place], reference: float = np.inf) -> list[dict[Load, FloatArray]]:
    """Stresses that the free ends add to the half-space with all mirrored loads.

    Parameters
    ----------
    problem : EndProblem
        Body and load.
    places : sequence of Place
        Points inside the body.
    reference : float
        Between two ends: where along y the bending of the far body under a force along x is zero, metres.

    Returns
    -------
    list of dict of Load to array (6, x, y, z)
        At each place, under the load in each of the problem's directions: xx, yy, zz, xy, xz, yz in Pa.
    """
    fields: list[dict[Load, FloatArray]] = [{} for _ in places]
    for alike in problem.alike():
        grows = alike.sign_x < 0 and np.isfinite(reference)
        own = end_fields(alike, STRESS, places, reference=reference if grows else None)
        for found, each in zip(fields, own, strict=True):
            found |= each
    return fields


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
        along_x = equivalent.T[:, None, :] * functions.T
        result[components] = real_product(along_x, along_z).transpose(2, 1, 3, 0)
    return result


def _beside_face_load(
    system: EquationSet, depth: ComplexArray, face_load: ComplexArray, x: FloatArray, z: FloatArray
) -> FloatArray:
    """Stresses of V under the face loads on its two ends: array (6, x, z, column).

    The slab's harmonics, written as two half-space harmonics that start from either end; with ``X = kappa`` times the
    distance from the end, ``tau`` and the amplitude of `AxialModes.beside_face`, and ``Phi = 1 - 2 nu - tau - X``,
    each end gives the amplitude and ``exp(-X)`` times the terms below.
    """
    nu, lateral, modes = system.poisson, system.lateral, system.modes
    kappa = np.sqrt(depth**2 + lateral**2)
    amplitude, tau = modes.beside_face(kappa)
    waves = np.exp(1j * np.outer(depth, z))
    right = waves[..., None] * (amplitude[:, None] * face_load)[:, None, :]
    # Sums over both ends of exp(-X), and of (tau + X) exp(-X) for components that both see alike or reversed.
    decay, ramp = _from_end(x, kappa, tau)
    alike = reversed_ = ramp
    if modes.parity:
        own, ramp = _from_end(modes.length - x, kappa, tau)
        decay += modes.parity * own
        alike = alike + modes.parity * ramp
        reversed_ = reversed_ - modes.parity * ramp
    potential = (1 - 2 * nu) * decay - alike
    lateral_part = 2 * nu * decay
    cosine_z: ComplexArray = np.empty((4, x.size, depth.size), np.complex128)  # xx, yy, zz, xy
    sine_z: ComplexArray = np.empty((2, x.size, depth.size), np.complex128)  # yz, xz
    np.add(decay, alike, out=cosine_z[0])
    np.add((lateral / kappa) ** 2 * potential, lateral_part, out=cosine_z[1])
    np.add((depth / kappa) ** 2 * potential, lateral_part, out=cosine_z[2])
    np.multiply(-lateral / kappa, reversed_, out=cosine_z[3])
    np.multiply(lateral * depth / kappa**2, potential, out=sine_z[0])
    np.multiply(depth / kappa, reversed_, out=sine_z[1])
    result = np.empty((6, x.size, z.size, face_load.shape[1]))
    result[[0, 1, 2, 3]] = real_product(cosine_z, right)
    result[[5, 4]] = real_product(-1j * sine_z, right)
    return result


def _from_end(distance: FloatArray, kappa: ComplexArray, tau: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
    """Return ``exp(-X)`` and ``(tau + X) exp(-X)`` at distances from an end: arrays (distance, depth)."""
    scaled = np.outer(distance, kappa)
    decay = np.exp(-scaled)
    scaled += tau
    scaled *= decay
    return decay, scaled


STRESS = Harmonics(
    _below_equivalent_load, _beside_face_load, even_in_y=[0, 1, 2, 4], odd_in_y=[3, 5], odd_along_x=[3, 4]
)
"""Components xx, yy, zz, xy, xz, yz."""
