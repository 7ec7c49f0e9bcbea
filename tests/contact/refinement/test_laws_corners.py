"""Convex corners: law and intensity at small and large slopes, and the peak at a blend radius."""

from __future__ import annotations

import numpy as np
import pytest

import contactstudy as cs
from contactstudy.contact import corner_peak, edge_peak
from contactstudy.profiles import Chamfer, Cylinder, FullCrown, Halves, Measured, Profile

STEEL = cs.materials.BEARING_STEEL
LENGTH = 2e-3
ANGLE = np.radians(2)


def solve_profile(profile: Profile, accuracy: float = 0.01, length: float = LENGTH):
    roller = cs.Roller(radius=6e-3, length=length, profile=profile)
    case = cs.Case(body=cs.HalfSpace(material=STEEL), roller=roller, max_pressure=1e9)
    return cs.solve(case, stresses=False, accuracy=accuracy)


@pytest.fixture(scope="module")
def chamfered_roller():
    return solve_profile(Chamfer(width=0.5e-3, angle=ANGLE), accuracy=0.02)


class Groove:
    """V groove of 40 um at mid-length."""

    def drop(self, x: np.ndarray, length: float) -> np.ndarray:
        """Material removed (m) at distances `x` (m) from mid-length."""
        return 0.02 * np.maximum(20e-6 - np.abs(x), 0.0)


@pytest.fixture(scope="module")
def grooved_roller():
    return solve_profile(Groove(), accuracy=0.02, length=10e-3)


def test_peak_at_corner_is_infinite(chamfered_roller) -> None:
    assert np.isinf(chamfered_roller.peak_pressure)
    slope = np.tan(ANGLE)
    assert float(chamfered_roller.corner_slope) == pytest.approx(slope)
    assert float(chamfered_roller.corner_intensity) == pytest.approx(STEEL.plane_strain_modulus * slope / (2 * np.pi))
    ridge_result = solve_profile(Halves(FullCrown(0.2, centre=0.5e-3), FullCrown(0.2, centre=-0.5e-3)), accuracy=0.05)
    assert np.isinf(ridge_result.peak_pressure)
    assert float(ridge_result.corner_x) == pytest.approx(LENGTH / 2)


def test_corner_of_user_class_has_the_law(chamfered_roller) -> None:
    class ChamferByDrop:
        """Class with the method `drop` only."""

        def drop(self, x: np.ndarray, length: float) -> np.ndarray:
            """Drop of a chamfer."""
            return Chamfer(width=0.5e-3, angle=ANGLE).drop(x, length)

    result = solve_profile(ChamferByDrop(), accuracy=0.02)
    assert np.isinf(result.peak_pressure)
    for name in ("corner_x", "corner_slope", "corner_intensity", "corner_distance"):
        assert float(result[name]) == pytest.approx(float(chamfered_roller[name]), rel=1e-6)


def test_groove_has_a_law(grooved_roller) -> None:
    assert np.isinf(grooved_roller.peak_pressure)
    assert float(grooved_roller.corner_slope) == pytest.approx(0.02)
    assert abs(float(grooved_roller.corner_x) - 5e-3) == pytest.approx(20e-6)


@pytest.mark.parametrize(("name", "range_ratio"), [("chamfered_roller", 0.05), ("grooved_roller", 0.03)])
def test_corner_pressure_follows_logarithm(name: str, range_ratio: float, request) -> None:
    """The columns within a part of d0 on both sides agree with the means of the law."""
    result = request.getfixturevalue(name)
    distance = float(result.corner_distance)
    low, high = (result.x_bounds.values - float(result.corner_x)).T
    for low_distance, high_distance in ((low, high), (-high, -low)):
        in_range = (low_distance > 0) & (high_distance < range_ratio * distance)
        assert in_range.sum() > 3
        low_distance, high_distance = low_distance[in_range], high_distance[in_range]
        mean_log = (high_distance * np.log(high_distance) - low_distance * np.log(low_distance)) / (
            high_distance - low_distance
        ) - 1
        law = float(result.corner_intensity) * (np.log(distance) - mean_log)
        np.testing.assert_allclose(result.pressure.max("y").values[in_range], law, rtol=0.05)


@pytest.mark.parametrize("radius", [50e-6])
def test_corner_peak_matches_solved_blend(chamfered_roller, radius: float) -> None:
    blended_result = solve_profile(Chamfer(width=0.5e-3, angle=ANGLE, blend_radius=radius))
    expected_peak = corner_peak(
        float(chamfered_roller.corner_intensity),
        float(chamfered_roller.corner_distance),
        float(chamfered_roller.corner_slope),
        radius,
    )
    assert expected_peak == pytest.approx(float(blended_result.peak_pressure), rel=0.01)


