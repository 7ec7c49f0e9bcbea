"""The equation set: Hetenyi's alternation, reciprocity, and independence of every internal setting."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from contactstudy import Grid, Material
from contactstudy.bodies.models import FreedEnds
from contactstudy.kernels.load import SINKS, Load
from contactstudy.overlapping.axial import axial_modes
from contactstudy.overlapping.end_kernel import EndRequest, end_kernel
from contactstudy.overlapping.equations import EquationSet
from contactstudy.overlapping.field import Place
from contactstudy.overlapping.problem import EndProblem
from contactstudy.overlapping.quadrature import Resolution
from contactstudy.overlapping.stress import end_stress


@pytest.mark.parametrize(("lateral", "parity"), [(0.3, 0), (0.3, 1), (2.0, 1), (20.0, 0)])
def test_alternating_the_two_bodies_converges_to_the_explicit_solution(lateral: float, parity: int) -> None:
    """The scheme of Hetenyi and Keer: free the ends, then the top, and again."""
    modes = axial_modes(8.0 if lateral < 3 else np.inf, lateral, 0.05, Resolution())
    chosen = modes[min(parity, len(modes) - 1)]
    system = EquationSet.build(chosen, lateral, 0.3, 0.05, Resolution())
    load = chosen.load_weights * chosen.cell_integrals(Load.NORMAL, np.array([0.0, 3.0]))[:, 0]
    asked = system.source(Load.NORMAL, load)
    explicit = system.solve(asked)
    face_load = asked.copy()
    for _ in range(200):
        on_top = system.on_top(system.scale * face_load)
        face_load = asked + system.source(Load.NORMAL, chosen.on_end * on_top)
    assert np.abs(system.scale * face_load - explicit).max() < 1e-9 * np.abs(explicit).max()
    assert np.abs(explicit - system.scale * asked).max() > 0.05 * np.abs(explicit).max()


@pytest.mark.parametrize("length", [8.0, 2.5])
def test_correction_is_symmetric(length: float) -> None:
    grid = Grid((0.0, length), (-2.0, 2.0), 24, 16)
    freed = FreedEnds(length)
    request = EndRequest.of(freed, Material(1.0, 0.3), grid, (SINKS,), 80.0, Resolution())
    for kernel in end_kernel(request).samples[SINKS]:
        assert np.abs(kernel - kernel.transpose(0, 2, 1)).max() < 1e-12 * np.abs(kernel).max()


def test_no_internal_setting_matters() -> None:
    grid = Grid((0.0, 8.0), (-1.0, 1.0), 32, 24)
    pressure = np.broadcast_to((1 - grid.y**2) ** 2, grid.shape)
    points = (np.array([0.0, 0.1, 1.0, 4.0]), np.array([0.0, 0.5]), np.array([0.05, 0.5, 3.0]))

    def stress(resolution: Resolution) -> np.ndarray:
        both = (Load.NORMAL, Load.ALONG_Y)
        fields = end_stress(EndProblem(8.0, 0.3, pressure, both, grid, resolution), [Place(*points)])[0]
        return np.stack([fields[load] for load in both])

    usual = stress(Resolution())
    finer = {
        "step": 0.15,
        "lateral_ratio": 3.0,
        "angle": np.pi / 7,
        "reach": 1000.0,
        "modes": 14,
        "lateral_nodes": 16,
        "lateral_order": 24,
        "lateral_reach": 16.0,
    }
    for name, value in finer.items():
        assert np.abs(stress(replace(Resolution(), **{name: value})) - usual).max() < 2e-5, name
