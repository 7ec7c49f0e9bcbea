"""Maps of the top: pressure, stick and slip, tractions, temperature."""

from __future__ import annotations

import functools

import numpy as np
import pytest
import xarray as xr
from matplotlib import pyplot

from contactstudy import (
    Case,
    FiniteLengthSpace,
    InvalidInputError,
    Material,
    Roller,
    Rolling,
    choose_grid,
    plots,
    solve,
)


@functools.cache
def solve_rolling_case() -> xr.Dataset:
    """Equal bodies with common ends, under longitudinal and lateral creepage."""
    steel = Material(210e9, 0.3)
    case = Case(
        body=FiniteLengthSpace(length=0.5e-3, material=steel),
        roller=Roller(radius=5e-3, length=0.5e-3, material=steel),
        max_pressure=1.5e9,
        friction=0.1,
        motion=Rolling(longitudinal_creepage=8e-4, lateral_creepage=3e-4),
    )
    return solve(case, choose_grid(case, cells_x=4, cells_y=16), stresses=False)


def test_stick_and_slip_areas_match_case(assert_nothing_clipped) -> None:
    result = solve_rolling_case()
    ax = plots.plot_stick_and_slip(result)
    mesh = ax.collections[0]
    is_slipping = np.asarray(mesh.get_array()).reshape(result["pressure"].transpose("y", "x").shape)
    in_contact = result["pressure"].transpose("y", "x").values > 0
    assert float(is_slipping[in_contact].sum()) == int(in_contact.sum()) - int(result["stick"].sum())
    assert mesh.get_clip_path() is not None  # the contact's border clips the mesh
    assert_nothing_clipped(ax.figure)


def test_contact_border_is_drawn_at_half_width() -> None:
    steel = Material(210e9, 0.3)
    case = Case(
        body=FiniteLengthSpace(length=1.4e-3, material=steel),
        roller=Roller(radius=5e-3, length=0.4e-3),
        end_distance=0.5e-3,
        max_pressure=1e9,
    )
    result = solve(case, stresses=False, accuracy=0.05)
    ax = plots.plot_pressure_map(result, si=True)
    border = ax.collections[1].get_paths()[0]
    in_contact = result.pressure.sel(x=0.7e-3, method="nearest") > 0
    half_width = 0.5e3 * float(np.ptp(result.y.values[in_contact.values]))
    assert border.contains_points([[0.7, 0.9 * half_width], [0.7, -0.9 * half_width]]).all()
    assert not border.contains_point([0.7, 1.1 * half_width])


def test_arrows_follow_local_tractions() -> None:
    result = solve_rolling_case()
    ax = plots.plot_stick_and_slip(result, arrows=12)
    (arrows,) = (artist for artist in ax.collections if hasattr(artist, "U"))
    a, p0 = float(result["hertz_half_width"]), float(result["hertz_max_pressure"])
    for (x, y), u, v in list(zip(arrows.get_offsets(), arrows.U, arrows.V, strict=True))[::5]:
        contact_at_arrow = result.sel(x=x * a, y=y * a, method="nearest")
        assert [u, v] == pytest.approx(
            [float(contact_at_arrow["traction_x"]) / p0, float(contact_at_arrow["traction_y"]) / p0]
        )
        assert float(contact_at_arrow["pressure"]) > 0
    assert 40 < len(arrows.U) <= 72


def test_map_of_long_contact_has_usable_height(assert_nothing_clipped) -> None:
    result = solve_rolling_case()
    ax = plots.plot_stick_and_slip(result.assign_coords(x=40 * result["x"]))
    box = ax.get_window_extent()
    assert box.height > 0.4 * box.width
    assert_nothing_clipped(ax.figure)


def test_si_map_has_mm_and_mpa() -> None:
    ax = plots.plot_stick_and_slip(solve_rolling_case(), si=True)
    assert "mm" in ax.get_xlabel()
    assert any("MPa" in artist.text.get_text() for artist in ax.artists)


