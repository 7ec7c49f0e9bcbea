"""Measured profiles: files, interpolation, filter, and errors with the position in the file."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import pytest
import x3pio
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st

from contactstudy import InvalidInputError, Roller
from contactstudy.profiles import Cylinder, FullCrown, Lundberg, Measured
from tests.profiles.conftest import LENGTH, RADIUS

X = np.linspace(0.0, LENGTH, 201)
CROWN = FullCrown(1.25)
DROP = CROWN.drop(X - LENGTH / 2, LENGTH)


def write_csv(folder: Path, x=X, drop=DROP, header: str = "x [mm], drop [um]") -> Path:
    path = folder / "trace.csv"
    lines = [f"{1e3 * a:.9g}, {1e6 * height:.9g}" for a, height in zip(x, drop, strict=True)]
    path.write_text("\n".join(["# stylus 2 um", header, *lines]))
    return path


def write_netcdf(folder: Path, units: tuple[str, str] = ("mm", "um"), name: str = "drop", sign: float = 1.0) -> Path:
    path = folder / "trace.nc"
    dataset = xr.Dataset({name: ("x", 1e6 * sign * DROP, {"units": units[1]})}, {"x": ("x", 1e3 * X, {"units": "mm"})})
    dataset["x"].attrs["units"] = units[0]
    dataset.to_netcdf(path)
    return path


def test_profile_from_csv_and_netcdf_equals_crown(tmp_path: Path, positions: np.ndarray) -> None:
    for path in (write_csv(tmp_path), write_netcdf(tmp_path), write_netcdf(tmp_path, name="height", sign=-1.0)):
        profile = Measured.from_file(path)
        np.testing.assert_allclose(
            profile.drop(positions, LENGTH), CROWN.drop(positions, LENGTH), rtol=1e-6, atol=1e-13
        )


@pytest.mark.parametrize("separator", [",", ";", "\t"])
@pytest.mark.parametrize("brackets", ["[]", "()"])
def test_csv_file_may_have_several_separators_and_brackets(tmp_path: Path, separator: str, brackets: str) -> None:
    (left_bracket, right_bracket), path = brackets, tmp_path / "trace.txt"
    rows = [f"{row}{separator}{0.001 * row}{separator}note" for row in range(7)]
    path.write_text(
        "\n".join(
            [
                separator.join(
                    (f"X {left_bracket}mm{right_bracket}", f"Height {left_bracket}µm{right_bracket}", "remark")
                ),
                "",
                *rows,
            ]
        )
    )
    profile = Measured.from_file(path, remove_offset=True)
    np.testing.assert_allclose(profile.positions, 1e-3 * np.arange(7))
    np.testing.assert_allclose(profile.drops, 1e-9 * np.arange(6, -1, -1), atol=1e-22)


def test_tilt_and_offset_are_removed_on_request(tmp_path: Path, positions: np.ndarray) -> None:
    path = write_csv(tmp_path, drop=DROP + 3e-6 + 2e-4 * X)
    uncorrected_profile = Measured.from_file(path)
    np.testing.assert_allclose(uncorrected_profile.drops, DROP + 3e-6 + 2e-4 * X, rtol=1e-6)
    corrected_profile = Measured.from_file(path, remove_tilt=True, remove_offset=True)
    np.testing.assert_allclose(
        corrected_profile.drop(positions, LENGTH), CROWN.drop(positions, LENGTH), rtol=1e-6, atol=1e-13
    )
    profile_without_tilt = Measured.from_file(path, remove_tilt=True)
    np.testing.assert_allclose(
        np.ptp(np.subtract(profile_without_tilt.drops, corrected_profile.drops)), 0.0, atol=1e-18
    )


@given(st.lists(st.floats(0.0, 1e-6), min_size=5, max_size=40), st.floats(-0.5, 0.5))
def test_interpolation_overshoots_only_at_crests(drops: list[float], position: float) -> None:
    """The overshoot between two points is at most a quarter of the neighbouring steps."""
    values = np.array(drops)
    profile = Measured(np.linspace(0, LENGTH, len(drops)), drops, largest_spike=1.0)
    interval = min(int((position + 0.5) * (len(drops) - 1)), len(drops) - 2)
    low, high = sorted(drops[interval : interval + 2])
    steps = np.abs(np.diff(values))[max(interval - 1, 0) : interval + 2].max()
    shift = profile.drop(np.array([-LENGTH / 2]), LENGTH)[0] - drops[0]
    drop = float(profile.drop(np.array([position * LENGTH]), LENGTH)[0]) - shift
    assert low - 0.25 * steps - 1e-15 <= drop <= high + 0.25 * steps + 1e-15


def test_interpolation_of_a_parabola_is_exact() -> None:
    x = np.linspace(0.0, LENGTH, 24)
    crown = (x - 0.47 * LENGTH) ** 2
    fine_x = np.linspace(-LENGTH / 2, LENGTH / 2, 999)
    drop = Measured(x, crown).drop(fine_x, LENGTH)
    expected = (fine_x + 0.03 * LENGTH) ** 2
    np.testing.assert_allclose(drop - drop.min(), expected - expected.min(), atol=1e-16)


def test_interpolation_contains_the_points(positions: np.ndarray) -> None:
    profile = Measured(X, DROP)
    np.testing.assert_allclose(profile.drop(X - LENGTH / 2, LENGTH), DROP, rtol=1e-12, atol=1e-20)
    assert pickle.loads(pickle.dumps(profile)) == profile


def test_crown_and_measured_waviness_add_up(positions: np.ndarray) -> None:
    waviness = Measured(X, 0.1e-6 * (1 - np.cos(2 * np.pi * X / 2e-3)))
    combined_profile = Lundberg(2e-7) + waviness
    inner_positions = positions[1:-1]
    expected = Lundberg(2e-7).drop(inner_positions, LENGTH) + 0.1e-6 * (
        1 - np.cos(2 * np.pi * (inner_positions + 5e-3) / 2e-3)
    )
    np.testing.assert_allclose(combined_profile.drop(inner_positions, LENGTH), expected, atol=1.5e-10)


@pytest.mark.parametrize(
    "drop",
    [
        Cylinder(fillet_radius=0.3e-3).drop(X - LENGTH / 2, LENGTH),
        Lundberg(2e-7).drop(0.9999 * (X - LENGTH / 2), LENGTH),
        np.zeros_like(X),
        np.where(X < 4e-3, 1e-6, 0.0),
        1e-7 + 2e-8 * np.random.default_rng(0).standard_normal(X.size),
        1e-6 + 1e-6 * np.cos(2 * np.pi * X / 0.5e-3),
    ],
    ids=["fillet", "logarithmic", "straight", "step", "noise", "waves"],
)
def test_typical_profiles_have_no_outlier(drop: np.ndarray) -> None:
    Measured(X, drop)


@pytest.mark.parametrize("points", [41, 501, 2001])
def test_noise_has_no_outlier(points: int) -> None:
    x = np.linspace(0.0, LENGTH, points)
    for seed in range(30):
        drop = (x - 0.5 * LENGTH) ** 2 / 2 + 0.2e-6 * np.random.default_rng(seed).standard_normal(points)
        Measured(x, drop - drop.min())


@pytest.mark.parametrize("index", [1, 3, 100, 199])
@pytest.mark.parametrize("spike", [1e-6, 1e-5])
@pytest.mark.parametrize("noise", [0.0, 2e-8])
def test_error_contains_the_positions_of_outliers(index: int, spike: float, noise: float) -> None:
    drop = DROP + 1e-7 + noise * np.abs(np.random.default_rng(index).standard_normal(X.size))
    drop[index] += spike
    with pytest.raises(InvalidInputError, match=rf"1 outliers: \S+ m at x = {X[index]:g} m"):
        Measured(X, drop)
    Measured(X, drop, largest_spike=2 * spike)


@pytest.mark.parametrize("difference", [-0.2e-3, 0.2e-3])
def test_measured_length_must_equal_the_roller(difference: float) -> None:
    comparison = "longer" if difference < 0 else "shorter"
    with pytest.raises(InvalidInputError, match=f"0.01 m from first to last.*{comparison}"):
        Roller(radius=RADIUS, length=LENGTH + difference, profile=Measured(X, DROP))


def remove_entries(values: np.ndarray, *indices: int) -> np.ndarray:
    return np.delete(values, indices)


def replace_entry(values: np.ndarray, index: int, value: float) -> np.ndarray:
    result = values.copy()
    result[index] = value
    return result


@pytest.mark.parametrize(
    ("x", "drop", "message"),
    [
        (X[::-1], DROP, "positions = '0.00995 m at entry 2': must be increasing; 0.01 m is before it"),
        (replace_entry(X, 5, X[4]), DROP, "positions = '0.0002 m at entry 6': must be increasing; it is a duplicate"),
        (remove_entries(X, *range(60, 65)), remove_entries(DROP, *range(60, 65)), r"1 gaps: 0.00295 to 0.00325 m"),
        (X, replace_entry(DROP, 7, np.nan), "missing or not finite at x = 0.00035 m"),
        (replace_entry(X, 7, np.inf), DROP, "positions = 'inf at position 7'"),
        (X, DROP[:-1], "drops = '200 values': must be one for each of 201 positions"),
        (X, DROP - 1e-6, r"drops = '-1e-06 m at x = 0.005 m': must be not below zero; remove_offset"),
        (X, ["much"] * 201, "drops = .*numbers"),
        ("long", DROP, "positions = 'long'"),
        (X[:4], DROP[:4], "positions = '4 positions': must be at least 5"),
    ],
)
def test_invalid_points_raise(x, drop, message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        Measured(x, drop)


def test_invalid_spike_limit_raises() -> None:
    with pytest.raises(InvalidInputError, match="largest_spike = 0"):
        Measured(X, DROP, largest_spike=0)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "a file with a header and data"),
        ("x [mm], drop [um]\n0, 0\n1, high", "line 3, drop = 'high': must be a number"),
        ("x [mm], drop [um]\n0, 0\n1, 1, 1", "line 3.*must be 2 fields"),
        ("x [mm], drop [um]\n0, '0", 'line 2, drop = "\'0": must be a number with a decimal point$'),
        ("x [mm]; drop [um]\n0; 0,1,2", "line 2, drop = '0,1,2': must be a number with a decimal point or comma"),
        ("x [inch], drop [um]\n0, 0", "unit of x = 'inch': must be one of m, "),
        ("x, drop [um]\n0, 0", "unit of x = None"),
        ("x [mm], drop [deg]\n0, 0", "unit of drop = 'deg'"),
        ("s [mm], drop [um]\n0, 0", r"columns = \['s', 'drop'\]: must be x and one of drop, height"),
        ("x [mm], x [mm], drop [um]\n0, 0, 0", "columns"),
        ("x [mm], drop [um], height [um]\n0, 0, 0", "columns"),
        ("x [mm], drop [um]\n0, 0\n1,\n2, 0\n3, 0\n4, 0\n5, 0", "missing or not finite at x = 0.001 m"),
        ("x [mm], drop [um]\n0, 0\n,0\n2, 0\n3, 0\n4, 0\n5, 0", "positions = 'nan at position 1'"),
    ],
)
def test_invalid_csv_file_raises(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "trace.csv"
    path.write_text(text)
    with pytest.raises(InvalidInputError, match=message):
        Measured.from_file(path)


def test_invalid_netcdf_file_raises(tmp_path: Path) -> None:
    with pytest.raises(InvalidInputError, match="unit of x = 'deg'"):
        Measured.from_file(write_netcdf(tmp_path, units=("deg", "um")))
    with pytest.raises(InvalidInputError, match="a file with drop or height along x"):
        Measured.from_file(write_netcdf(tmp_path, name="depth"))
    broken_path = tmp_path / "broken.nc"
    broken_path.write_text("no netCDF")
    with pytest.raises(InvalidInputError, match="a netCDF file that can be read"):
        Measured.from_file(broken_path)


@pytest.mark.parametrize("name", ["missing.csv", "missing.nc"])
def test_missing_file_raises(tmp_path: Path, name: str) -> None:
    with pytest.raises(InvalidInputError, match=f"path = .*{name}"):
        Measured.from_file(tmp_path / name)


NOISE = 0.05e-6 * np.random.default_rng(0).standard_normal(X.size)
NOISY = DROP + NOISE - (DROP + NOISE).min()


def test_filter_preserves_the_crown_and_reduces_noise() -> None:
    unfiltered_profile, filtered_profile = Measured(X, NOISY), Measured(X, NOISY, cutoff=0.8e-3)
    errors = [profile.drop(X - LENGTH / 2, LENGTH) - DROP for profile in (unfiltered_profile, filtered_profile)]
    assert np.std(errors[0]) == pytest.approx(0.05e-6, rel=0.2)
    assert np.std(errors[1]) < 0.4 * np.std(errors[0])
    assert 0.0 <= filtered_profile.drop(X - LENGTH / 2, LENGTH).min() < 1e-10
    assert "Gaussian filter with cut-off 0.8 mm" in repr(filtered_profile)
    assert "filter" not in repr(unfiltered_profile)
    assert pickle.loads(pickle.dumps(filtered_profile)) == filtered_profile != unfiltered_profile


def test_filter_of_a_file_equals_filter_of_points(tmp_path: Path) -> None:
    path = write_csv(tmp_path, drop=DROP + NOISE + 2e-6)
    file_profile = Measured.from_file(path, remove_offset=True, cutoff=0.8e-3)
    assert file_profile.cutoff == 0.8e-3
    np.testing.assert_allclose(
        file_profile.drop(X - LENGTH / 2, LENGTH),
        Measured(X, NOISY, cutoff=0.8e-3).drop(X - LENGTH / 2, LENGTH),
        rtol=1e-5,
        atol=1e-13,
    )


@pytest.mark.parametrize("cutoff", [0.0, -1e-3, 0.2e-3, 11e-3, 0.8, "0.8 mm", np.nan])
def test_invalid_cutoff_raises(cutoff: object) -> None:
    with pytest.raises(InvalidInputError, match="cutoff = "):
        Measured(X, DROP, cutoff=cutoff)


def test_outlier_check_precedes_the_filter() -> None:
    drop = DROP + 1e-6
    drop[100] += 5e-6
    with pytest.raises(InvalidInputError, match="1 outliers"):
        Measured(X, drop, cutoff=0.8e-3)


def test_profile_from_line_and_map_of_instrument_equals_crown(tmp_path: Path, positions: np.ndarray) -> None:
    """The heights are lower at end II, so that both directions differ."""
    line = -DROP - 4e-4 * np.maximum(X - 0.5 * LENGTH, 0.0)
    y = np.linspace(0.0, 0.3e-3, 16)
    heights = line[:, None] - (y - 0.13e-3) ** 2 / (2 * RADIUS)
    x3pio.Profile.from_array(line, x_scale=X[1]).save(tmp_path / "line.x3p")
    x3pio.write(tmp_path / "map.x3p", heights.T, x_scale=X[1], y_scale=y[1])
    x3pio.write(tmp_path / "other.x3p", heights, x_scale=y[1], y_scale=X[1])
    for name, turn, x_sign in (("line", 0, 1), ("line", 180, -1), ("map", 0, 1), ("map", 180, -1), ("other", 270, 1)):
        profile = Measured.from_file(tmp_path / f"{name}.x3p", remove_offset=True, turn=turn)
        expected = CROWN.drop(positions, LENGTH) + 4e-4 * np.maximum(x_sign * positions, 0.0)
        np.testing.assert_allclose(profile.drop(positions, LENGTH), expected, rtol=1e-6, atol=1e-12)
    assert np.ptp(Measured.from_file(tmp_path / "other.x3p", remove_offset=True).positions) == pytest.approx(0.3e-3)


def test_rotation_exchanges_the_ends_of_columns(tmp_path: Path) -> None:
    path = write_csv(tmp_path, drop=DROP + 2e-4 * X)
    rotated_profile = Measured.from_file(path, turn=180)
    np.testing.assert_allclose(rotated_profile.drops, (DROP + 2e-4 * X)[::-1], rtol=1e-6)
    with pytest.raises(InvalidInputError, match="turn = 90: must be one of 0, 180"):
        Measured.from_file(path, turn=90)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("0, 0\n1, 1", r"such as: x \[mm\], drop \[um\]"),
        ("", r"a header such as: x \[mm\]"),
        ("x, drop\n0, 0", r"such as x \[mm\]"),
    ],
)
def test_error_contains_an_example_header(tmp_path: Path, text: str, message: str) -> None:
    (tmp_path / "trace.csv").write_text(text)
    with pytest.raises(InvalidInputError, match=message):
        Measured.from_file(tmp_path / "trace.csv")
