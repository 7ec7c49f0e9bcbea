"""Eigenstrains periodic along y: short waves, a rectangle in plane strain, uniform layers."""

from __future__ import annotations

import numpy as np
import pytest

from contactstudy.bodies.material import Material
from contactstudy.eigenstrain.body import XX, XY, XZ, YY, YZ, ZZ, PeriodicLayers, layer_stresses
from contactstudy.verification.closed_forms import rectangle_in_half_plane

TEST_MATERIAL = Material(2.0, 0.3)
EDGES = np.linspace(0.4, 1.2, 17)


def test_rectangle_in_half_plane_matches_closed_form() -> None:
    """The periodic stress agrees with forces in a half-plane; the period is far longer than the rectangle."""
    positions, step = 1024, 0.05
    y = step * (np.arange(positions) - positions // 2)
    z = 0.5 * (EDGES[1:] + EDGES[:-1])
    is_inside = ((np.abs(y) < 0.325)[:, None] & (np.abs(z - 0.8) < 0.2)).astype(float)
    strain = np.zeros((6, positions, 1, 16))
    strain_components = {YY: 1.0, XX: 0.5, ZZ: -0.3, YZ: 0.4}
    for component, value in strain_components.items():
        strain[component, :, 0] = value * is_inside
    computed = PeriodicLayers(TEST_MATERIAL, EDGES, positions, step).stresses(strain)[:, :, 0]
    position_indices = np.searchsorted(y, [-1.0 - 1e-9, -0.6 - 1e-9, 0.2 - 1e-9, 0.7 - 1e-9])
    # The rectangle is infinite along y in the closed form, along x in the computation.
    expected = rectangle_in_half_plane(
        y[position_indices][:, None],
        z,
        (-0.325, 0.325),
        (0.6, 1.0),
        tuple(strain_components.values()),
        TEST_MATERIAL.young,
        TEST_MATERIAL.poisson,
    )
    stress_scale = np.abs(expected).max()
    for component, expected_stress in zip((YY, XX, ZZ, YZ), expected, strict=True):
        assert (
            np.abs(computed[component][position_indices] - expected_stress)[:, [0, 1, 6, 7, 8, 14]].max()
            < 0.02 * stress_scale
        )


def test_uniform_strain_has_stress_of_layers() -> None:
    strain = np.zeros((6, 8, 2, 16)) + np.random.default_rng(3).normal(size=(6, 1, 2, 16))
    computed = PeriodicLayers(TEST_MATERIAL, EDGES, 8, 0.1).stresses(strain)
    expected = layer_stresses(TEST_MATERIAL, strain.reshape(6, -1)).reshape(strain.shape)
    assert np.allclose(computed, expected, atol=1e-12)


def test_short_waves_have_no_stress_along_z() -> None:
    """Short waves along y: the traction on planes y = const vanishes, and strains within these planes are prevented."""
    strain = np.zeros((6, 64, 1, 16))
    strain[:, :, 0] = np.cos(np.pi / 4 * np.arange(64))[:, None]
    computed = PeriodicLayers(TEST_MATERIAL, 40 * EDGES, 64, 0.01).stresses(strain)[:, 0, 0, 8]
    modulus = TEST_MATERIAL.plane_strain_modulus
    uniaxial_stress = -modulus * (1 + TEST_MATERIAL.poisson)
    expected = {XX: uniaxial_stress, ZZ: uniaxial_stress, XZ: -2 * TEST_MATERIAL.shear_modulus}
    assert computed == pytest.approx([expected.get(component, 0.0) for component in range(6)], abs=2e-3)


def test_reversed_path_mirrors_stresses() -> None:
    """A reversal of the path changes the sign of the shears."""
    strain = np.random.default_rng(4).normal(size=(6, 16, 1, 16))
    mirrored_strain = strain[:, ::-1].copy()
    mirrored_strain[[XY, YZ]] *= -1
    stresses, mirrored_stresses = (
        PeriodicLayers(TEST_MATERIAL, EDGES, 16, 0.2).stresses(eigenstrain) for eigenstrain in (strain, mirrored_strain)
    )
    mirrored_stresses[[XY, YZ]] *= -1
    assert np.allclose(stresses, mirrored_stresses[:, ::-1], atol=1e-9)
    reversed_step_stresses = PeriodicLayers(TEST_MATERIAL, EDGES, 16, -0.2).stresses(strain[:, ::-1])
    assert np.allclose(stresses, reversed_step_stresses[:, ::-1], atol=1e-9)
