"""Comparison models against the exact bodies."""

from __future__ import annotations

import numpy as np
import pytest

from contactstudy import (
    FiniteLengthSpace,
    Grid,
    InvalidInputError,
    Material,
    QuarterSpace,
    solve_contact,
    stress_field,
    surface_displacement,
)
from contactstudy.bodies.models import guilbault_factor
from contactstudy.fields.loads import sliding
from contactstudy.fields.stress import end_traction_residual
from contactstudy.verification import closed_forms
from contactstudy.verification.problems import LINE_LOAD


def test_order_of_end_pressures_by_model(cylinder_gap, unit_material: Material) -> None:
    """The end pressure of the exact model lies between the mirror models."""
    end_ratios = {}
    for model in ("exact", "mirror", "mirror-factor"):
        body = FiniteLengthSpace(length=8.0, material=unit_material, model=model)
        section_maxima = solve_contact(body, cylinder_gap(8.0, (64, 48)), load=8 * LINE_LOAD)["pressure"].max("y")
        end_ratios[model] = float(section_maxima[0] / section_maxima[32])
    assert end_ratios["mirror"] == pytest.approx(1.0, abs=1e-3)
    # The end of the mirror model is too stiff, the end of the model with a factor too compliant.
    assert end_ratios["mirror-factor"] < end_ratios["exact"] - 0.1
    assert end_ratios["exact"] < end_ratios["mirror"] - 0.3


def test_mirror_model_has_normal_stress_on_the_ends(strip_pressure, unit_material: Material) -> None:
    pressure = strip_pressure(8.0, (64, 48))
    body = FiniteLengthSpace(length=8.0, material=unit_material, model="mirror")
    stress = stress_field(body, pressure, x=[0.0], y=[0.0, 0.5], z=[0.1, 0.5], inside_cells=pressure)
    assert float(np.abs(stress["tau_xz"]).max()) < 1e-8
    grid = Grid.from_centres(pressure.x.values, pressure.y.values)
    end_traction = end_traction_residual(body, sliding(pressure.values, 0.0), grid, np.zeros(1), np.array([0.1]))
    # In plane strain along the mirrored strip the stress is Poisson's ratio times the sum of the lateral stresses.
    line_stresses = closed_forms.hertz_strip(0.0, 0.1, 1.0, 1.0, 0.3)
    assert end_traction == pytest.approx(abs(float(line_stresses["sigma_xx"])), rel=0.02)
    assert float(stress["sigma_xx"].sel(x=0.0, y=0.0, z=0.1)) == pytest.approx(
        -end_traction * float(pressure.max()), rel=1e-9
    )


def test_factor_multiplies_only_mirrored_loads(on_cells, unit_material: Material) -> None:
    pressure = on_cells(lambda x, y: np.maximum(1 - (x - 1) ** 2 - y**2, 0), (0.0, 8.0), (-1.5, 1.5), (64, 24))
    displacements = {
        model: surface_displacement(QuarterSpace(material=unit_material, model=model), pressure)
        for model in ("mirror", "mirror-factor")
    }
    from contactstudy import HalfSpace

    half_space_displacement = surface_displacement(HalfSpace(material=unit_material), pressure)
    factor = guilbault_factor(0.3)
    assert np.allclose(
        displacements["mirror-factor"] - half_space_displacement,
        factor * (displacements["mirror"] - half_space_displacement),
        atol=1e-12,
    )


def test_unknown_model_raises(unit_material: Material) -> None:
    with pytest.raises(InvalidInputError, match=r"model = 'miror'.*did you mean 'mirror'"):
        QuarterSpace(material=unit_material, model="miror")
