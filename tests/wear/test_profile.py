"""Worn profiles on other cells than those of the wear calculation have the same pressure, also at sharp ends."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from contactstudy import Case, FiniteLengthSpace, Grid, Material, Roller, choose_grid, fatigue, solve
from contactstudy.checks import FloatArray
from contactstudy.profiles import Cylinder, FullCrown
from contactstudy.wear import wear_in, worn_profile

STEEL = Material(210e9, 0.3)
K = 1e-17
LENGTH, MARGIN = 0.4e-3, 0.1e-3
"""Lengths of the roller and of the body beyond either end."""


def make_case(profile=None, *, margin: float = MARGIN) -> Case:
    body = FiniteLengthSpace(length=LENGTH + 2 * margin, material=STEEL)
    roller = Roller(radius=5e-3, length=LENGTH, **({} if profile is None else {"profile": profile}))
    return Case(body=body, roller=roller, max_pressure=1.5e9)


def make_equal_columns(count: int, cells_y: int = 48) -> Grid:
    """Columns of one width under the roller, and wider columns beyond its ends."""
    margin_edges = np.linspace(0.0, MARGIN, 6)
    edges = np.concatenate(
        [margin_edges[:-1], np.linspace(MARGIN, MARGIN + LENGTH, count + 1), MARGIN + LENGTH + margin_edges[1:]]
    )
    half_window = 2.6 * make_case().hertz_half_width
    return Grid.from_edges(edges, (-half_window, half_window), cells_y)


@pytest.fixture(scope="module")
def refined_wear() -> xr.Dataset:
    """Wear on columns refined at the ends to a thousandth of a half-width."""
    return wear_in(make_case(), K, distance=[0.0, 2e4, 2e5], tolerance=0.03)


@pytest.fixture(scope="module")
def coarse_wear() -> xr.Dataset:
    """Wear as in `refined_wear` on columns of 5 um."""
    return wear_in(make_case(), K, distance=[0.0, 2e4, 2e5], grid=make_equal_columns(80), tolerance=0.03)


@pytest.mark.slow
def test_columns_of_wear_equal_columns_of_unworn_contact(refined_wear) -> None:
    unworn_contact = solve(make_case(), stresses=False)
    assert refined_wear.x.values == pytest.approx(unworn_contact.x.values)
    assert "x_width" in refined_wear.coords
    assert refined_wear.line_load.values[0].max() > 2 * refined_wear.line_load.values[1].max()
    assert float(refined_wear.volume_error) < 1e-12


def compute_column_peaks(profile, **options: object) -> xr.DataArray:
    """Largest pressure of each column divided by p0; `x` is the distance from the end of the roller (m)."""
    peaks = solve(make_case(profile), stresses=False, **options)["pressure"].max("y") / 1.5e9
    loaded_peaks = peaks.where(peaks > 0, drop=True)
    return loaded_peaks.assign_coords(x=loaded_peaks["x"] - MARGIN).sel(x=slice(0, LENGTH / 2))


@pytest.mark.slow
@pytest.mark.parametrize("index", [1, 2])
def test_pressure_of_coarse_worn_profile_on_finer_columns_equals_wear(refined_wear, coarse_wear, index: int) -> None:
    """Columns of 5 um do not resolve the last micrometres; the profile continues to the end."""
    peaks = compute_column_peaks(worn_profile(make_case(), coarse_wear, float(refined_wear["distance"][index])))
    worn_peaks = refined_wear["pressure"].isel(distance=index).max("y") / 1.5e9
    expected = worn_peaks.assign_coords(x=worn_peaks["x"] - MARGIN).interp(x=peaks["x"])
    outside_end = peaks["x"] > 0.15e-6
    assert np.abs(peaks / expected - 1).where(outside_end).max() < 0.08
    assert np.abs(peaks / expected - 1).where(peaks["x"] > 2e-6).max() < 0.04
    assert float(peaks.max()) < 2 * float(expected.max())


@pytest.mark.slow
def test_pressure_of_worn_profile_on_halved_columns_equals_wear(refined_wear) -> None:
    """Halved columns have the pressure of the whole columns; the pressure at the end is not singular."""
    edges = np.append(refined_wear["x_bounds"].values[:, 0], refined_wear["x_bounds"].values[-1, 1])
    halved_edges = np.sort(np.concatenate([edges, 0.5 * (edges[1:] + edges[:-1])]))
    grid = Grid.from_edges(
        halved_edges, (float(refined_wear["y"][0]), float(refined_wear["y"][-1])), refined_wear.sizes["y"]
    )
    peaks = compute_column_peaks(worn_profile(make_case(), refined_wear), grid=grid)
    worn_peaks = refined_wear["pressure"].isel(distance=-1).max("y") / 1.5e9
    expected = worn_peaks.assign_coords(x=worn_peaks["x"] - MARGIN).interp(x=peaks["x"])
    assert np.abs(peaks / expected - 1).where(peaks["x"] > 0.5e-6).max() < 0.02
    assert float(peaks.max()) < 1.3 * float(worn_peaks.max())


@pytest.mark.slow
def test_shakedown_limit_near_end_is_independent_of_columns(refined_wear, coarse_wear) -> None:
    half_width = make_case().hertz_half_width
    x = MARGIN + half_width * np.array([0.0, 0.02, 0.05, 0.1, 0.2])
    positions = {"x": x, "y": half_width * np.linspace(-2, 2, 25), "z": half_width * np.array([0.03, 0.1, 0.3, 0.6])}
    shakedown_limits = [
        float(
            fatigue.shakedown(solve(make_case(worn_profile(make_case(), wear_result)), **positions))[
                "shakedown_stress"
            ].max()
        )
        for wear_result in (coarse_wear, refined_wear)
    ]
    assert shakedown_limits[0] == pytest.approx(shakedown_limits[1], rel=0.05)


@pytest.fixture(scope="module")
def uniform_wear() -> xr.Dataset:
    """Wear on few uniform cells."""
    return wear_in(make_case(), K, distance=[0.0, 1e4, 2e4], grid=choose_grid(make_case(), cells_x=2, cells_y=6))


def test_worn_profile_at_zero_distance_is_zero(uniform_wear) -> None:
    profile = worn_profile(make_case(), uniform_wear, 0.0)
    assert profile.drop(0.5 * LENGTH * np.linspace(-1, 1, 101), LENGTH).max() == 0.0


def test_slope_is_uniform_at_a_flush_end() -> None:
    """Body and roller end at the same position; the slope does not increase towards the free end."""
    case = make_case(margin=0.0)
    half_window = 2.6 * case.hertz_half_width
    edges = np.linspace(0, LENGTH, 41)
    wear_result = wear_in(case, K, distance=[0.0, 2e5], grid=Grid.from_edges(edges, (-half_window, half_window), 32))
    profile = worn_profile(case, wear_result)
    end_distances = 1e-6 * np.array([0.0, 1.0, 2.0, 4.0])
    slopes = np.diff(profile.drop(end_distances - 0.5 * LENGTH, LENGTH)) / np.diff(end_distances)
    assert np.ptp(slopes) < 0.3 * np.abs(slopes).max()


def test_worn_overhanging_roller_has_no_ridge() -> None:
    body = FiniteLengthSpace(length=0.3e-3, material=STEEL)
    case = Case(body=body, roller=Roller(radius=5e-3, length=LENGTH), max_pressure=1.5e9, end_distance=-0.05e-3)
    half_window = 2.6 * case.hertz_half_width
    wear_result = wear_in(
        case, K, distance=[0.0, 2e4], grid=Grid.from_edges(np.linspace(0, 0.3e-3, 31), (-half_window, half_window), 32)
    )
    profile = worn_profile(case, wear_result)
    depth = wear_result["wear_depth"].values[-1]
    end_drops = profile.drop(np.array([-0.15e-3, 0.15e-3]), LENGTH)
    assert end_drops == pytest.approx(depth[[0, -1]], rel=0.05)


@pytest.mark.parametrize("border", [0.02e-3, 0.04e-3, 0.06e-3])
def test_worn_profile_at_border_of_worn_columns_equals_parabola(border: float) -> None:
    """The worn depth is a parabola with its border within a column; harmonic-mean slopes would deviate by 5 nm."""
    radius = 0.02
    case = make_case(FullCrown(crown_radius=radius), margin=0.0)
    x = LENGTH * (np.arange(20) + 0.5) / 20

    def compute_parabola(x: FloatArray) -> FloatArray:
        return np.maximum(border - x, 0.0) ** 2 / (2 * radius)

    depth = xr.DataArray([compute_parabola(x - 0.5 * LENGTH)], dims=("distance", "x"))
    pressure = xr.zeros_like(depth).expand_dims(y=[0.0], axis=-1)
    wear_result = xr.Dataset({"wear_depth": depth, "pressure": pressure}, {"distance": [1e3], "x": x})
    x = np.linspace(border - 0.1e-3, border, 201)
    drop = worn_profile(case, wear_result).drop(x, LENGTH)
    assert drop == pytest.approx(x**2 / (2 * radius) + compute_parabola(x), abs=1.2e-9)


@pytest.mark.slow
def test_partly_worn_edge_radius_has_no_ridge() -> None:
    """Interpolation of depths on wide columns would cause a ridge with a pressure above that of the unworn radius."""
    case = make_case(Cylinder(fillet_radius=0.1e-3))
    wear_result = wear_in(case, K, distance=[0.0, 1e4])
    worn_result = solve(make_case(worn_profile(case, wear_result)), stresses=False)
    unworn_peak, worn_peak = (float(wear_result["pressure"].isel(distance=index).max()) for index in (0, -1))
    assert worn_peak < float(worn_result.peak_pressure) < 0.8 * unworn_peak


def test_worn_profile_of_single_distance_equals_selected_distance(uniform_wear) -> None:
    case = make_case()
    x = np.linspace(-0.5, 0.5, 41) * LENGTH
    selected_profile, single_profile = (
        worn_profile(case, uniform_wear, 1e4),
        worn_profile(case, uniform_wear.sel(distance=1e4)),
    )
    assert single_profile.drop(x, LENGTH) == pytest.approx(selected_profile.drop(x, LENGTH))
