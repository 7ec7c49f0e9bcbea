"""Worn profiles on other cells than they wore on: the pressure stays, at sharp ends too."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from contactstudy import Case, FiniteLengthSpace, Grid, Material, Roller, choose_grid, fatigue, solve
from contactstudy.profiles import Cylinder
from contactstudy.wear import wear_in, worn_profile

STEEL = Material(210e9, 0.3)
K = 1e-17
LENGTH, BESIDE = 0.4e-3, 0.1e-3
"""Of the roller, and of the body beyond either of its ends."""


def pressed(profile=None, *, beside: float = BESIDE) -> Case:
    body = FiniteLengthSpace(length=LENGTH + 2 * beside, material=STEEL)
    roller = Roller(radius=5e-3, length=LENGTH, **({} if profile is None else {"profile": profile}))
    return Case(body=body, roller=roller, max_pressure=1.5e9)


def equal_columns(count: int, cells_y: int = 48) -> Grid:
    """Columns of one width under the roller, and wider ones beside it."""
    beside = np.linspace(0.0, BESIDE, 6)
    edges = np.concatenate([beside[:-1], np.linspace(BESIDE, BESIDE + LENGTH, count + 1), BESIDE + LENGTH + beside[1:]])
    reach = 2.6 * pressed().hertz_half_width
    return Grid.from_edges(edges, (-reach, reach), cells_y)


@pytest.fixture(scope="module")
def settled() -> xr.Dataset:
    """Wear on columns that settle the pressure at the ends, a thousandth of a half-width wide there."""
    return wear_in(pressed(), K, distance=[0.0, 2e4, 2e5], tolerance=0.03)


@pytest.fixture(scope="module")
def coarse() -> xr.Dataset:
    """The same wear on columns of 5 um."""
    return wear_in(pressed(), K, distance=[0.0, 2e4, 2e5], grid=equal_columns(80), tolerance=0.03)


@pytest.mark.slow
def test_columns_of_the_unworn_contact(settled) -> None:
    unworn = solve(pressed(), stresses=False)
    assert settled.x.values == pytest.approx(unworn.x.values)
    assert "x_width" in settled.coords
    assert settled.line_load.values[0].max() > 2 * settled.line_load.values[1].max()
    assert float(settled.volume_error) < 1e-12


def on_top(profile, **options: object) -> xr.DataArray:
    """Largest pressure of each column under a profile over p0, over the distance from the roller's end (metres)."""
    found = solve(pressed(profile), stresses=False, **options)["pressure"].max("y") / 1.5e9
    under = found.where(found > 0, drop=True)
    return under.assign_coords(x=under["x"] - BESIDE).sel(x=slice(0, LENGTH / 2))


@pytest.mark.slow
@pytest.mark.parametrize("at", [1, 2])
def test_pressure_on_finer_columns(settled, coarse, at: int) -> None:
    """Columns of 5 um do not resolve the last micrometres; the profile continues to the end."""
    found = on_top(worn_profile(pressed(), coarse, float(settled["distance"][at])))
    wore = settled["pressure"].isel(distance=at).max("y") / 1.5e9
    expected = wore.assign_coords(x=wore["x"] - BESIDE).interp(x=found["x"])
    beside = found["x"] > 0.15e-6
    assert np.abs(found / expected - 1).where(beside).max() < 0.08
    assert np.abs(found / expected - 1).where(found["x"] > 2e-6).max() < 0.04
    assert float(found.max()) < 2 * float(expected.max())


@pytest.mark.slow
def test_pressure_on_halved_columns(settled) -> None:
    """Columns cut in halves carry what the whole ones do; at the end the pressure is not singular."""
    edges = np.append(settled["x_bounds"].values[:, 0], settled["x_bounds"].values[-1, 1])
    halved = np.sort(np.concatenate([edges, 0.5 * (edges[1:] + edges[:-1])]))
    cells = Grid.from_edges(halved, (float(settled["y"][0]), float(settled["y"][-1])), settled.sizes["y"])
    found = on_top(worn_profile(pressed(), settled), grid=cells)
    wore = settled["pressure"].isel(distance=-1).max("y") / 1.5e9
    expected = wore.assign_coords(x=wore["x"] - BESIDE).interp(x=found["x"])
    assert np.abs(found / expected - 1).where(found["x"] > 0.5e-6).max() < 0.02
    assert float(found.max()) < 1.3 * float(wore.max())


