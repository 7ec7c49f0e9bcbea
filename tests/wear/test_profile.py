"""Worn profiles on other cells than the cells of the wear: the pressure remains, also at sharp ends."""

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


def worn_case(profile=None, *, margin: float = MARGIN) -> Case:
    body = FiniteLengthSpace(length=LENGTH + 2 * margin, material=STEEL)
    roller = Roller(radius=5e-3, length=LENGTH, **({} if profile is None else {"profile": profile}))
    return Case(body=body, roller=roller, max_pressure=1.5e9)


def grid_of_equal_columns(count: int, cells_y: int = 48) -> Grid:
    """Columns of one width under the roller, and wider columns beyond its ends."""
    margin_edges = np.linspace(0.0, MARGIN, 6)
    edges = np.concatenate(
        [margin_edges[:-1], np.linspace(MARGIN, MARGIN + LENGTH, count + 1), MARGIN + LENGTH + margin_edges[1:]]
    )
    half_window = 2.6 * worn_case().hertz_half_width
    return Grid.from_edges(edges, (-half_window, half_window), cells_y)


@pytest.fixture(scope="module")
def refined() -> xr.Dataset:
    """Wear on columns refined at the ends to a thousandth of a half-width."""
    return wear_in(worn_case(), K, distance=[0.0, 2e4, 2e5], tolerance=0.03)


@pytest.fixture(scope="module")
def coarse() -> xr.Dataset:
    """Wear as in `refined` on columns of 5 um."""
    return wear_in(worn_case(), K, distance=[0.0, 2e4, 2e5], grid=grid_of_equal_columns(80), tolerance=0.03)


@pytest.mark.slow
def test_columns_of_the_unworn_contact(refined) -> None:
    unworn = solve(worn_case(), stresses=False)
    assert refined.x.values == pytest.approx(unworn.x.values)
    assert "x_width" in refined.coords
    assert refined.line_load.values[0].max() > 2 * refined.line_load.values[1].max()
    assert float(refined.volume_error) < 1e-12


def column_peaks(profile, **options: object) -> xr.DataArray:
    """Largest pressure of each column under a profile over p0, over the distance from the roller's end (metres)."""
    peaks = solve(worn_case(profile), stresses=False, **options)["pressure"].max("y") / 1.5e9
    loaded = peaks.where(peaks > 0, drop=True)
    return loaded.assign_coords(x=loaded["x"] - MARGIN).sel(x=slice(0, LENGTH / 2))


@pytest.mark.slow
@pytest.mark.parametrize("index", [1, 2])
def test_pressure_on_finer_columns(refined, coarse, index: int) -> None:
    """Columns of 5 um do not resolve the last micrometres; the profile continues to the end."""
    peaks = column_peaks(worn_profile(worn_case(), coarse, float(refined["distance"][index])))
    worn_peaks = refined["pressure"].isel(distance=index).max("y") / 1.5e9
    expected = worn_peaks.assign_coords(x=worn_peaks["x"] - MARGIN).interp(x=peaks["x"])
    outside_end = peaks["x"] > 0.15e-6
    assert np.abs(peaks / expected - 1).where(outside_end).max() < 0.08
    assert np.abs(peaks / expected - 1).where(peaks["x"] > 2e-6).max() < 0.04
    assert float(peaks.max()) < 2 * float(expected.max())


@pytest.mark.slow
def test_pressure_on_halved_columns(refined) -> None:
    """Halved columns have the pressure of the whole columns; the pressure at the end is not singular."""
    edges = np.append(refined["x_bounds"].values[:, 0], refined["x_bounds"].values[-1, 1])
    halved = np.sort(np.concatenate([edges, 0.5 * (edges[1:] + edges[:-1])]))
    cells = Grid.from_edges(halved, (float(refined["y"][0]), float(refined["y"][-1])), refined.sizes["y"])
    peaks = column_peaks(worn_profile(worn_case(), refined), grid=cells)
    worn_peaks = refined["pressure"].isel(distance=-1).max("y") / 1.5e9
    expected = worn_peaks.assign_coords(x=worn_peaks["x"] - MARGIN).interp(x=peaks["x"])
    assert np.abs(peaks / expected - 1).where(peaks["x"] > 0.5e-6).max() < 0.02
    assert float(peaks.max()) < 1.3 * float(worn_peaks.max())


