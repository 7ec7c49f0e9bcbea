"""A field that the free ends add to the mirrored half-space, from the equivalent loads.

For each wavenumber along y the equivalent load ``R`` (in H) and the face loads ``S`` (in V) are evaluated on their
rays, where every factor decays with the distance from the loaded corner; the field is a sum of separable terms
``f(k, x) g(k, z)``, taken as matrix products. Only points within reach of a corner take part at a high wavenumber.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from contactstudy.checks import ComplexArray, FloatArray
from contactstudy.overlapping.axial import DECAY_LENGTHS
from contactstudy.overlapping.equations import EquationSet
from contactstudy.overlapping.lateral import LateralLoads
from contactstudy.overlapping.panels import POSITIONS_PER_PANEL, graded_interpolation
from contactstudy.overlapping.problem import EndProblem, parity_parts, views_of
from contactstudy.threads import one_blas_thread

# Positions over the length that agree to this many digits are the same distance from either end.
SAME_POSITION = 12


@dataclass(frozen=True)
class Harmonics:
    """A field of H under the equivalent load and of V under the face loads, for one wavenumber along y.

    Attributes
    ----------
    below_equivalent_load : callable
        From equation set, equivalent load (wavenumber, column), cosine and sine (wavenumber, x) and depths to
        amplitudes (component, x, z, column).
    beside_face_load : callable
        From equation set, depth wavenumbers, weighted face loads (depth, column), distances from the end and depths
        to the same.
    even_in_y, odd_in_y : list of int
        Components that under a pressure even in y are even or odd.
    odd_along_x : list of int
        Components that change sign when seen from the other end.
    """

    below_equivalent_load: Callable[[EquationSet, ComplexArray, ComplexArray, ComplexArray, FloatArray], FloatArray]
    beside_face_load: Callable[[EquationSet, ComplexArray, ComplexArray, FloatArray, FloatArray], FloatArray]
    even_in_y: list[int]
    odd_in_y: list[int]
    odd_along_x: list[int]

    @property
    def count(self) -> int:
        """Number of components."""
        return len(self.even_in_y) + len(self.odd_in_y)


def end_field(
    problem: EndProblem,
    harmonics: Harmonics,
    x: FloatArray,
    y: FloatArray,
    z: FloatArray,
    *,
    reference: float | None = None,
) -> FloatArray:
    """Field that the free ends add to the half-space with all mirrored loads.

    Parameters
    ----------
    problem : EndProblem
        Body and load.
    harmonics : Harmonics
        Which field.
    x, y, z : array
        Points, as a tensor product, inside the body, metres.
    reference : float, optional
        For a field whose amplitudes have a pole at wavenumber 0 along y, as displacements between two ends have:
        where along y its rigid part is zero, metres.

    Returns
    -------
    array (load, component, x, y, z)
        Under the pressure and, if wanted, under the traction.
    """
    with one_blas_thread():
        return _layers(problem, harmonics, x, y, z, reference).swapaxes(3, 4)


def _layers(
    problem: EndProblem, harmonics: Harmonics, x: FloatArray, y: FloatArray, z: FloatArray, reference: float | None
) -> FloatArray:
    """Field as an array (load, component, x, z, y), in the order in which it is summed."""
    fewer = graded_interpolation(x, problem.length, POSITIONS_PER_PANEL)
    if fewer is not None:
        positions, interpolation = fewer
        coarse = _layers(problem, harmonics, positions, y, z, reference)
        return (interpolation @ coarse.reshape(*coarse.shape[:3], -1)).reshape(*coarse.shape[:2], -1, z.size, y.size)
    if np.isinf(problem.length):
        return _first_half(problem, {0: problem.pressure}, harmonics, x, y, z, reference)[0]
    # Parts of the load even and odd about mid-length make fields of which one half is the other's image.
    half, where = np.unique(np.round(problem.from_end(x) / problem.length, SAME_POSITION), return_inverse=True)
    parts = parity_parts(problem.pressure)
    fields = _first_half(problem, parts, harmonics, problem.length * half, y, z, reference)
    signs = np.ones((harmonics.count, 1, 1, 1))
    signs[harmonics.odd_along_x] = -1.0
    first = sum(fields.values())
    second = sum(field * (parity * signs) for parity, field in fields.items())
    result = np.empty((1 + problem.tangential, harmonics.count, x.size, z.size, y.size))
    beyond = x > 0.5 * problem.length
    for rows, seen in ((np.flatnonzero(~beyond), first), (np.flatnonzero(beyond), second)):
        result[:, :, rows] = np.asarray(seen)[:, :, where[rows]]
    return result


def _first_half(
    problem: EndProblem,
    parts: Mapping[int, FloatArray],
    harmonics: Harmonics,
    x: FloatArray,
    y: FloatArray,
    z: FloatArray,
    reference: float | None,
) -> dict[int, FloatArray]:
    """Layers of the load's parts, by parity, at points no farther from end I than from end II."""
    offset = problem.corner_offset
    result = _away_from_corner(problem, parts, harmonics, x, y, z, reference)
    rows, columns = np.flatnonzero(x < offset), np.flatnonzero(z < offset)
    if rows.size and columns.size:
        at_corner = _away_from_corner(problem, parts, harmonics, x[rows], y, np.array([offset]), reference)
        for parity, field in result.items():
            field[:, :, rows[:, None], columns] = at_corner[parity]
    return result


