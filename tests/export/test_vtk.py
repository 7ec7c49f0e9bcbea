"""Fields as VTK, read back by an independent reader."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from contactstudy import InvalidInputError, export, tresca
from contactstudy.analysis import normalized
from contactstudy.arrays.variables import STRESSES
from tests.export.vtk_reader import read


def test_every_number_comes_back(solved: xr.Dataset, tmp_path) -> None:
    path = export.to_vtk(solved, tmp_path / "case.vtr")
    coordinates, data = read(path)
    for values, name in zip(coordinates, ("x_field", "y_field", "z"), strict=True):
        assert np.array_equal(values, solved[name])
    for name in (*STRESSES, "von_mises"):
        assert np.array_equal(data[name][..., 0], solved[name]), name


def test_tensor_is_the_components_in_rows(solved: xr.Dataset, tmp_path) -> None:
    _, data = read(export.to_vtk(solved, tmp_path / "case.vtr"))
    tensor = data["stress"].reshape(*solved["von_mises"].shape, 3, 3)
    for name in STRESSES:
        i, j = ("xyz".index(letter) for letter in name.split("_")[1])
        assert np.array_equal(tensor[..., i, j], solved[name])
        assert np.array_equal(tensor[..., j, i], solved[name])


def test_surface_is_a_plane_at_zero(solved: xr.Dataset, tmp_path) -> None:
    coordinates, data = read(export.to_vtk(solved, tmp_path / "top.vtr", ["pressure", "gap"]))
    assert coordinates[2].tolist() == [0.0]
    assert np.array_equal(data["pressure"][:, :, 0, 0], solved["pressure"])
    assert "stress" not in data


def test_size_that_fills_whole_blocks(tmp_path) -> None:
    """64 x 64 numbers of 8 bytes: compressed files of the library that writes them are broken at this size."""
    values = np.random.default_rng(0).normal(size=(64, 64))
    surface = xr.DataArray(values, dims=("x", "y"), coords={"x": np.arange(64.0), "y": np.arange(64.0)})
    _, data = read(export.to_vtk(xr.Dataset({"pressure": surface}), tmp_path / "top.vtr"))
    assert np.array_equal(data["pressure"][:, :, 0, 0], values)


def test_positions_are_put_in_order(solved: xr.Dataset, tmp_path) -> None:
    path = export.to_vtk(solved.isel(z=[2, 0, 1]), tmp_path / "case.vtr", "von_mises")
    coordinates, data = read(path)
    assert np.array_equal(coordinates[2], solved["z"][:3])
    assert np.array_equal(data["von_mises"][..., 0], solved["von_mises"][..., :3])


def test_measures_scaled_results_and_cases_of_a_study(solved, opened, tmp_path) -> None:
    coordinates, data = read(export.to_vtk(normalized(solved), tmp_path / "over.vtr", ["tresca", "von_mises"]))
    assert float(coordinates[2].max()) == pytest.approx(1.5)
    assert np.allclose(data["tresca"][..., 0], tresca(solved) / 1.5e9)
    one = opened.sel(e_over_a=1, friction=0.1, body="finite-length")
    assert read(export.to_vtk(one, tmp_path / "study.vtr", "pressure"))[1]["pressure"].max() > 1e9


def test_bad_input(solved: xr.Dataset, opened: xr.Dataset, tmp_path) -> None:
    for call, message in (
        (lambda: export.to_vtk(solved, tmp_path / "case.vtk"), "ends with .vtr"),
        (lambda: export.to_vtk(solved, 3), "path"),
        (lambda: export.to_vtk(solved, tmp_path / "a.vtr", ["pressure", "von_mises"]), "same points"),
        (lambda: export.to_vtk(solved, tmp_path / "a.vtr", "load"), "same points"),
        (lambda: export.to_vtk(opened, tmp_path / "a.vtr"), "single case"),
        (lambda: export.to_vtk(xr.Dataset(), tmp_path / "a.vtr"), "same points"),
    ):
        with pytest.raises(InvalidInputError, match=message):
            call()
    assert not list(tmp_path.iterdir())
