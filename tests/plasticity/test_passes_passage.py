"""One pass over a single layer, against the rate equations."""

from __future__ import annotations

from functools import partial
from itertools import pairwise

import numpy as np
import pytest

from contactstudy import fatigue
from contactstudy.arrays.variables import STRESSES
from contactstudy.bodies import Material
from contactstudy.eigenstrain.body import layer_stresses
from contactstudy.plasticity.passes import ElasticPlastic, Passage, PlasticState

YOUNG, POISSON = 1000.0, 0.3
MATERIAL = Material(YOUNG, POISSON)


class IndependentLayers:
    """Layers without influence between positions along y."""

    material = MATERIAL

    def __init__(self, positions: int) -> None:
        self.positions = positions

    def stresses(self, eigenstrain: np.ndarray) -> np.ndarray:
        return layer_stresses(MATERIAL, eigenstrain.reshape(6, -1)).reshape(eigenstrain.shape)


def solve_passes(
    history: np.ndarray, shear_yield_stress: float, hardening: tuple[float, float], count: int
) -> PlasticState:
    """Passes over one cell of a history (instant, 6)."""
    index = np.zeros(1, np.int64)
    passage = Passage(
        elastic_stress=history.T[:, :, None],
        compute_residual=partial(layer_stresses, MATERIAL),
        layers=IndependentLayers(history.shape[0] + 2),
        cell_indices=(index, index),
        yield_stress=np.full(1, np.sqrt(3) * shear_yield_stress),
        material=ElasticPlastic(yield_stress=1e9, isotropic_hardening=hardening[0], kinematic_hardening=hardening[1]),
        tolerance=1e-5,
    )
    state = PlasticState(np.zeros((6, 1)), np.zeros(1), True)
    for _ in range(count):
        state = passage.solve(state)
    return state


def integrate_rates(
    history: np.ndarray, yield_radius: float, hardening: tuple[float, float], passes: int, substeps: int
) -> np.ndarray:
    """Residual stresses xx and yy of one layer, by the rate equations of Prandtl and Reuss in many small steps."""
    modulus = YOUNG / (1 - POISSON**2)
    isotropic, kinematic = hardening
    strain, accumulated_strain = np.zeros(6), 0.0

    def compute_residual_stress(plastic: np.ndarray) -> np.ndarray:
        xx, yy = modulus * (plastic[0] + POISSON * plastic[1]), modulus * (plastic[1] + POISSON * plastic[0])
        return -np.array([xx, yy, 0, YOUNG / (1 + POISSON) * plastic[3], 0, 0])

    component_counts = np.array([1, 1, 1, 2, 2, 2.0])
    for _ in range(passes):
        for stress_before, stress_after in pairwise(history):
            for substep in range(substeps):
                stress = (
                    stress_before
                    + (substep + 1) / substeps * (stress_after - stress_before)
                    + compute_residual_stress(strain)
                )
                deviator = stress - np.array([1, 1, 1, 0, 0, 0]) * stress[:3].mean() - 2 / 3 * kinematic * strain
                norm = np.sqrt((component_counts * deviator**2).sum())
                if norm > yield_radius + np.sqrt(2 / 3) * isotropic * accumulated_strain:
                    # The stress returns along the normal; the body responds to the flow by `residual_of`.
                    normal = deviator / norm
                    slope = -(component_counts * normal * compute_residual_stress(normal)).sum() + 2 / 3 * (
                        kinematic + isotropic
                    )
                    step = (norm - yield_radius - np.sqrt(2 / 3) * isotropic * accumulated_strain) / slope
                    strain, accumulated_strain = strain + step * normal, accumulated_strain + np.sqrt(2 / 3) * step
    return compute_residual_stress(strain)[:2]


@pytest.mark.parametrize(
    ("friction", "yield_ratio", "hardening"),
    [
        (0.0, 0.95, (0.0, 20.0)),
        (0.2, 0.97, (0.0, 10.0)),
        pytest.param(0.2, 0.9, (30.0, 0.0), marks=pytest.mark.slow),
    ],
)
def test_layer_agrees_with_rate_equations(
    line_contact, friction: float, yield_ratio: float, hardening: tuple[float, float]
) -> None:
    contact = line_contact(friction)
    yield_stresses = fatigue.shakedown(contact)["shakedown_stress"].isel(x=0)
    depth_index = int(yield_stresses.values.argmax())
    yield_stress = yield_ratio * float(yield_stresses[depth_index])
    coarse_history = np.stack([contact[name].isel(x=0, z=depth_index).values[::-1] for name in STRESSES], axis=1)
    positions = np.linspace(0, len(coarse_history) - 1, 12 * (len(coarse_history) - 1) + 1)
    fine_history = np.stack(
        [np.interp(positions, np.arange(len(coarse_history)), values) for values in coarse_history.T], axis=1
    )
    state = solve_passes(fine_history, yield_stress, hardening, 3)
    assert state.converged
    expected = integrate_rates(coarse_history, np.sqrt(2) * yield_stress, hardening, 3, 40)
    assert np.abs(expected).max() > 0.01
    assert layer_stresses(MATERIAL, state.strain)[:2, 0] == pytest.approx(expected, abs=0.01 * np.abs(expected).max())