@pytest.mark.slow
def test_shakedown_limit_beside_the_end(settled, coarse) -> None:
    a = pressed().hertz_half_width
    x = BESIDE + a * np.array([0.0, 0.02, 0.05, 0.1, 0.2])
    at = {"x": x, "y": a * np.linspace(-2, 2, 25), "z": a * np.array([0.03, 0.1, 0.3, 0.6])}
    needed = [
        float(fatigue.shakedown(solve(pressed(worn_profile(pressed(), worn)), **at))["shakedown_stress"].max())
        for worn in (coarse, settled)
    ]
    assert needed[0] == pytest.approx(needed[1], rel=0.05)


@pytest.fixture(scope="module")
def uniform() -> xr.Dataset:
    """Wear on few uniform cells."""
    return wear_in(pressed(), K, distance=[0.0, 1e4, 2e4], grid=choose_grid(pressed(), cells_x=2, cells_y=6))


def test_unworn_profile(uniform) -> None:
    profile = worn_profile(pressed(), uniform, 0.0)
    assert profile.drop(0.5 * LENGTH * np.linspace(-1, 1, 101), LENGTH).max() == 0.0


def test_slope_at_a_flush_end() -> None:
    """A free end at the roller's own: the body does not go on beyond it, and nothing steepens towards it."""
    case = pressed(beside=0.0)
    reach = 2.6 * case.hertz_half_width
    edges = np.linspace(0, LENGTH, 41)
    worn = wear_in(case, K, distance=[0.0, 2e5], grid=Grid.from_edges(edges, (-reach, reach), 32))
    profile = worn_profile(case, worn)
    s = 1e-6 * np.array([0.0, 1.0, 2.0, 4.0])
    slopes = np.diff(profile.drop(s - 0.5 * LENGTH, LENGTH)) / np.diff(s)
    assert np.ptp(slopes) < 0.3 * np.abs(slopes).max()


def test_overhanging_roller_without_a_ridge() -> None:
    body = FiniteLengthSpace(length=0.3e-3, material=STEEL)
    case = Case(body=body, roller=Roller(radius=5e-3, length=LENGTH), max_pressure=1.5e9, end_distance=-0.05e-3)
    reach = 2.6 * case.hertz_half_width
    worn = wear_in(case, K, distance=[0.0, 2e4], grid=Grid.from_edges(np.linspace(0, 0.3e-3, 31), (-reach, reach), 32))
    profile = worn_profile(case, worn)
    depth = worn["wear_depth"].values[-1]
    ends = profile.drop(np.array([-0.15e-3, 0.15e-3]), LENGTH)
    assert ends == pytest.approx(depth[[0, -1]], rel=0.05)


@pytest.mark.slow
def test_partly_worn_edge_radius_without_a_ridge() -> None:
    """There the columns are wide: interpolated depths left a ridge that was pressed higher than the unworn radius."""
    case = pressed(Cylinder(fillet_radius=0.1e-3))
    worn = wear_in(case, K, distance=[0.0, 1e4])
    again = solve(pressed(worn_profile(case, worn)), stresses=False)
    unworn, own = (float(worn["pressure"].isel(distance=at).max()) for at in (0, -1))
    assert own < float(again.peak_pressure) < 0.8 * unworn


def test_result_at_one_distance(uniform) -> None:
    case = pressed()
    x = np.linspace(-0.5, 0.5, 41) * LENGTH
    chosen, alone = worn_profile(case, uniform, 1e4), worn_profile(case, uniform.sel(distance=1e4))
    assert alone.drop(x, LENGTH) == pytest.approx(chosen.drop(x, LENGTH))