def test_traction_map_contains_magnitude_and_stick_border(assert_nothing_clipped) -> None:
    result = solve_rolling_case()
    ax = plots.plot_traction_map(result, si=True)
    mesh, stick, contact = ax.collections
    max_traction = np.hypot(result["traction_x"], result["traction_y"]).where(result["pressure"] > 0, 0.0).max()
    assert float(mesh.get_array().max()) == pytest.approx(float(max_traction) / 1e6)
    # The border of the stick area encloses the cells that stick.
    cells = np.argwhere(result["stick"].transpose("x", "y").values.astype(bool))
    centres = np.column_stack([result["x"].values[cells[:, 0]], result["y"].values[cells[:, 1]]]) * 1e3
    assert stick.get_paths()[0].contains_points(centres).mean() > 0.95
    assert len(contact.get_paths()[0].vertices) > 0
    assert_nothing_clipped(ax.figure)
    slip = plots.plot_traction_map(result, variable="slip")
    assert slip.figure.axes[-1].get_ylabel() == "slip per distance rolled"
    shift_result = result.assign({name: result[name].assign_attrs(units="m") for name in ("slip_x", "slip_y")})
    assert "mm" in plots.plot_traction_map(shift_result, variable="slip").figure.axes[-1].get_ylabel()
    with pytest.raises(InvalidInputError, match="heat"):
        plots.plot_traction_map(result, variable="heat")
    with pytest.raises(InvalidInputError, match="stick"):
        plots.plot_traction_map(result.drop_vars("stick"))


def test_invalid_traction_map_raises() -> None:
    with pytest.raises(InvalidInputError, match="stick is missing"):
        plots.plot_stick_and_slip(solve_rolling_case().drop_vars("stick"))
    with pytest.raises(InvalidInputError, match="arrows = 0"):
        plots.plot_stick_and_slip(solve_rolling_case(), arrows=0)


def test_pressure_map_contains_every_cell(case_result, assert_nothing_clipped):
    ax = plots.plot_pressure_map(case_result)
    mesh_values = ax.collections[0].get_array()
    assert np.asarray(mesh_values).max() == pytest.approx(float(case_result["pressure"].max()) / 1.5e9)
    assert np.asarray(mesh_values).size == case_result["pressure"].size
    assert "x/a" in ax.get_xlabel()
    assert "y/a" in ax.get_ylabel()
    assert_nothing_clipped(ax.figure)


@pytest.mark.parametrize("draw", [plots.plot_pressure_map])
def test_pressure_map_uses_given_axes(study_case, draw):
    ax = pyplot.figure().add_subplot()
    assert draw(study_case, ax) is ax


@pytest.mark.parametrize("draw", [plots.plot_pressure_map])
def test_invalid_result_raises(study_dataset, study_case, draw):
    with pytest.raises(InvalidInputError, match="single case"):
        draw(study_dataset)
    with pytest.raises(InvalidInputError, match="level"):
        draw(study_case.drop_vars("pressure"))


@pytest.fixture(scope="module")
def heated_result(case_result):
    rise = 1e-8 * case_result["pressure"].copy()
    return case_result.assign(temperature_rise=rise, frictional_heat=case_result["pressure"])


def test_temperature_map_marks_maximum(heated_result, assert_nothing_clipped):
    ax = plots.plot_temperature_map(heated_result)
    assert np.asarray(ax.collections[0].get_array()).max() == pytest.approx(float(heated_result.temperature_rise.max()))
    hottest_cell = heated_result.temperature_rise.where(
        heated_result.temperature_rise == heated_result.temperature_rise.max(), drop=True
    )
    assert ax.lines[0].get_xdata()[0] == pytest.approx(float(hottest_cell.x[0] / heated_result.hertz_half_width))
    assert "x/a" in ax.get_xlabel()
    assert_nothing_clipped(ax.figure)


def test_surface_without_temperature_raises(heated_result):
    with pytest.raises(InvalidInputError, match="roller_temperature_rise"):
        plots.plot_temperature_map(heated_result, surface="roller")
    with pytest.raises(InvalidInputError, match="surface"):
        plots.plot_temperature_map(heated_result, surface="ball")
