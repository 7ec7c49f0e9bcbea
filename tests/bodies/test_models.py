"""The comparison models beside the exact bodies."""

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


def test_order_of_the_end_pressures_under_a_cylinder(cylinder_gap, unit_material: Material) -> None:
    """The half-space is singular at the end, the mirror alone flat, the free end falls."""
    end = {}
    for model in ("exact", "mirror", "mirror-factor"):
        body = FiniteLengthSpace(length=8.0, material=unit_material, model=model)
        along = solve_contact(body, cylinder_gap(8.0, (64, 48)), load=8 * LINE_LOAD)["pressure"].max("y")
        end[model] = float(along[0] / along[32])
    assert end["mirror"] == pytest.approx(1.0, abs=1e-3)
    # The free end lies between the mirror, which holds the end up, and the factor, which lets it sink too far.
    assert end["mirror-factor"] < end["exact"] - 0.1
    assert end["exact"] < end["mirror"] - 0.3


def test_mirror_leaves_normal_stress_on_the_ends_and_no_shear(strip_pressure, unit_material: Material) -> None:
    pressure = strip_pressure(8.0, (64, 48))
    body = FiniteLengthSpace(length=8.0, material=unit_material, model="mirror")
    stress = stress_field(body, pressure, x=[0.0], y=[0.0, 0.5], z=[0.1, 0.5], inside_cells=pressure)
    assert float(np.abs(stress["tau_xz"]).max()) < 1e-8
    grid = Grid.from_centres(pressure.x.values, pressure.y.values)
    left = end_traction_residual(body, sliding(pressure.values, 0.0), grid, np.zeros(1), np.array([0.1]))
    # In plane strain along the mirrored strip: Poisson's ratio times the sum of the stresses across.
    across = closed_forms.hertz_strip(0.0, 0.1, 1.0, 1.0, 0.3)
    assert left == pytest.approx(abs(float(across["sigma_xx"])), rel=0.02)
    assert float(stress["sigma_xx"].sel(x=0.0, y=0.0, z=0.1)) == pytest.approx(-left * float(pressure.max()), rel=1e-9)


def test_factor_multiplies_the_mirrored_loads_only(on_cells, unit_material: Material) -> None:
    pressure = on_cells(lambda x, y: np.maximum(1 - (x - 1) ** 2 - y**2, 0), (0.0, 8.0), (-1.5, 1.5), (64, 24))
    sunk = {
        m: surface_displacement(QuarterSpace(material=unit_material, model=m), pressure)
        for m in ("mirror", "mirror-factor")
    }
    from contactstudy import HalfSpace

    half = surface_displacement(HalfSpace(material=unit_material), pressure)
    factor = guilbault_factor(0.3)
    assert np.allclose(sunk["mirror-factor"] - half, factor * (sunk["mirror"] - half), atol=1e-12)


def test_unknown_model_is_named(unit_material: Material) -> None:
    with pytest.raises(InvalidInputError, match=r"model = 'miror'.*did you mean 'mirror'"):
        QuarterSpace(material=unit_material, model="miror")
