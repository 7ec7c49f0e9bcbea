"""Displacements inside the body that the free ends add to the mirrored half-space: harmonics of H and of V."""

from __future__ import annotations

import numpy as np

from contactstudy.checks import ComplexArray, FloatArray
from contactstudy.kernels.load import Load
from contactstudy.overlapping.equations import EquationSet, real_product
from contactstudy.overlapping.field import Harmonics, Place, end_fields
from contactstudy.overlapping.problem import EndProblem


def end_displacement(
    problem: EndProblem, x: FloatArray, y: FloatArray, z: FloatArray, *, reference: float
) -> dict[Load, FloatArray]:
    """Displacements, times ``2 G``, that the free ends add to the half-space with all mirrored loads.

    Parameters
    ----------
    problem : EndProblem
        Body and load.
    x, y, z : array
        Points, as a tensor product, inside the body, metres.
    reference : float
        Between two ends: where along y the rigid motion of the far body is zero, metres.

    Returns
    -------
    dict of Load to array (3, x, y, z)
        Under the load in each of the problem's directions: along x, y, z in Pa m.
    """
    place = Place(x, y, z)
    (field,) = end_fields(problem, DISPLACEMENT, [place], reference=reference if np.isfinite(reference) else None)
    return field


def _below_equivalent_load(
    system: EquationSet, equivalent: ComplexArray, cosine: ComplexArray, sine: ComplexArray, z: FloatArray
) -> FloatArray:
    """``2 G u`` of H under the equivalent load: array (3, x, z, column). Half-space harmonics, pressure column."""
    nu, lateral = system.poisson, system.lateral
    axial = system.modes.wavenumbers
    k = np.sqrt(axial**2 + lateral**2)
    decay = np.exp(-np.outer(k, z))
    free = 1 - 2 * nu
    result = np.empty((3, cosine.shape[1], z.size, equivalent.shape[1]))
    terms = (  # component, function of x, constant, factor of k z
        (0, sine, -free * axial / k**2, axial / k**2),
        (1, cosine, free * lateral / k**2, -lateral / k**2),
        (2, cosine, 2 * (1 - nu) / k, 1 / k),
    )
    for component, function, constant, slope in terms:
        along_z = decay * (constant[:, None] + slope[:, None] * np.outer(k, z))
        result[component] = real_product(function.T, along_z[..., None] * equivalent[:, None, :])
    return result


def _beside_face_load(
    system: EquationSet, depth: ComplexArray, face_load: ComplexArray, x: FloatArray, z: FloatArray
) -> FloatArray:
    """``2 G u`` of V under the face loads on its two ends: array (3, x, z, column).

    As the stresses, with the potential ``psi = -exp(-X) / kappa`` of either end and ``2 G u = -grad(Phi) + 4 (1 - nu)
    psi e_x``.
    """
    nu, lateral, modes = system.poisson, system.lateral, system.modes
    kappa = np.sqrt(depth**2 + lateral**2)
    amplitude, tau = modes.beside_face(kappa)
    waves = np.exp(1j * np.outer(depth, z))
    right = waves[..., None] * (amplitude[:, None] * face_load)[:, None, :]
    along: ComplexArray = np.zeros((3, x.size, depth.size), np.complex128)
    ends = [(x, 1, 1)]
    if modes.parity:
        ends.append((modes.length - x, modes.parity, -modes.parity))
    for distance, even, odd in ends:
        scaled = np.outer(distance, kappa)
        decay = np.exp(-scaled)
        potential = (1 - 2 * nu - tau - scaled) * decay
        along[0] -= odd * (tau + scaled + 2 * (1 - nu)) * decay / kappa
        along[1] -= even * lateral / kappa**2 * potential
        along[2] += even * depth / kappa**2 * potential
    return np.concatenate([real_product(along[:2], right), real_product(-1j * along[2:], right)])


DISPLACEMENT = Harmonics(_below_equivalent_load, _beside_face_load, even_in_y=[0, 2], odd_in_y=[1], odd_along_x=[0])
"""Components along x, y, z."""
