"""The equivalent loads themselves: ``P_h`` on the top of H, ``P_v`` on the faces of V."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from contactstudy.checks import FloatArray
from contactstudy.kernels.load import Load
from contactstudy.overlapping.problem import EndProblem, views_of
from contactstudy.threads import one_blas_thread


class EquivalentLoads(NamedTuple):
    """Equivalent loads under a load in one direction, positive in compression, Pa.

    Attributes
    ----------
    added : array (x, y)
        What the faces of V add to the pressure on the top of H.
    first, second : array (y, z)
        Loads on the faces at end I and end II.
    """

    added: FloatArray
    first: FloatArray
    second: FloatArray


def equivalent_loads_of(
    problem: EndProblem, x: FloatArray, y: FloatArray, z: FloatArray, *, reference: float | None = None
) -> dict[Load, EquivalentLoads]:
    """Equivalent loads of each load, at positions `x` and `y` on the top, and at `y` and depths `z` on the ends.

    Between two ends an eccentric load tilts H and V against each other by an amount that grows like the logarithm of
    the distance, and the loads that tilt them make no stress: they are stated relative to ``|y| = reference``.

    At a loaded corner they grow like a logarithm while the stresses that they make stay finite; nearer than a part
    of a cell they are evaluated at that distance.
    """
    loads: dict[Load, EquivalentLoads] = {}
    with one_blas_thread():
        for alike in problem.alike():
            loads |= _loads_alike(alike, x, y, z, reference)
    return loads


def _loads_alike(
    problem: EndProblem, x: FloatArray, y: FloatArray, z: FloatArray, reference: float | None
) -> dict[Load, EquivalentLoads]:
    """Equivalent loads of loads that mirror images all keep or all reverse."""
    offset = problem.corner_offset
    x = np.where(problem.from_end(x) < offset, np.where(x < offset, offset, problem.length - offset), x)
    z = np.maximum(z, offset)
    shortest = float(min(problem.from_end(x).min(), z.min()))
    count = len(problem.loads)
    added = np.zeros((count, x.size, y.size))
    faces = np.zeros((2, count, z.size, y.size))
    for panel in problem.panels(y, shortest, reference):
        for columns in problem.batches(panel, {0: problem.columns[1]}, y):
            top = np.zeros((x.size, columns.nodes.size, count, columns.parities.size))
            sides = np.zeros((2, z.size, columns.nodes.size, count, columns.parities.size))
            for view in views_of(problem, columns, x, shortest):
                for number, wavenumber in enumerate(columns.nodes):
                    lateral = float(wavenumber)
                    _, (equivalent, depth, face_load) = problem.auxiliary_loads(view, lateral, number, shortest)
                    top[view.rows, number] += np.real(view.cosine.T @ equivalent).reshape(view.rows.size, count, -1)
                    applied = view.modes.applied(np.sqrt(depth**2 + lateral**2))
                    side = np.real(np.exp(1j * np.outer(z, depth)) @ (applied[:, None] * face_load))
                    side = side.reshape(z.size, count, -1)
                    # The second end's load follows from the first's by parity; separate ends have a view each.
                    if view.modes.parity:
                        sides[0, :, number] += side
                        sides[1, :, number] += view.modes.parity * side
                    else:
                        sides[int(view.flipped), :, number] += side
            for i, load in enumerate(problem.loads):
                even, _ = columns.synthesis(load, 0)
                added[i] += top[:, :, i].reshape(x.size, -1) @ even
                faces[:, i] -= sides[:, :, :, i].reshape(2, z.size, -1) @ even
    return {load: EquivalentLoads(added[i], faces[0, i].T, faces[1, i].T) for i, load in enumerate(problem.loads)}
