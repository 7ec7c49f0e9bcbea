"""Default positions of stresses: from the end of the body, dense at the largest stress."""

from __future__ import annotations

import numpy as np
import pytest

from contactstudy import Case, FiniteLengthSpace, HalfSpace, Material, Roller, profiles, solve
from contactstudy.analysis import in_plane
from contactstudy.fields.positions import default_depths

STEEL = Material(210e9, 0.3)
HALF_WIDTH = 4 * 1.5e9 * 5e-3 / (2 * STEEL.plane_strain_modulus)


def make_case(end_distance: float = 0.0, body: float | None = None, **settings: float) -> Case:
    """Steel roller of 0.6 mm with an edge radius, and its body."""
    length = 0.6e-3 + 2 * end_distance if body is None else body
    roller = Roller(radius=5e-3, length=0.6e-3, profile=profiles.Cylinder(fillet_radius=0.05e-3))
    return Case(
        body=FiniteLengthSpace(length=length, material=STEEL),
        roller=roller,
        max_pressure=1.5e9,
        friction=0.1,
        end_distance=end_distance,
        **settings,
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    "case",
    [
        pytest.param(make_case(), id="flush"),
        pytest.param(make_case(5 * HALF_WIDTH), id="5a", marks=pytest.mark.slow),
        pytest.param(make_case(-0.12e-3, body=0.36e-3), id="overhanging"),
        pytest.param(make_case(HALF_WIDTH, tilt=2e-4), id="tilted", marks=pytest.mark.slow),
    ],
)
def test_default_positions_contain_stress_maximum(case: Case) -> None:
    result = solve(case, y=[0.0], accuracy=0.1)
    x = result["x_field"].values
    assert x[0] == 0.0
    assert x[-1] == case.body.extent[1]
    peak_von_mises = float(result["peak_von_mises"])
    plane_stress = in_plane(result, y=0.0, variables="von_mises")["von_mises"]
    assert 0.97 * peak_von_mises <= float(plane_stress.max()) <= peak_von_mises * (1 + 1e-9)


def test_positions_on_a_half_space_cover_the_grid() -> None:
    case = Case(body=HalfSpace(material=STEEL), roller=make_case().roller, max_pressure=1.5e9)
    result = solve(case, y=[0.0], z=[0.1e-3], accuracy=0.1)
    edges = result["x_bounds"].values
    assert result["x_field"].values[[0, -1]] == pytest.approx([edges.min(), edges.max()])


def test_depths_of_similar_cases_are_equal() -> None:
    assert np.array_equal(default_depths(1e-4, 4.6e-6), default_depths(1e-4, 5.0e-6))
    depths = default_depths(1.0, np.inf)
    assert depths[0] == 0.0
    assert depths[-1] == 5.0
    assert (np.diff(depths) > 0).all()