@pytest.mark.slow
def test_shakedown_limit_near_the_end(refined, coarse) -> None:
    a = worn_case().hertz_half_width
    x = MARGIN + a * np.array([0.0, 0.02, 0.05, 0.1, 0.2])
    positions = {"x": x, "y": a * np.linspace(-2, 2, 25), "z": a * np.array([0.03, 0.1, 0.3, 0.6])}
    limits = [
        float(
            fatigue.shakedown(solve(worn_case(worn_profile(worn_case(), worn)), **positions))["shakedown_stress"].max()
        )
        for worn in (coarse, refined)
    ]
    assert limits[0] == pytest.approx(limits[1], rel=0.05)


@pytest.fixture(scope="module")
def uniform() -> xr.Dataset:
    """Wear on few uniform cells."""
    return wear_in(worn_case(), K, distance=[0.0, 1e4, 2e4], grid=choose_grid(worn_case(), cells_x=2, cells_y=6))


def test_unworn_profile(uniform) -> None:
    profile = worn_profile(worn_case(), uniform, 0.0)
    assert profile.drop(0.5 * LENGTH * np.linspace(-1, 1, 101), LENGTH).max() == 0.0


def test_slope_is_uniform_at_a_flush_end() -> None:
    """The body ends at the roller's end, and the slope does not increase towards this free end."""
    case = worn_case(margin=0.0)
    half_window = 2.6 * case.hertz_half_width
    edges = np.linspace(0, LENGTH, 41)
    worn = wear_in(case, K, distance=[0.0, 2e5], grid=Grid.from_edges(edges, (-half_window, half_window), 32))
    profile = worn_profile(case, worn)
    s = 1e-6 * np.array([0.0, 1.0, 2.0, 4.0])
    slopes = np.diff(profile.drop(s - 0.5 * LENGTH, LENGTH)) / np.diff(s)
    assert np.ptp(slopes) < 0.3 * np.abs(slopes).max()


def test_overhanging_roller_without_a_ridge() -> None:
    body = FiniteLengthSpace(length=0.3e-3, material=STEEL)
    case = Case(body=body, roller=Roller(radius=5e-3, length=LENGTH), max_pressure=1.5e9, end_distance=-0.05e-3)
    half_window = 2.6 * case.hertz_half_width
    worn = wear_in(
        case, K, distance=[0.0, 2e4], grid=Grid.from_edges(np.linspace(0, 0.3e-3, 31), (-half_window, half_window), 32)
    )
    profile = worn_profile(case, worn)
    depth = worn["wear_depth"].values[-1]
    ends = profile.drop(np.array([-0.15e-3, 0.15e-3]), LENGTH)
    assert ends == pytest.approx(depth[[0, -1]], rel=0.05)


@pytest.mark.parametrize("border", [0.02e-3, 0.04e-3, 0.06e-3])
def test_border_next_to_unworn_columns(border: float) -> None:
    """A parabola worn off a crown, whose crest is in the first worn columns; harmonic-mean slopes deviate by 5 nm."""
    radius = 0.02
    case = worn_case(FullCrown(crown_radius=radius), margin=0.0)
    x = LENGTH * (np.arange(20) + 0.5) / 20

    def parabola(x: FloatArray) -> FloatArray:
        return np.maximum(border - x, 0.0) ** 2 / (2 * radius)

    depth = xr.DataArray([parabola(x - 0.5 * LENGTH)], dims=("distance", "x"))
    pressure = xr.zeros_like(depth).expand_dims(y=[0.0], axis=-1)
    worn = xr.Dataset({"wear_depth": depth, "pressure": pressure}, {"distance": [1e3], "x": x})
    x = np.linspace(border - 0.1e-3, border, 201)
    drop = worn_profile(case, worn).drop(x, LENGTH)
    assert drop == pytest.approx(x**2 / (2 * radius) + parabola(x), abs=1.2e-9)


@pytest.mark.slow
def test_partly_worn_edge_radius_without_a_ridge() -> None:
    """On wide columns interpolated depths left a ridge with a pressure above that of the unworn radius."""
    case = worn_case(Cylinder(fillet_radius=0.1e-3))
    worn = wear_in(case, K, distance=[0.0, 1e4])
    worn_result = solve(worn_case(worn_profile(case, worn)), stresses=False)
    unworn_peak, worn_peak = (float(worn["pressure"].isel(distance=index).max()) for index in (0, -1))
    assert worn_peak < float(worn_result.peak_pressure) < 0.8 * unworn_peak


def test_result_at_a_single_distance(uniform) -> None:
    case = worn_case()
    x = np.linspace(-0.5, 0.5, 41) * LENGTH
    selected_profile, single_profile = worn_profile(case, uniform, 1e4), worn_profile(case, uniform.sel(distance=1e4))
    assert single_profile.drop(x, LENGTH) == pytest.approx(selected_profile.drop(x, LENGTH))
