"""Exact limits of the quarter space."""

from __future__ import annotations

import numpy as np
import pytest

from contactstudy.overlapping.axial import axial_modes
from contactstudy.overlapping.equations import EquationSet
from contactstudy.overlapping.quadrature import Resolution


@pytest.mark.parametrize("poisson", [0.0, 0.15, 0.3, 0.5])
def test_resultants_of_the_equivalent_loads(poisson: float) -> None:
    """For a load P: ``P / (1 - 4 / pi**2)`` on the top and ``2 / pi`` of that in tension on the end."""
    lateral, place = 1e-7, 1.0
    (modes,) = axial_modes(np.inf, lateral, 1e-4, Resolution())
    system = EquationSet.build(modes, lateral, poisson, 1e-4, Resolution())
    spectrum = modes.load_weights * modes.cosine(np.array([place]))[:, 0]
    scaled = system.solve(system.from_pressure(spectrum))
    on_top = system.on_top(scaled) / modes.weights
    # Resultants are the transforms where the wavenumber is small against 1 / place, large against the lateral one.
    window = np.abs(modes.ray) < 3e-3
    top = 1 + 0.5 * np.pi * np.interp(1e-3, np.abs(modes.ray[window]), on_top.real[window])
    face_load = scaled / system.scale
    end = -0.5 * np.pi * np.interp(1e-3, system.depth, face_load)
    exact = 1 / (1 - 4 / np.pi**2)
    assert top == pytest.approx(exact, rel=3e-3)
    assert end == pytest.approx(-2 / np.pi * exact, rel=3e-3)


def test_a_traction_that_does_not_vary_along_y_asks_for_no_end_load() -> None:
    (modes,) = axial_modes(np.inf, 1e-9, 1e-2, Resolution())
    system = EquationSet.build(modes, 1e-9, 0.3, 1e-2, Resolution())
    spectrum = modes.load_weights * modes.cosine(np.array([1.0]))[:, 0]
    # On depths of the order of the wavelength along y, far below everything, there is always some.
    near = system.depth > 1e-3
    assert np.abs(system.from_traction(spectrum)[near]).max() < 1e-5
    assert np.abs(system.from_pressure(spectrum)[near]).max() > 0.1