def _away_from_corner(
    problem: EndProblem,
    parts: Mapping[int, FloatArray],
    harmonics: Harmonics,
    x: FloatArray,
    y: FloatArray,
    z: FloatArray,
    reference: float | None,
) -> dict[int, FloatArray]:
    distance = np.hypot(x[:, None], z[None, :])
    shortest = max(float(distance.min()), problem.corner_offset)
    shape = (1 + problem.tangential, harmonics.count, x.size, z.size, y.size)
    result = {parity: np.zeros(shape) for parity in parts}
    for panel in problem.panels(y, shortest, reference):
        if panel.nodes[0] * distance.min() >= DECAY_LENGTHS:
            break
        for loads in problem.batches(panel, parts, y):
            near = loads.nodes[0] * distance < DECAY_LENGTHS
            rows, columns = np.flatnonzero(near.any(axis=1)), np.flatnonzero(near.any(axis=0))
            if not rows.size:
                break
            amplitudes = _amplitudes(problem, harmonics, loads, x[rows], z[columns], shortest)
            for parity, field in result.items():
                own = amplitudes[..., loads.parities == parity]
                flat = own.reshape(*own.shape[:4], -1)
                for load, values, waves in zip(field, flat, loads.syntheses(parity), strict=False):
                    for components, synthesis in zip((harmonics.even_in_y, harmonics.odd_in_y), waves, strict=True):
                        for component in components:
                            load[component, rows[:, None], columns] += values[component] @ synthesis
    return result


def _amplitudes(
    problem: EndProblem, harmonics: Harmonics, loads: LateralLoads, x: FloatArray, z: FloatArray, shortest: float
) -> FloatArray:
    """Answers to a batch of loads: array (load, component, x, z, wavenumber, column)."""
    count = 1 + problem.tangential
    amplitudes = np.zeros((count, harmonics.count, x.size, z.size, loads.nodes.size, loads.parities.size))
    depths = np.arange(z.size)[:, None]
    for view in views_of(problem, loads, x, shortest):
        for number, lateral in enumerate(loads.nodes):
            system, (equivalent, depth, face_load) = problem.auxiliary_loads(view, float(lateral), number, shortest)
            field = harmonics.below_equivalent_load(system, equivalent, view.cosine, view.sine, z)
            field += harmonics.beside_face_load(system, depth, face_load, view.x, z)
            by_load = field.reshape(*field.shape[:3], count, -1)
            for load in range(count):
                amplitudes[load][:, view.rows[:, None, None], depths, number, view.columns] = by_load[:, :, :, load]
    return amplitudes


def real_product(left: ComplexArray, right: ComplexArray) -> FloatArray:
    """Real part of ``left @ right`` over the last axis of `left` and the first of `right`, as one real product."""
    flat_left = left.reshape(-1, left.shape[-1])
    flat_right = right.reshape(right.shape[0], -1)
    product = np.hstack([flat_left.real, -flat_left.imag]) @ np.vstack([flat_right.real, flat_right.imag])
    return np.asarray(product.reshape(*left.shape[:-1], *right.shape[1:]))
