import dask
import numpy as np
import pytest

from contactstudy.study import StudyFileError, collect, load_case, open_study, run_study
from tests.small_study import BASE, identity, small_study
from tests.stand_in_solver import FAILS, solve_fake

PROFILES = [{"name": "sharp", "kind": "cylinder"}, {"name": "crowned", "kind": "lundberg", "amplitude": 2e-7}]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp("opened")
    study = small_study(
        sweep={"e_over_a": [0, 1, -9], "friction": [0, FAILS], "profile": PROFILES},
        exclude=[{"e_over_a": 1, "friction": FAILS, "profile": "sharp"}],
    )
    run_study(study, path, workers=0, solver=solve_fake)
    return path


@pytest.fixture
def opened(folder):
    return open_study(folder)


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


def test_fields_are_lazy(opened, folder):
    for name in ("pressure", "von_mises"):
        assert not opened[name].variable._in_memory
    chunked = open_study(folder, chunks={})
    assert dask.is_dask_collection(chunked["pressure"].data)
    assert float(chunked["pressure"].max()) == float(opened["pressure"].max()) > 0
    stored = load_case(folder, identity(e_over_a=1))
    one = open_study(folder, cells="original").sel(e_over_a=1, friction=0, profile="sharp")
    size = stored.sizes["x"]
    np.testing.assert_array_equal(one["pressure"].values[:size], stored["pressure"])
    assert np.isnan(one["pressure"].values[size:]).all()
    np.testing.assert_array_equal(one["x"].values[:size], stored["x"])
    np.testing.assert_allclose(one["x_over_a"] * one["hertz_half_width"], one["x"])


def test_different_stress_points_share_common_axis(tmp_path):
    base = {name: value for name, value in BASE.items() if name != "field_x_over_a"}
    cases = [{"e_over_a": e, "field_x_over_a": [0.0, 0.5 + e, 2.0, 4.0]} for e in (0.0, 1.0)]
    run_study(small_study(base=base, sweep={}, cases=cases), tmp_path, workers=0, solver=solve_fake)
    opened = open_study(tmp_path)
    assert opened["von_mises"].dims[-3:] == ("x_over_a", "y_field_over_a", "z_over_a")
    assert opened["pressure"].dims[-2] == "x_over_a"
    for point in (0.0, 0.5, 1.5, 2.0, 4.0):
        assert float(np.abs(opened["x_over_a"] - point).min()) < (1e-12 if point else 1e-6)
    for number, e_over_a in enumerate((0.0, 1.0)):
        stored = load_case(tmp_path, str(opened["case_id"].values.ravel()[number]))
        one = opened["von_mises"].isel(dict.fromkeys(opened["status"].dims, number))
        at_points = one.sel(x_over_a=[0.0, 0.5 + e_over_a, 2.0, 4.0], method="nearest")
        np.testing.assert_allclose(at_points, stored["von_mises"], rtol=1e-6)
        load = (opened["pressure"] * opened["x_width"]).isel(dict.fromkeys(opened["status"].dims, number))
        exact = (stored["pressure"].sum("x") * np.diff(stored["x"])[0]).sum()
        assert float(load.sum()) == pytest.approx(float(exact), rel=1e-9)
    drawn = one.plot(x="x_over_a", y="z_over_a")
    assert drawn.get_array().size
    assert "x_field_index" in open_study(tmp_path, cells="original").dims


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


def test_an_unfinished_study_opens(tmp_path):
    run_study(small_study(), tmp_path, workers=0, solver=solve_fake, sample=3)
    opened = open_study(tmp_path)
    assert opened["status"].values.tolist() == [["ok", "ok"], ["missing", "ok"]]
    for path in (tmp_path / "batches").glob("*.nc"):
        path.unlink()
    assert (open_study(tmp_path)["status"] == "missing").all()


def test_open_study_writes_no_files(tmp_path):
    run_study(small_study(), tmp_path, workers=0, solver=solve_fake)
    before = sorted(tmp_path.rglob("*"))
    open_study(tmp_path)["pressure"].load()
    assert sorted(tmp_path.rglob("*")) == before


def test_intensities_with_different_exponents(tmp_path):
    sweep = {"roller_body": ["rigid", "finite-length"]}
    base = BASE | {"e_over_a": 3.0, "stresses": False, "accuracy": 0.1, "cells_x": None, "cells_y": None}
    base = {name: value for name, value in base.items() if value is not None and not name.startswith("field_")}
    study = small_study(base=base, sweep=sweep, level="summary")
    assert run_study(study, tmp_path, workers=0).counts == {"ok": 2}
    opened = open_study(tmp_path)
    assert opened["end_exponent"].values[0] != opened["end_exponent"].values[1]
    assert "units" not in opened["end_intensity"].attrs
    assert "end_exponent" in opened["end_intensity"].attrs["comment"]


def test_collect_keeps_summaries_only(folder):
    summary = collect(folder)
    assert set(summary.dims) == {"e_over_a", "friction", "profile"}
    assert "pressure" not in summary
    assert summary["peak_pressure"].attrs["units"] == "Pa"


def test_file_path_raises_folder_error(tmp_path):
    (tmp_path / "case.nc").write_text("")
    with pytest.raises(StudyFileError, match="it is a file; give the folder"):
        open_study(tmp_path / "case.nc")


def test_a_folder_without_a_study(tmp_path):
    with pytest.raises(StudyFileError, match="not the folder of a study"):
        open_study(tmp_path)
