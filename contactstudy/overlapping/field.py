"""A field that the free ends add to the mirrored half-space, from the equivalent loads.

For each wavenumber along y the equivalent load ``R`` (in H) and the face loads ``S`` (in V) are evaluated on their
rays, where every factor decays with the distance from the loaded corner; the field is a sum of separable terms
``f(k, x) g(k, z)``, taken as matrix products. Only points within reach of a corner take part at a high wavenumber.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from contactstudy.checks import ComplexArray, FloatArray
from contactstudy.kernels.load import Load
from contactstudy.overlapping.axial import DECAY_LENGTHS
from contactstudy.overlapping.equations import EquationSet
from contactstudy.overlapping.lateral import LateralColumns
from contactstudy.overlapping.panels import POSITIONS_PER_PANEL, graded_interpolation
from contactstudy.overlapping.problem import EndProblem, parity_parts, views_of
from contactstudy.threads import one_blas_thread

SAME_POSITION = 12
"""Digits to which positions over the length agree that are the same distance from either end. Accuracy."""


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


@dataclass(frozen=True, eq=False)
class _Task:
    """A field that is wanted, at the tensor product of `x`, `y` and `z`."""

    problem: EndProblem
    harmonics: Harmonics
    x: FloatArray
    y: FloatArray
    z: FloatArray
    reference: float | None

    def zeros(self) -> FloatArray:
        """Field (load, component, x, z, y), in the order in which it is summed."""
        counts = (len(self.problem.loads), self.harmonics.count)
        return np.zeros((*counts, self.x.size, self.z.size, self.y.size))


def end_field(
    problem: EndProblem,
    harmonics: Harmonics,
    x: FloatArray,
    y: FloatArray,
    z: FloatArray,
    *,
    reference: float | None = None,
) -> dict[Load, FloatArray]:
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
    dict of Load to array (component, x, y, z)
        Under the load in each of the problem's directions.
    """
    fields: dict[Load, FloatArray] = {}
    with one_blas_thread():
        for alike in problem.alike():
            field = _at_few_positions(_Task(alike, harmonics, x, y, z, reference))
            fields |= dict(zip(alike.loads, field.swapaxes(3, 4), strict=True))
    return fields


def _at_few_positions(task: _Task) -> FloatArray:
    """Field at many positions along x, by interpolation from fewer that are graded towards the ends."""
    fewer = graded_interpolation(task.x, task.problem.length, POSITIONS_PER_PANEL)
    if fewer is None:
        return _by_symmetry(task)
    positions, interpolation = fewer
    field = _by_symmetry(replace(task, x=positions))
    shape = (*field.shape[:2], task.x.size, *field.shape[3:])
    return np.asarray(interpolation @ field.reshape(*field.shape[:3], -1)).reshape(shape)


def _by_symmetry(task: _Task) -> FloatArray:
    """Field from its parts even and odd about mid-length, of which one half is the other's image."""
    problem, harmonics, length = task.problem, task.harmonics, task.problem.length
    if np.isinf(length):
        return _with_corner(task, {0: problem.columns[1]})[0]
    half, where = np.unique(np.round(problem.from_end(task.x) / length, SAME_POSITION), return_inverse=True)
    parts = parity_parts(problem.columns[1], problem.sign_x)
    fields = _with_corner(replace(task, x=length * half), parts)
    signs = np.ones((harmonics.count, 1, 1, 1))
    signs[harmonics.odd_along_x] = -1.0
    first = sum(fields.values())
    second = sum(field * (parity * signs) for parity, field in fields.items())
    result = task.zeros()
    beyond = task.x > 0.5 * length
    for rows, seen in ((np.flatnonzero(~beyond), first), (np.flatnonzero(beyond), second)):
        result[:, :, rows] = np.asarray(seen)[:, :, where[rows]]
    return result


def _with_corner(task: _Task, parts: Mapping[int, FloatArray]) -> dict[int, FloatArray]:
    """Field by parity; points on the loaded corner itself are evaluated a little below it."""
    offset = task.problem.corner_offset
    result = _sum_over_wavenumbers(task, parts)
    rows, columns = np.flatnonzero(task.x < offset), np.flatnonzero(task.z < offset)
    if rows.size and columns.size:
        at_corner = _sum_over_wavenumbers(replace(task, x=task.x[rows], z=np.array([offset])), parts)
        for parity, field in result.items():
            field[:, :, rows[:, None], columns] = at_corner[parity]
    return result


def _sum_over_wavenumbers(task: _Task, parts: Mapping[int, FloatArray]) -> dict[int, FloatArray]:
    """Field by parity: the integral over the wavenumber along y."""
    problem, harmonics = task.problem, task.harmonics
    distance = np.hypot(task.x[:, None], task.z[None, :])
    shortest = max(float(distance.min()), problem.corner_offset)
    result = {parity: task.zeros() for parity in parts}
    for panel in problem.panels(task.y, shortest, task.reference):
        if panel.nodes[0] * distance.min() >= DECAY_LENGTHS:
            break
        for columns in problem.batches(panel, parts, task.y):
            near = columns.nodes[0] * distance < DECAY_LENGTHS
            rows, depths = np.flatnonzero(near.any(axis=1)), np.flatnonzero(near.any(axis=0))
            if not rows.size:
                break
            amplitudes = _amplitudes(replace(task, x=task.x[rows], z=task.z[depths]), columns, shortest)
            for parity, field in result.items():
                own = amplitudes[..., columns.parities == parity]
                flat = own.reshape(*own.shape[:4], -1)
                for i, load in enumerate(problem.loads):
                    even, odd = columns.synthesis(load, parity)
                    for component in range(harmonics.count):
                        wave = even if component in harmonics.even_in_y else odd
                        field[i, component, rows[:, None], depths] += flat[i, component] @ wave
    return result


def _amplitudes(task: _Task, columns: LateralColumns, shortest: float) -> FloatArray:
    """Answers to a batch of columns: array (load, component, x, z, wavenumber, column)."""
    problem, harmonics, z = task.problem, task.harmonics, task.z
    count = len(problem.loads)
    shape = (task.x.size, z.size, columns.nodes.size, columns.parities.size)
    amplitudes = np.zeros((count, harmonics.count, *shape))
    depths = np.arange(z.size)[:, None]
    for view in views_of(problem, columns, task.x, shortest):
        for number, lateral in enumerate(columns.nodes):
            system, (equivalent, depth, face_load) = problem.auxiliary_loads(view, float(lateral), number, shortest)
            field = harmonics.below_equivalent_load(system, equivalent, view.cosine, view.sine, z)
            field += harmonics.beside_face_load(system, depth, face_load, view.x, z)
            by_load = field.reshape(*field.shape[:3], count, -1)
            for i in range(count):
                amplitudes[i][:, view.rows[:, None, None], depths, number, view.columns] = by_load[:, :, :, i]
    return amplitudes


def real_product(left: ComplexArray, right: ComplexArray) -> FloatArray:
    """Real part of ``left @ right`` over the last axis of `left` and the first of `right`, as one real product."""
    flat_left = left.reshape(-1, left.shape[-1])
    flat_right = right.reshape(right.shape[0], -1)
    product = np.hstack([flat_left.real, -flat_left.imag]) @ np.vstack([flat_right.real, flat_right.imag])
    return np.asarray(product.reshape(*left.shape[:-1], *right.shape[1:]))
