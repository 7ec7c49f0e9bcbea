"""The equation set: Hetenyi's alternation, reciprocity, transforms, units, and settings of the resolution."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy import integrate

from contactstudy import Grid, Material
from contactstudy.arrays.grid import Points
from contactstudy.bodies.models import FreeEnds
from contactstudy.kernels.load import NORMAL_RESPONSE, Load
from contactstudy.overlapping.equations import EquationSet, SingleMirrorModes, axial_modes, load_on_end
from contactstudy.overlapping.field import STRESS, end_fields
from contactstudy.overlapping.problem import EndProblem
from contactstudy.overlapping.quadrature import Resolution
from contactstudy.overlapping.surface import EndRequest, end_kernel


@pytest.mark.parametrize(("lateral", "parity"), [(0.3, 0), (0.3, 1), (2.0, 1), (20.0, 0)])
def test_alternating_the_two_bodies_converges_to_the_explicit_solution(lateral: float, parity: int) -> None:
    """The scheme of Hetenyi and Keer frees the ends and the top in turn."""
    modes = axial_modes(8.0 if lateral < 3 else np.inf, lateral, 0.05, Resolution())
    axial_wavenumbers = modes[min(parity, len(modes) - 1)]
    system = EquationSet.build(axial_wavenumbers, lateral, 0.3, 0.05, Resolution())
    load = axial_wavenumbers.load_weights * axial_wavenumbers.cell_integrals(Load.NORMAL, np.array([0.0, 3.0]))[:, 0]
    request = system.source(Load.NORMAL, load)
    explicit_solution = system.solve(request)
    face_load = request.copy()
    for _ in range(200):
        top_spectrum = system.spectrum_on_top(system.scale * face_load)
        face_load = request + system.source(Load.NORMAL, axial_wavenumbers.on_end * top_spectrum)
    assert np.abs(system.scale * face_load - explicit_solution).max() < 1e-9 * np.abs(explicit_solution).max()
    assert np.abs(explicit_solution - system.scale * request).max() > 0.05 * np.abs(explicit_solution).max()


@pytest.mark.parametrize("length", [8.0, 2.5])
def test_correction_is_symmetric(length: float) -> None:
    grid = Grid(x_range=(0.0, length), y_range=(-2.0, 2.0), cells_x=24, cells_y=16)
    free_ends = FreeEnds(length)
    request = EndRequest.of(free_ends, Material(1.0, 0.3), grid, (NORMAL_RESPONSE,), 80.0, Resolution())
    for kernel in end_kernel(request).samples[NORMAL_RESPONSE]:
        assert np.abs(kernel - kernel.transpose(0, 2, 1)).max() < 1e-12 * np.abs(kernel).max()


@pytest.mark.slow
def test_resolution_settings_are_converged() -> None:
    grid = Grid(x_range=(0.0, 8.0), y_range=(-1.0, 1.0), cells_x=32, cells_y=24)
    pressure = np.broadcast_to((1 - grid.y**2) ** 2, grid.shape)
    points = (np.array([0.0, 0.1, 1.0, 4.0]), np.array([0.0, 0.5]), np.array([0.05, 0.5, 3.0]))

    def compute_stress(resolution: Resolution) -> np.ndarray:
        loads = (Load.NORMAL, Load.ALONG_Y)
        fields = end_fields(
            EndProblem(length=8.0, poisson=0.3, cell_loads=pressure, loads=loads, grid=grid, resolution=resolution),
            STRESS,
            [Points(*points)],
        )[0]
        return np.stack([fields[load] for load in loads])

    baseline = compute_stress(Resolution())
    finer_settings = {
        "step": 0.15,
        "lateral_ratio": 3.0,
        "angle": np.pi / 7,
        "reach": 1000.0,
        "modes": 14,
        "lateral_nodes": 16,
        "lateral_order": 24,
        "lateral_reach": 16.0,
    }
    for name, setting in finer_settings.items():
        assert np.abs(compute_stress(replace(Resolution(), **{name: setting})) - baseline).max() < 2e-5, name


END_STRESS = {
    Load.NORMAL: lambda k_x, k_y, k, z, nu: -((k_x / k) ** 2 * (1 - k * z) + 2 * nu * (k_y / k) ** 2),
    Load.ALONG_X: lambda k_x, k_y, k, z, nu: k_x / k * (2 + 2 * nu * (k_y / k) ** 2 - (k_x / k) ** 2 * k * z),
    Load.ALONG_Y: lambda k_x, k_y, k, z, nu: k_y / k * (2 * nu * (k_y / k) ** 2 - (k_x / k) ** 2 * k * z),
}
"""Stress sigma_xx, over ``exp(-k z)``, below a harmonic load on a half-space (Boussinesq's potentials)."""


@pytest.mark.parametrize("load", Load)
def test_face_loads_reverse_cosine_transform_of_stress(load: Load) -> None:
    nu, lateral = 0.3, 0.7
    axial, depth = np.array([0.0, 0.4, 2.0]), np.array([0.2, 1.5])
    waves = axial.astype(complex)
    computed = load_on_end(load, waves, depth, lateral, nu)
    for i, j in np.ndindex(computed.shape):
        k = np.hypot(axial[j], lateral)

        def integrand(z: float, i: int = i, j: int = j, k: float = k) -> float:
            return float(END_STRESS[load](axial[j], lateral, k, z, nu) * np.exp(-k * z) * np.cos(depth[i] * z))

        integral = integrate.quad(integrand, 0, 60 / k, limit=200)[0]
        assert computed[i, j] == pytest.approx(-2 / np.pi * integral, abs=1e-9)


@pytest.mark.parametrize("length", [3.0, np.inf])
def test_wavenumbers_scale_with_unit(length: float) -> None:
    for shortest_distance, lateral in ((0.02, 0.7), (200.0, 40.0)):
        baseline = axial_modes(length, lateral, shortest_distance, Resolution())
        variant = axial_modes(1e-3 * length, 1e3 * lateral, 1e-3 * shortest_distance, Resolution())
        for modes, scaled_modes in zip(baseline, variant, strict=True):
            assert scaled_modes.wavenumbers == pytest.approx(1e3 * modes.wavenumbers)
            system, scaled_system = (
                EquationSet.build(unit_modes, unit_factor * lateral, 0.3, shortest_distance / unit_factor, Resolution())
                for unit_modes, unit_factor in ((modes, 1.0), (scaled_modes, 1e3))
            )
            assert scaled_system.depth == pytest.approx(1e3 * system.depth)
            assert abs(modes.ray[-1]) > 0.5 * max(Resolution().reach / shortest_distance, 4 * lateral)
            assert scaled_system.scale == pytest.approx(system.scale)
            assert system.depth[-1] > 0.5 * max(Resolution().reach / shortest_distance, 4 * lateral)
            spectrum = np.ones((modes.wavenumbers.size, 1), np.complex128)
            settings = {"loads": (Load.NORMAL,), "shortest": shortest_distance, "resolution": Resolution()}
            last_depth = abs(system.auxiliary_loads(spectrum, **settings).depth[-1])
            assert last_depth > 0.5 * max(Resolution().ray_reach / shortest_distance, 4 * lateral)


def test_single_mirror_wavenumbers_have_equal_bound() -> None:
    for shortest_distance, lateral in ((0.02, 0.7), (200.0, 4.0)):
        for modes in axial_modes(3.0, lateral, shortest_distance, Resolution(), mirrored_once=True):
            assert modes.discrete.size == 0
            assert abs(modes.ray[-1]) > 0.5 * max(Resolution().reach / shortest_distance, 4 * lateral)
    for lateral, mirrored_once in ((0.7, False), (7.0, True), (7.0, False)):
        computed = axial_modes(3.0, lateral, 0.02, Resolution(), mirrored_once=mirrored_once)
        assert not any(isinstance(modes, SingleMirrorModes) for modes in computed)
        assert len(computed) == (2 if lateral < 1 else 1)
