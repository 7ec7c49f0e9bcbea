"""Influence matrices of cells against the stresses of a body."""

from __future__ import annotations

import numpy as np

from contactstudy.bodies.material import Material
from contactstudy.eigenstrain.body import EigenstrainBody, cell_influence, layer_stresses

TEST_MATERIAL = Material(2.0, 0.3)


def test_influence_of_selected_cells_matches_body() -> None:
    body = EigenstrainBody(
        material=TEST_MATERIAL, extent=(0.0, 2.0), x_edges=np.linspace(0, 2, 6), z_edges=np.linspace(0, 1, 5)
    )
    columns, layers = np.array([0, 1, 4, 4]), np.array([0, 2, 1, 3])
    strains = np.random.default_rng(5).normal(size=(6, 4))
    full_strain = np.zeros((6, 5, 4))
    full_strain[:, columns, layers] = strains
    expected = body.solve(full_strain).cell_averages()[:, columns, layers]
    computed = cell_influence(body, columns, layers)(strains)
    assert np.allclose(computed, expected, atol=1e-9)


def test_layer_influence_equals_long_row_of_cells() -> None:
    body = EigenstrainBody(
        material=TEST_MATERIAL,
        extent=(-np.inf, np.inf),
        x_edges=np.linspace(-60, 60, 25),
        z_edges=np.array([0.0, 0.25, 0.5]),
    )
    strain = np.zeros((6, 24, 2))
    strain[:, :, 1] = np.array([1.0, 0.5, -0.3, 0.2, 0.4, -0.6])[:, None]
    row_stress = body.solve(strain).cell_averages()[:, 12, 1]
    layer_stress = layer_stresses(TEST_MATERIAL, strain[:, 0, 1:])[:, 0]
    assert np.allclose(row_stress, layer_stress, atol=0.02)  # the row is finite