def test_wide_blend_raises_error(chamfered_roller) -> None:
    with pytest.raises(cs.InvalidInputError) as caught:
        corner_peak(float(chamfered_roller.corner_intensity), 40e-6, 0.035, 1e-3)
    assert caught.value.parameter == "blend_radius"


def make_corner_law(distance: np.ndarray, d0: float) -> np.ndarray:
    """Pressure over `corner_intensity` on the inner side of a corner."""
    return 2 * np.arcsinh(np.sqrt(d0 / (4 * distance)))


def solve_at_corner(case: cs.Case, result) -> tuple[np.ndarray, np.ndarray]:
    """Distances from the first corner, and pressures, on columns from 1e-6 a at the corner."""
    a, x = float(result.hertz_half_width), float(result.corner_x)
    distances = a * np.append(0.0, np.geomspace(1e-6, 0.3, 50))
    bounds = result.x_bounds.values
    outer_edges = np.append(bounds[:, 0], bounds[-1, 1])
    inner_edges = np.concatenate([x - distances[::-1], x + distances[1:]])
    edges = np.concatenate(
        [
            outer_edges[outer_edges < inner_edges[0] - 0.03 * a],
            inner_edges,
            outer_edges[outer_edges > inner_edges[-1] + 0.03 * a],
        ]
    )
    dy = float(result.y[1] - result.y[0])
    grid = cs.Grid.from_edges(edges, (float(result.y[0]) - dy / 2, float(result.y[-1]) + dy / 2), result.sizes["y"])
    fine_result = cs.solve(case, grid, stresses=False)
    return fine_result.x.values - x, fine_result.pressure.max("y").values


CORNERS = [(angle, material) for material in (None, STEEL) for angle in (1, 2, 4, 8, 15, 30, 45)]
CORNER_MARKS = [() if corner in ((15, None), (45, STEEL)) else pytest.mark.slow for corner in CORNERS]


@pytest.mark.parametrize(
    ("angle", "material"),
    [pytest.param(*corner, marks=mark) for corner, mark in zip(CORNERS, CORNER_MARKS, strict=True)],
)
def test_corner_distance_error_covers_finer_columns(angle: float, material: cs.Material | None) -> None:
    """The law with the error of d0 bounds the pressure on columns that resolve the contact beyond the corner."""
    profile = Chamfer(width=0.1e-3, angle=np.radians(angle))
    roller = cs.Roller(radius=6e-3, length=LENGTH, profile=profile, material=material)
    case = cs.Case(body=cs.HalfSpace(material=STEEL), roller=roller, max_pressure=1e9)
    result = cs.solve(case, stresses=False, accuracy=0.02)
    d0, error, a = (float(result[name]) for name in ("corner_distance", "corner_distance_error", "hertz_half_width"))
    assert error < 0.05 * d0
    x, pressure = solve_at_corner(case, result)
    is_inner = (x > 2e-5 * a) & (x < 2e-3 * a)
    distance, law = x[is_inner], pressure[is_inner] / float(result.corner_intensity)
    assert is_inner.sum() > 10
    assert (law > make_corner_law(distance, d0 - error)).all()
    assert (law < make_corner_law(distance, d0 + error)).all()
    if angle >= 8:
        assert -x[pressure > 0].min() == pytest.approx(d0 / 4, rel=0.3)


def test_wide_blend_of_steep_chamfer_has_peak_of_edge() -> None:
    sharp_result = solve_profile(Chamfer(width=0.1e-3, angle=np.radians(45)), accuracy=0.02)
    assert "0.1" in sharp_result.corner_intensity.attrs["comment"]
    radius = 20e-6
    blended_result = solve_profile(Chamfer(width=0.1e-3, angle=np.radians(45), blend_radius=radius))
    intensity = float(sharp_result.corner_intensity) * np.sqrt(float(sharp_result.corner_distance))
    expected_peak = edge_peak(intensity, STEEL.plane_strain_modulus, radius)
    assert expected_peak == pytest.approx(float(blended_result.peak_pressure), rel=0.1)


@pytest.mark.filterwarnings("error")
def test_almost_flat_corner_has_no_d0() -> None:
    """At a slope of 1e-5 the logarithm of d0 exceeds 1000 in magnitude."""
    result = solve_profile(Chamfer(width=0.5e-3, depth=5e-9) + Cylinder(0.1e-3), accuracy=0.1)
    assert np.isinf(result.corner_distance_error)


def test_measured_corner_has_infinite_peak_error() -> None:
    x = np.linspace(-LENGTH / 2, LENGTH / 2, 401)
    result = solve_profile(Measured(x, Chamfer(width=0.5e-3, angle=ANGLE).drop(x, LENGTH)))
    assert np.isfinite(result.peak_pressure)
    assert np.isinf(result.peak_pressure_error)
