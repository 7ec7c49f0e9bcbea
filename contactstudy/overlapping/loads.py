"""The equivalent loads themselves: ``P_h`` on the top of H, ``P_v`` on the faces of V."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from contactstudy.checks import FloatArray
from contactstudy.overlapping.equations import EquationSet
from contactstudy.overlapping.field import BATCH
from contactstudy.overlapping.problem import (
    EndProblem,
    lateral_amplitudes,
    lateral_sum,
    views_of,
)
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


def equivalent_loads_of(problem: EndProblem, x: FloatArray, y: FloatArray, z: FloatArray) -> EquivalentLoads:
    """Equivalent loads at positions `x` and `y` on the top, and at `y` and depths `z` on the ends.

    At a loaded corner they grow like a logarithm while the stresses that they make stay finite; nearer than a part
    of a cell they are evaluated at that distance.
    """
    offset = problem.corner_offset
    x = np.where(problem.from_end(x) < offset, np.where(x < offset, offset, problem.length - offset), x)
    z = np.maximum(z, offset)
    shortest = float(min(problem.from_end(x).min(), z.min()))
    sum_along_y = lateral_sum(problem, y, shortest)
    lateral = sum_along_y.wavenumbers
    amplitudes = lateral_amplitudes({0: problem.pressure}, problem.grid, lateral, tangential=problem.tangential)
    synthesis, _ = sum_along_y.synthesis(y)
    columns = len(amplitudes.columns)
    top = np.zeros((x.size, lateral.size, columns))
    faces = np.zeros((2, z.size, lateral.size, columns))
    resolution = problem.resolution
    with one_blas_thread():
        for start in range(0, lateral.size, BATCH):
            batch = slice(start, min(start + BATCH, lateral.size))
            for modes in problem.axial_modes(float(lateral[start]), shortest):
                for view in views_of(modes, problem, amplitudes, batch, x):
                    for number, wavenumber in enumerate(lateral[batch]):
                        system = EquationSet.build(modes, float(wavenumber), problem.poisson, shortest, resolution)
                        p, q = view.pressure[:, number], view.traction[:, number]
                        scaled = system.solve(system.from_pressure(p) + system.from_traction(q))
                        equivalent = system.on_top(scaled)
                        depth, depth_weights, load = system.on_ray(p, q, equivalent, shortest, resolution)
                        top[view.rows, start + number] += np.real(view.cosine.T @ equivalent)
                        waves = np.exp(1j * np.outer(z, depth)) * depth_weights
                        applied = modes.applied(np.sqrt(depth**2 + wavenumber**2))
                        face = np.real(waves @ (applied[:, None] * load))
                        # The second end's load follows from the first's by parity; separate ends have a view each.
                        if modes.parity:
                            faces[0, :, start + number] += face
                            faces[1, :, start + number] += modes.parity * face
                        else:
                            faces[int(view.flipped), :, start + number] += face

    def over_y(values: FloatArray) -> FloatArray:
        """From amplitudes (..., wavenumber, column) to values (load, ..., y)."""
        result = np.zeros((1 + problem.tangential, *values.shape[:-2], y.size))
        for i, column in enumerate(amplitudes.columns):
            result[column.load] += values[..., i] @ synthesis[:, column.phase]
        return result

    on_faces = -over_y(faces).swapaxes(2, 3)
    return EquivalentLoads(over_y(top), on_faces[:, 0], on_faces[:, 1])
