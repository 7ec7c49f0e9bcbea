"""VTK files, read by an independent reader."""

from __future__ import annotations

import meshio
import numpy as np
import pytest
import xarray as xr

from contactstudy import Case, FiniteLengthSpace, Grid, InvalidInputError, Material, Roller, export, solve
from contactstudy.analysis import normalized
from contactstudy.arrays.variables import STRESSES
from contactstudy.stress import tresca
from tests.export.vtk_reader import read_rectilinear


def test_rectilinear_file_equals_result(case_result: xr.Dataset, tmp_path) -> None:
    path = export.to_vtk(case_result, tmp_path / "case.vtr")
    coordinates, data = read_rectilinear(path)
    for values, name in zip(coordinates, ("x_field", "y_field", "z"), strict=True):
        assert np.array_equal(values, case_result[name])
    for name in (*STRESSES, "von_mises"):
        assert np.array_equal(data[name][..., 0], case_result[name]), name


def test_tensor_contains_components(case_result: xr.Dataset, tmp_path) -> None:
    _, data = read_rectilinear(export.to_vtk(case_result, tmp_path / "case.vtr"))
    tensor = data["stress"].reshape(*case_result["von_mises"].shape, 3, 3)
    for name in STRESSES:
        i, j = ("xyz".index(letter) for letter in name.split("_")[1])
        assert np.array_equal(tensor[..., i, j], case_result[name])
        assert np.array_equal(tensor[..., j, i], case_result[name])


def test_surface_lies_at_depth_zero(case_result: xr.Dataset, tmp_path) -> None:
    coordinates, data = read_rectilinear(export.to_vtk(case_result, tmp_path / "top.vtr", ["pressure", "gap"]))
    assert coordinates[2].tolist() == [0.0]
    assert np.array_equal(data["pressure"][:, :, 0, 0], case_result["pressure"])
    assert "stress" not in data


def test_vtk_positions_are_sorted(case_result: xr.Dataset, tmp_path) -> None:
    path = export.to_vtk(case_result.isel(z=[2, 0, 1]), tmp_path / "case.vtr", "von_mises")
    coordinates, data = read_rectilinear(path)
    assert np.array_equal(coordinates[2], case_result["z"][:3])
    assert np.array_equal(data["von_mises"][..., 0], case_result["von_mises"][..., :3])


def test_vtk_contains_measure_of_normalized_result_and_study_case(case_result, study_dataset, tmp_path) -> None:
    coordinates, data = read_rectilinear(
        export.to_vtk(normalized(case_result), tmp_path / "over.vtr", ["tresca", "von_mises"])
    )
    assert float(coordinates[2].max()) == pytest.approx(1.5)
    assert np.allclose(data["tresca"][..., 0], tresca(case_result) / 1.5e9)
    study_case = study_dataset.sel(e_over_a=1, friction=0.1, body="finite-length")
    assert read_rectilinear(export.to_vtk(study_case, tmp_path / "study.vtr", "pressure"))[1]["pressure"].max() > 1e9


def test_invalid_argument_raises(case_result: xr.Dataset, study_dataset: xr.Dataset, tmp_path) -> None:
    for call, message in (
        (lambda: export.to_vtk(case_result, tmp_path / "case.vtk"), "ends with .vtr or .vtu"),
        (lambda: export.to_vtk(case_result, 3), "path"),
        (lambda: export.to_vtk(case_result, tmp_path / "a.vtr", ["pressure", "von_mises"]), "same points"),
        (lambda: export.to_vtk(case_result, tmp_path / "a.vtr", "normal_load"), "same points"),
        (lambda: export.to_vtk(study_dataset, tmp_path / "a.vtr"), "single case"),
        (lambda: export.to_vtk(xr.Dataset(), tmp_path / "a.vtr"), "same points"),
    ):
        with pytest.raises(InvalidInputError, match=message):
            call()
    assert not list(tmp_path.iterdir())


def test_mesh_of_body_equals_result(case_result: xr.Dataset, tmp_path) -> None:
    """The reader is meshio."""
    mesh = meshio.read(export.to_vtk(case_result, tmp_path / "case.vtu"))
    shape = case_result["von_mises"].shape
    assert [(block.type, len(block.data)) for block in mesh.cells] == [("hexahedron", np.prod(np.array(shape) - 1))]
    x, y, z = mesh.points.T
    for values, name in ((x, "x_field"), (y, "y_field"), (z, "z")):
        assert np.array_equal(np.unique(values), np.sort(case_result[name].values))
    positions = {"x_field": xr.DataArray(x), "y_field": xr.DataArray(y), "z": xr.DataArray(z)}
    for name in (*STRESSES, "von_mises"):
        assert np.array_equal(mesh.point_data[name], case_result[name].sel(positions)), name
    assert np.array_equal(mesh.point_data["stress"].reshape(-1, 3, 3)[:, 0, 2], mesh.point_data["tau_xz"])
    # All hexahedra have positive volumes, which sum to the volume of the field.
    corners = mesh.points[mesh.cells[0].data]
    volumes = np.prod(corners[:, 6] - corners[:, 0], axis=1)
    assert volumes.min() > 0
    assert volumes.sum() == pytest.approx(
        np.prod([np.ptp(case_result[name].values) for name in ("x_field", "y_field", "z")])
    )
    face_normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 3] - corners[:, 0])
    assert (np.sum(face_normals * (corners[:, 4] - corners[:, 0]), axis=1) > 0).all()


def test_mesh_of_top_has_load_of_case(tmp_path) -> None:
    body = FiniteLengthSpace(length=4.0, material=Material(1.0, 0.3))
    grid = Grid.from_edges([0.0, 0.5, 1.0, 2.0, 3.0, 3.5, 4.0], (-2.0, 2.0), 12)
    case = Case(body=body, roller=Roller(radius=20.0, length=3.0), max_pressure=0.025)
    result = solve(case, grid, stresses=False)
    result = result.assign(stick=result["pressure"] > 0, count=(result["pressure"] > 0).astype("i1"))
    names = ["pressure", "gap", "stick", "count"]
    mesh = meshio.read(export.to_vtk(result, tmp_path / "top.vtu", names))
    (block,) = mesh.cells
    assert block.type == "quad"
    corners = mesh.points[block.data]
    centre = corners.mean(axis=1)
    positions = {"x": xr.DataArray(centre[:, 0]), "y": xr.DataArray(centre[:, 1])}
    for name in names:
        (values,) = mesh.cell_data[name]
        assert np.array_equal(values, result[name].sel(positions, method="nearest")), name
    areas = np.prod(corners[:, 2] - corners[:, 0], axis=1, where=[True, True, False])
    assert float((areas * mesh.cell_data["pressure"][0]).sum()) == pytest.approx(case.normal_load)


def test_mesh_of_plane_has_quadrilaterals(case_result: xr.Dataset, tmp_path) -> None:
    plane = case_result.isel(y_field=[8])
    mesh = meshio.read(export.to_vtk(plane, tmp_path / "plane.vtu", "von_mises"))
    assert [(block.type, len(block.data)) for block in mesh.cells] == [("quad", 12 * 5)]
    with pytest.raises(InvalidInputError, match="at least two points"):
        export.to_vtk(plane.isel(z=[0]), tmp_path / "line.vtu", "von_mises")
    assert not (tmp_path / "line.vtu").exists()
