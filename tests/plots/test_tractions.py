"""Figures of stick and slip, of a case solved once."""

from __future__ import annotations

import functools

import numpy as np
import pytest
import xarray as xr

from contactstudy import Case, FiniteLengthSpace, InvalidInputError, Material, Roller, Rolling, plots, solve


@functools.cache
def rolled() -> xr.Dataset:
    """Equal bodies that end together, creeping along and across."""
    steel = Material(210e9, 0.3)
    case = Case(
        body=FiniteLengthSpace(length=0.5e-3, material=steel),
        roller=Roller(radius=5e-3, length=0.5e-3, material=steel),
        max_pressure=1.5e9,
        friction=0.1,
        motion=Rolling(longitudinal_creepage=8e-4, lateral_creepage=3e-4),
    )
    return solve(case, stresses=False, accuracy=0.05)


def study() -> xr.Dataset:
    """Forces over a creepage and a distance."""
    swept = {"longitudinal_creepage": [0.0, 1e-3, 2e-3], "e_over_a": [0.0, 2.0]}
    force = xr.DataArray([[0.0, 0.0], [0.05, 0.06], [0.09, np.nan]], coords=swept, dims=tuple(swept))
    return xr.Dataset({"force_y": force, "force_x": force, "normal_load": xr.ones_like(force)}, {"friction": 0.1})


def test_areas_are_those_of_the_case(assert_nothing_clipped) -> None:
    one = rolled()
    ax = plots.plot_stick_and_slip(one)
    area = np.ma.masked_invalid(ax.collections[0].get_array())
    pressed = one["pressure"].values > 0
    assert int((~np.ma.getmaskarray(area)).sum()) == int(pressed.sum())
    assert float(area.sum()) == int(pressed.sum()) - int(one["stick"].sum())
    assert_nothing_clipped(ax.figure)


def test_arrows_point_along_the_tractions_where_they_stand() -> None:
    one = rolled()
    ax = plots.plot_stick_and_slip(one, arrows=12)
    arrows = ax.collections[1]
    a, p0 = float(one["hertz_half_width"]), float(one["hertz_max_pressure"])
    for (x, y), u, v in list(zip(arrows.get_offsets(), arrows.U, arrows.V, strict=True))[::5]:
        here = one.sel(x=x * a, y=y * a, method="nearest")
        assert [u, v] == pytest.approx([float(here["traction_x"]) / p0, float(here["traction_y"]) / p0])
        assert float(here["pressure"]) > 0
    assert 40 < len(arrows.U) <= 144


def test_si_is_mm_and_mpa() -> None:
    ax = plots.plot_stick_and_slip(rolled(), si=True)
    assert "mm" in ax.get_xlabel()
    assert any("MPa" in artist.text.get_text() for artist in ax.artists)


def test_curve_is_over_full_sliding(assert_nothing_clipped) -> None:
    ax = plots.plot_traction_curve(study(), "e_over_a")
    first, second, full = ax.lines
    assert first.get_ydata() == pytest.approx([0.0, 0.5, 0.9])
    assert second.get_ydata() == pytest.approx([0.0, 0.6])
    assert list(full.get_ydata()) == [1.0, 1.0]
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["0", "2"]
    assert_nothing_clipped(ax.figure)
    assert len(plots.plot_traction_curve(study(), selection={"e_over_a": 2.0}).lines) == 2


def test_bad_input() -> None:
    with pytest.raises(InvalidInputError, match="stick is missing"):
        plots.plot_stick_and_slip(rolled().drop_vars("stick"))
    with pytest.raises(InvalidInputError, match="arrows = 0"):
        plots.plot_stick_and_slip(rolled(), arrows=0)
    with pytest.raises(InvalidInputError, match="selection"):
        plots.plot_traction_curve(study())
    with pytest.raises(InvalidInputError, match="hue = 'friction'"):
        plots.plot_traction_curve(study(), "friction")
    with pytest.raises(InvalidInputError, match="over lateral_creepage"):
        plots.plot_traction_curve(study(), creepage="lateral_creepage")
    with pytest.raises(InvalidInputError, match="creepage = 'spin'"):
        plots.plot_traction_curve(study(), creepage="spin")


def test_maps_show_the_size_and_the_border_of_the_area_that_sticks(assert_nothing_clipped) -> None:
    one = rolled()
    ax = plots.plot_traction_map(one, si=True)
    mesh, contact, stick = ax.collections
    largest = np.hypot(one["traction_x"], one["traction_y"]).where(one["pressure"] > 0, 0.0).max()
    assert float(mesh.get_array().max()) == pytest.approx(float(largest) / 1e6)
    assert int((~np.ma.getmaskarray(mesh.get_array())).sum()) == int((one["pressure"] > 0).sum())
    # Up each row of cells the border is crossed where the flag changes.
    flags = np.pad(one["stick"].transpose("x", "y").values.astype(int), ((0, 0), (1, 1)))
    lying = [piece for piece in stick.get_segments() if piece[0, 1] == piece[1, 1]]
    assert len(lying) == int(np.abs(np.diff(flags, axis=1)).sum())
    assert len(contact.get_segments()) > 0
    assert_nothing_clipped(ax.figure)
    slip = plots.plot_traction_map(one, variable="slip")
    assert slip.figure.axes[-1].get_ylabel() == "slip per distance rolled"
    shifted = one.assign({name: one[name].assign_attrs(units="m") for name in ("slip_x", "slip_y")})
    assert "mm" in plots.plot_traction_map(shifted, variable="slip").figure.axes[-1].get_ylabel()
    with pytest.raises(InvalidInputError, match="heat"):
        plots.plot_traction_map(one, variable="heat")
    with pytest.raises(InvalidInputError, match="stick"):
        plots.plot_traction_map(one.drop_vars("stick"))
