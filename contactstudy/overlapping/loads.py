"""The equivalent loads themselves: ``P_h`` on the top of H, ``P_v`` on the faces of V."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from contactstudy.checks import FloatArray
from contactstudy.overlapping.problem import EndProblem, views_of
from contactstudy.threads import one_blas_thread


class EquivalentLoads(NamedTuple):
    """Equivalent loads, positive in compression, Pa; the first axis is the load: pressure, then traction.

    Attributes
    ----------
    added : array (load, x, y)
        What the faces of V add to the pressure on the top of H.
    first, second : array (load, y, z)
        Loads on the faces at end I and end II.
    """

    added: FloatArray
    first: FloatArray
    second: FloatArray


def equivalent_loads_of(
    problem: EndProblem, x: FloatArray, y: FloatArray, z: FloatArray, *, reference: float | None = None
) -> EquivalentLoads:
    """Equivalent loads at positions `x` and `y` on the top, and at `y` and depths `z` on the ends.

    Between two ends an eccentric load tilts H and V against each other by an amount that grows like the logarithm of
    the distance, and the loads that tilt them make no stress: they are stated relative to ``|y| = reference``.

    At a loaded corner they grow like a logarithm while the stresses that they make stay finite; nearer than a part
    of a cell they are evaluated at that distance.
    """
    offset = problem.corner_offset
    x = np.where(problem.from_end(x) < offset, np.where(x < offset, offset, problem.length - offset), x)
    z = np.maximum(z, offset)
    shortest = float(min(problem.from_end(x).min(), z.min()))
    count = 1 + problem.tangential
    added = np.zeros((count, x.size, y.size))
    faces = np.zeros((2, count, z.size, y.size))
    with one_blas_thread():
        for panel in problem.panels(y, shortest, reference):
            for loads in problem.batches(panel, {0: problem.pressure}, y):
                top = np.zeros((x.size, loads.nodes.size, count, loads.parities.size))
                sides = np.zeros((2, z.size, loads.nodes.size, count, loads.parities.size))
                for view in views_of(problem, loads, x, shortest):
                    for number, wavenumber in enumerate(loads.nodes):
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
                for load, (synthesis, _) in zip(range(count), loads.syntheses(0), strict=False):
                    added[load] += top[:, :, load].reshape(x.size, -1) @ synthesis
                    faces[:, load] -= sides[:, :, :, load].reshape(2, z.size, -1) @ synthesis
    return EquivalentLoads(added, faces[0].swapaxes(1, 2), faces[1].swapaxes(1, 2))
