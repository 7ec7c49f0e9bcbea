"""Height maps: statistics, files, and invalid files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import x3pio
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st

from contactstudy import Grid, InvalidInputError
from contactstudy.roughness import read_height_map, self_affine

GRID = Grid(x_range=(0.0, 1e-3), y_range=(-0.2e-3, 0.2e-3), cells_x=250, cells_y=100)
SURFACE_PARAMETERS = {"rms_height": 0.2e-6, "hurst": 0.8, "longest": 0.4e-3, "shortest": 20e-6, "seed": 1}


def compute_spectrum(height: xr.DataArray, grid: Grid) -> tuple[np.ndarray, np.ndarray]:
    """Wavenumber divided by 2 pi and power of each wave, from the complex Fourier transform."""
    x, y = np.fft.fftfreq(grid.cells_x, grid.dx), np.fft.fftfreq(grid.cells_y, grid.dy)
    return np.hypot(x[:, None], y), np.abs(np.fft.fft2(height.values)) ** 2


@given(rms=st.floats(1e-9, 1e-5), hurst=st.floats(0.0, 1.0), seed=st.integers(0, 10**6))
def test_self_affine_height_has_requested_spectrum(rms: float, hurst: float, seed: int) -> None:
    height = self_affine(GRID, **SURFACE_PARAMETERS | {"rms_height": rms, "hurst": hurst, "seed": seed})
    assert float(np.sqrt((height**2).mean())) == pytest.approx(rms, rel=1e-12)
    assert abs(float(height.mean())) < 1e-10 * rms
    wavenumber, power = compute_spectrum(height, GRID)
    outside_band = (wavenumber < 1 / 0.41e-3) | (wavenumber > 1 / 19.9e-6)
    assert power[outside_band].max() < 1e-20 * power.max()


@pytest.mark.parametrize("hurst", [0.3, 0.8, 1.0])
def test_spectrum_falls_with_the_hurst_exponent(hurst: float) -> None:
    grid = Grid(x_range=(0.0, 1.0), y_range=(0.0, 2.0), cells_x=256, cells_y=512)
    height = self_affine(grid, rms_height=1.0, hurst=hurst, longest=0.5, shortest=0.02, seed=3)
    wavenumber, power = compute_spectrum(height, grid)
    in_band = (wavenumber > 2.0) & (wavenumber < 50.0)
    slope = np.polyfit(np.log(wavenumber[in_band]), np.log(power[in_band]), 1)[0]
    assert slope == pytest.approx(-2 * (1 + hurst), abs=0.1)


def test_surface_is_isotropic_and_gaussian() -> None:
    grid = Grid(x_range=(0.0, 1.0), y_range=(0.0, 1.0), cells_x=512, cells_y=512)
    height = self_affine(grid, rms_height=1.0, hurst=0.8, longest=0.1, shortest=0.01, seed=5).values
    slopes = [np.mean(np.diff(height, axis=axis) ** 2) for axis in (0, 1)]
    assert slopes[0] == pytest.approx(slopes[1], rel=0.05)
    assert np.mean(height**4) == pytest.approx(3.0, abs=0.2)


def test_seed_determines_surface() -> None:
    first_surface, second_surface = (self_affine(GRID, **SURFACE_PARAMETERS) for _ in range(2))
    np.testing.assert_array_equal(first_surface, second_surface)
    assert np.abs(first_surface - self_affine(GRID, **SURFACE_PARAMETERS | {"seed": 2})).max() > 1e-7


def test_surface_of_zero_rms_is_smooth() -> None:
    assert not self_affine(GRID, **SURFACE_PARAMETERS | {"rms_height": 0.0}).any()


def test_stored_height_map_equals_original(tmp_path: Path) -> None:
    height = self_affine(GRID, **SURFACE_PARAMETERS)
    assert height.attrs["units"] == "m"
    assert "seed=1" in height.attrs["source"]
    assert {height[axis].attrs["units"] for axis in "xy"} == {"m"}
    height.to_netcdf(tmp_path / "map.nc")
    np.testing.assert_allclose(read_height_map(tmp_path / "map.nc", GRID), height, atol=1e-18)


def compute_tilted_plane(x, y):
    return 1e-6 + 2e-3 * x - 5e-3 * y


X, Y = 1e-3 * np.arange(0, 11) / 10, 1e-3 * np.arange(-5, 6) / 10


def write_csv_map(
    path: Path, omitted_rows: tuple[int, ...] = (), appended: str = "", header: str = "x [mm], y [mm], height [um]"
) -> Path:
    rows = [f"{1e3 * x:.9g}, {1e3 * y:.9g}, {1e6 * compute_tilted_plane(x, y):.9g}" for x in X for y in Y]
    path.write_text(
        "\n".join([header, *(row for index, row in enumerate(rows) if index not in omitted_rows)]) + appended
    )
    return path


def test_csv_map_is_interpolated(tmp_path: Path) -> None:
    height = read_height_map(write_csv_map(tmp_path / "map.csv"), GRID)
    np.testing.assert_allclose(height, compute_tilted_plane(GRID.x[:, None], GRID.y[None, :]), atol=1e-14)
    assert height.attrs["source"] == "measured, map.csv"


def test_netcdf_map_may_have_any_order_of_dimensions(tmp_path: Path) -> None:
    values = xr.DataArray(
        1e9 * compute_tilted_plane(X, Y[:, None]),
        {"y": 1e6 * Y, "x": X},
        ("y", "x"),
        name="height",
        attrs={"units": "nm"},
    )
    values["x"].attrs["units"] = "m"
    values["y"].attrs["units"] = "um"
    values.to_netcdf(tmp_path / "map.nc")
    height = read_height_map(tmp_path / "map.nc", GRID)
    np.testing.assert_allclose(height, compute_tilted_plane(GRID.x[:, None], GRID.y[None, :]), atol=1e-14)


def test_remove_slope_removes_plane(tmp_path: Path) -> None:
    height = read_height_map(write_csv_map(tmp_path / "map.csv"), GRID, remove_slope=True)
    assert float(np.abs(height).max()) < 1e-14


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"rms_height": -1e-6}, "rms_height = -1e-06"),
        ({"hurst": 1.5}, "hurst = 1.5: must be between 0 and 1"),
        ({"hurst": np.nan}, "hurst = nan"),
        ({"shortest": 5e-6}, "shortest = 5e-06: must be at least two cells, 8e-06 m"),
        ({"longest": 2e-3}, "longest = 0.002: must be between shortest and the grid's larger side, 0.001 m"),
        ({"longest": 10e-6}, "longest = 1e-05"),
        ({"longest": 0.49e-3, "shortest": 0.45e-3}, "longest, shortest = .*at least one wave"),
        ({"seed": -1}, "seed = -1"),
        ({"seed": None}, "seed = None"),
    ],
)
def test_invalid_surface_parameter_raises(changes, message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        self_affine(GRID, **SURFACE_PARAMETERS | changes)


def test_missing_grid_raises(tmp_path: Path) -> None:
    with pytest.raises(InvalidInputError, match="grid = 'fine'"):
        self_affine("fine", **SURFACE_PARAMETERS)
    with pytest.raises(InvalidInputError, match="grid = None"):
        read_height_map(write_csv_map(tmp_path / "map.csv"), None)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"omitted_rows": (3,)}, "height = 'missing or not finite at x = 0 m, y = -0.0002 m'"),
        ({"omitted_rows": tuple(range(11 * 4, 11 * 8))}, "x = '1 gaps: 0.0003 to 0.0008 m'"),
        ({"appended": "\n0, 0, 7"}, "height = '2 values at x = 0 m, y = 0 m'"),
        ({"appended": "\n0, , 7"}, "y = 'nan at position"),
        ({"header": "x [mm], y [mm], height [kg]"}, "unit of height = 'kg'"),
        ({"header": "x [mm], y, height [um]"}, "unit of y = None"),
        ({"header": "x [mm], z [mm], height [um]"}, "columns"),
        ({"header": "x [um], y [mm], height [um]"}, "grid.x = '2e-06 to 0.000998 m': must be within the measured"),
    ],
)
def test_invalid_csv_map_raises(tmp_path: Path, changes, message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        read_height_map(write_csv_map(tmp_path / "map.csv", **changes), GRID)


def test_invalid_netcdf_map_raises(tmp_path: Path) -> None:
    xr.Dataset({"height": ("x", X, {"units": "m"})}, {"x": ("x", X, {"units": "m"})}).to_netcdf(tmp_path / "line.nc")
    with pytest.raises(InvalidInputError, match="height along x and y"):
        read_height_map(tmp_path / "line.nc", GRID)
    xr.Dataset({"height": (("x", "y"), np.zeros((11, 11)))}, {"x": X, "y": Y}).to_netcdf(tmp_path / "units.nc")
    with pytest.raises(InvalidInputError, match="unit of x = None"):
        read_height_map(tmp_path / "units.nc", GRID)
    with pytest.raises(InvalidInputError, match="a netCDF file that can be read"):
        read_height_map(tmp_path / "missing.nc", GRID)
    with pytest.raises(InvalidInputError, match="remove_slope = 'yes'"):
        read_height_map(tmp_path / "units.nc", GRID, remove_slope="yes")


def test_instrument_map_is_placed_and_form_removed(tmp_path: Path) -> None:
    x, y = 2e-6 * np.arange(501), 5e-6 * np.arange(201)
    waves = 1e-7 * np.sin(2 * np.pi * x / 0.1e-3)[:, None] * np.cos(2 * np.pi * y / 0.2e-3)
    surface_form = 1e-6 + 3e-3 * x[:, None] - 1e-3 * y - (y - 0.6e-3) ** 2 / 0.012 + 0.4 * x[:, None] * y
    x3pio.write(tmp_path / "map.x3p", (waves + surface_form).T, x_scale=2e-6, y_scale=5e-6)
    corner = (GRID.x_range[0], GRID.y_range[0])
    height_map = read_height_map(tmp_path / "map.x3p", GRID, corner=corner, remove_form=True)
    expected = np.sin(2 * np.pi * GRID.x / 0.1e-3)[:, None] * np.cos(2 * np.pi * (GRID.y - corner[1]) / 0.2e-3)
    np.testing.assert_allclose(height_map, 1e-7 * expected, atol=3e-9)
    map_without_slope = read_height_map(tmp_path / "map.x3p", GRID, corner=corner, remove_slope=True)
    assert float(map_without_slope.max() - map_without_slope.min()) > 10 * float(height_map.max() - height_map.min())
    restored_map = read_height_map(tmp_path / "map.x3p", GRID, corner=corner, turn=180, mirror=True, remove_form=True)
    np.testing.assert_allclose(restored_map.values[::-1], height_map.values, atol=3e-9)


def test_invalid_instrument_map_raises(tmp_path: Path) -> None:
    x3pio.Profile.from_array(np.zeros(9), x_scale=1e-6).save(tmp_path / "line.x3p")
    with pytest.raises(InvalidInputError, match="it holds one line"):
        read_height_map(tmp_path / "line.x3p", GRID)
    x3pio.write(tmp_path / "map.x3p", np.zeros((9, 9)), x_scale=1e-6, y_scale=1e-6)
    with pytest.raises(InvalidInputError, match=r"corner = 0.0: must be two positions"):
        read_height_map(tmp_path / "map.x3p", GRID, corner=0.0)
    with pytest.raises(InvalidInputError, match=r"grid.x = .*within the measured"):
        read_height_map(tmp_path / "map.x3p", GRID)
