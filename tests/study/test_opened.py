import dask
import numpy as np
import pytest

from contactstudy.study import StudyFileError, collect, open_study, run_study
from contactstudy.study.folder import Folder
from contactstudy.study.store import load_case
from tests.small_study import BASE, identity, small_study
from tests.stand_in_solver import FAILS, solve_fake

PROFILES = [{"name": "sharp", "kind": "cylinder"}, {"name": "crowned", "kind": "lundberg", "amplitude": 2e-7}]


@pytest.fixture
def opened(tmp_path):
    study = small_study(
        sweep={"e_over_a": [0, 1, -9], "friction": [0, FAILS], "profile": PROFILES},
        exclude=[{"e_over_a": 1, "friction": FAILS, "profile": "sharp"}],
    )
    run_study(study, tmp_path, workers=0, solver=solve_fake)
    return open_study(tmp_path)


def test_swept_parameters_are_the_dimensions(opened):
    assert opened["status"].dims == ("e_over_a", "friction", "profile")
    assert opened["profile"].values.tolist() == ["sharp", "crowned"]
    assert opened["e_over_a"].attrs["units"] == "1"
    assert "lundberg" in opened.attrs["contactstudy_study"]


def test_the_state_of_every_case_is_data(opened):
    status = opened["status"]
    assert (status.sel(e_over_a=-9) == "skipped").all()
    assert status.sel(e_over_a=1, friction=FAILS).values.tolist() == ["excluded", "failed"]
    assert (status.sel(e_over_a=[0, 1], friction=0) == "ok").all()
    assert "this friction fails" in opened["message"].sel(e_over_a=0, friction=FAILS, profile="sharp").item()
    assert np.isnan(opened["peak_pressure"].sel(e_over_a=-9)).all()


def test_fields_are_lazy_with_one_chunk_per_case(opened, tmp_path):
    for name in ("pressure", "von_mises"):
        assert dask.is_dask_collection(opened[name].data)
        assert opened[name].data.numblocks[:3] == (3, 2, 2)
        assert set(opened[name].data.numblocks[3:]) == {1}
    assert not dask.is_dask_collection(opened["peak_pressure"].data)
    stored = load_case(Folder(tmp_path).case_path(identity(e_over_a=1)))
    one = open_study(tmp_path, cells="own").sel(e_over_a=1, friction=0, profile="sharp")
    size = stored.sizes["x"]
    np.testing.assert_array_equal(one["pressure"].values[:size], stored["pressure"])
    assert np.isnan(one["pressure"].values[size:]).all()
    np.testing.assert_array_equal(one["x"].values[:size], stored["x"])
    np.testing.assert_allclose(one["x_over_a"] * one["hertz_half_width"], one["x"])


def test_common_positions_are_plain_coordinates(opened):
    assert opened["y"].dims == ("y",)
    assert opened["x"].dims == ("e_over_a", "friction", "profile", "x_over_a")
    assert opened["x_field_over_a"].dims == ("x_field",)
    np.testing.assert_allclose(opened["x_field_over_a"], [0, 1, 2], atol=1e-12)


def test_positions_over_a_are_common_where_metres_differ(tmp_path):
    study = small_study(sweep={"e_over_a": [0], "max_pressure": [1e9, 2e9]})
    run_study(study, tmp_path, workers=0, solver=solve_fake)
    opened = open_study(tmp_path)
    assert opened["z"].dims == ("e_over_a", "max_pressure", "z_over_a")
    np.testing.assert_allclose(opened["z_over_a"], [0, 0.5, 1], atol=1e-12)
    assert opened["z_over_a"].dims == ("z_over_a",)


def test_a_study_without_a_sweep(tmp_path):
    run_study(small_study(sweep={}, base=BASE | {"e_over_a": 1}), tmp_path, workers=0, solver=solve_fake)
    opened = open_study(tmp_path)
    assert opened["pressure"].isel(case=0).max() > 0


def test_a_swept_load_is_not_doubled(tmp_path):
    base = {key: value for key, value in BASE.items() if key != "max_pressure"}
    study = small_study(base=base, sweep={"load": [50, 100], "e_over_a": [0]})
    run_study(study, tmp_path, workers=0, solver=solve_fake)
    opened = open_study(tmp_path)
    assert opened["load"].values.tolist() == [50, 100]


def test_files_of_before_have_the_names_of_today(tmp_path):
    run_study(small_study(), tmp_path, workers=0, solver=solve_fake)
    for path in (tmp_path / "cases").glob("*.nc"):
        case = load_case(path)
        path.unlink()
        old = case.rename(normal_load="load").assign(shear_traction=0.1 * case["pressure"])
        old.to_netcdf(path, engine="netcdf4")
    opened = open_study(tmp_path)
    assert (opened["status"] == "ok").all()
    assert {"normal_load", "traction_y"} <= set(opened.data_vars)
    assert float(opened["traction_y"].max()) > 0
    assert not {"load", "shear_traction"} & set(opened.data_vars)


def test_an_unfinished_study_opens(tmp_path):
    run_study(small_study(), tmp_path, workers=0, solver=solve_fake)
    Folder(tmp_path).case_path(identity(e_over_a=0.0)).unlink()
    opened = open_study(tmp_path)
    assert opened["status"].values.tolist() == [["missing", "ok"], ["ok", "ok"]]
    for path in (tmp_path / "cases").glob("*.nc"):
        path.unlink()
    assert (open_study(tmp_path)["status"] == "missing").all()


def test_opening_writes_nothing(tmp_path):
    run_study(small_study(), tmp_path, workers=0, solver=solve_fake)
    (tmp_path / "manifest.jsonl").unlink()
    open_study(tmp_path)
    assert not (tmp_path / "manifest.jsonl").exists()


def test_collect_keeps_summaries_only(opened, tmp_path):
    summary = collect(tmp_path)
    assert set(summary.dims) == {"e_over_a", "friction", "profile"}
    assert "pressure" not in summary
    assert summary["peak_pressure"].attrs["units"] == "Pa"


def test_a_file_instead_of_the_folder_is_told_apart(tmp_path):
    (tmp_path / "case.nc").write_text("")
    with pytest.raises(StudyFileError, match="it is a file; give the folder"):
        open_study(tmp_path / "case.nc")


def test_a_folder_without_a_study(tmp_path):
    with pytest.raises(StudyFileError, match="not the folder of a study"):
        open_study(tmp_path)
