import dask
import numpy as np
import pandas as pd
import pytest

from contactstudy.export import export_results
from contactstudy.report import summary
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
def study_dataset(folder):
    return open_study(folder)


def test_swept_parameters_are_the_dimensions(study_dataset):
    assert study_dataset["status"].dims == ("e_over_a", "friction", "profile")
    assert study_dataset["profile"].values.tolist() == ["sharp", "crowned"]
    assert study_dataset["e_over_a"].attrs["units"] == "1"
    assert "lundberg" in study_dataset.attrs["contactstudy_study"]


def test_dataset_contains_status_of_cases(study_dataset):
    status = study_dataset["status"]
    assert (status.sel(e_over_a=-9) == "skipped").all()
    assert status.sel(e_over_a=1, friction=FAILS).values.tolist() == ["excluded", "failed"]
    assert (status.sel(e_over_a=[0, 1], friction=0) == "ok").all()
    assert "this friction fails" in study_dataset["message"].sel(e_over_a=0, friction=FAILS, profile="sharp").item()
    assert np.isnan(study_dataset["peak_pressure"].sel(e_over_a=-9)).all()


def test_fields_are_lazy(study_dataset, folder):
    for name in ("pressure", "von_mises"):
        assert not study_dataset[name].variable._in_memory
    chunked_dataset = open_study(folder, chunks={})
    assert dask.is_dask_collection(chunked_dataset["pressure"].data)
    assert float(chunked_dataset["pressure"].max()) == float(study_dataset["pressure"].max()) > 0
    stored_case = load_case(folder, identity(e_over_a=1))
    first_case = open_study(folder, cells="original").sel(e_over_a=1, friction=0, profile="sharp")
    cell_count = stored_case.sizes["x"]
    np.testing.assert_array_equal(first_case["pressure"].values[:cell_count], stored_case["pressure"])
    assert np.isnan(first_case["pressure"].values[cell_count:]).all()
    np.testing.assert_array_equal(first_case["x"].values[:cell_count], stored_case["x"])
    np.testing.assert_allclose(first_case["x_over_a"] * first_case["hertz_half_width"], first_case["x"])


def test_different_stress_points_share_common_axis(tmp_path):
    base = {name: value for name, value in BASE.items() if name != "field_x_over_a"}
    cases = [
        {"e_over_a": end_distance, "field_x_over_a": [0.0, 0.5 + end_distance, 2.0, 4.0]} for end_distance in (0.0, 1.0)
    ]
    run_study(small_study(base=base, sweep={}, cases=cases), tmp_path, workers=0, solver=solve_fake)
    study_dataset = open_study(tmp_path)
    assert study_dataset["von_mises"].dims[-3:] == ("x_over_a", "y_field_over_a", "z_over_a")
    assert study_dataset["pressure"].dims[-2] == "x_over_a"
    for point in (0.0, 0.5, 1.5, 2.0, 4.0):
        assert float(np.abs(study_dataset["x_over_a"] - point).min()) < (1e-12 if point else 1e-6)
    for index, e_over_a in enumerate((0.0, 1.0)):
        stored_case = load_case(tmp_path, str(study_dataset["case_id"].values.ravel()[index]))
        case_field = study_dataset["von_mises"].isel(dict.fromkeys(study_dataset["status"].dims, index))
        common_stress = case_field.sel(x_over_a=[0.0, 0.5 + e_over_a, 2.0, 4.0], method="nearest")
        np.testing.assert_allclose(common_stress, stored_case["von_mises"], rtol=1e-6)
        line_loads = (study_dataset["pressure"] * study_dataset["x_width"]).isel(
            dict.fromkeys(study_dataset["status"].dims, index)
        )
        expected_load = (stored_case["pressure"].sum("x") * np.diff(stored_case["x"])[0]).sum()
        assert float(line_loads.sum()) == pytest.approx(float(expected_load), rel=1e-9)
    mesh = case_field.plot(x="x_over_a", y="z_over_a")
    assert mesh.get_array().size
    assert "x_field_index" in open_study(tmp_path, cells="original").dims


def test_positions_over_a_are_common(tmp_path):
    study = small_study(sweep={"e_over_a": [0], "max_pressure": [1e9, 2e9]})
    run_study(study, tmp_path, workers=0, solver=solve_fake)
    study_dataset = open_study(tmp_path)
    assert study_dataset["z"].dims == ("e_over_a", "max_pressure", "z_over_a")
    np.testing.assert_allclose(study_dataset["z_over_a"], [0, 0.5, 1], atol=1e-12)
    assert study_dataset["z_over_a"].dims == ("z_over_a",)


def test_study_without_sweep_has_case_dimension(tmp_path):
    run_study(small_study(sweep={}, base=BASE | {"e_over_a": 1}), tmp_path, workers=0, solver=solve_fake)
    study_dataset = open_study(tmp_path)
    assert study_dataset["pressure"].isel(case=0).max() > 0


def test_swept_load_is_dimension_only(tmp_path):
    base = {key: value for key, value in BASE.items() if key != "max_pressure"}
    study = small_study(base=base, sweep={"load": [50, 100], "e_over_a": [0]})
    run_study(study, tmp_path, workers=0, solver=solve_fake)
    study_dataset = open_study(tmp_path)
    assert study_dataset["load"].values.tolist() == [50, 100]


def test_unfinished_study_has_missing_cases(tmp_path):
    run_study(small_study(), tmp_path, workers=0, solver=solve_fake, sample=3)
    study_dataset = open_study(tmp_path)
    assert study_dataset["status"].values.tolist() == [["ok", "ok"], ["missing", "ok"]]
    for path in (tmp_path / "batches").glob("*.nc"):
        path.unlink()
    assert (open_study(tmp_path)["status"] == "missing").all()


def test_open_study_writes_no_files(tmp_path):
    run_study(small_study(), tmp_path, workers=0, solver=solve_fake)
    initial_paths = sorted(tmp_path.rglob("*"))
    open_study(tmp_path)["pressure"].load()
    assert sorted(tmp_path.rglob("*")) == initial_paths


def test_intensity_of_different_exponents_has_no_units(tmp_path):
    sweep = {"roller_body": ["rigid", "finite-length"]}
    base = BASE | {"body": "half-space", "stresses": False, "accuracy": 0.1, "cells_x": None, "cells_y": None}
    base |= {"e_over_a": 3.0}
    base = {name: value for name, value in base.items() if value is not None and not name.startswith("field_")}
    study = small_study(base=base, sweep=sweep, level="summary")
    assert run_study(study, tmp_path, workers=0).counts == {"ok": 2}
    study_dataset = open_study(tmp_path)
    assert study_dataset["end_exponent"].values[0] != study_dataset["end_exponent"].values[1]
    assert "units" not in study_dataset["end_intensity"].attrs
    assert "end_exponent" in study_dataset["end_intensity"].attrs["comment"]


def test_dataset_contains_corners(tmp_path):
    """Variables of the law at a corner; they are NaN for a case without a corner."""
    profiles = [{"kind": "chamfer", "width": 0.1e-3, "angle": angle} for angle in (0.02, 0.04)]
    base = {name: value for name, value in BASE.items() if not name.startswith(("field_", "cells_"))}
    base |= {"body": "half-space", "stresses": False, "accuracy": 0.1, "e_over_a": 3.0}
    study = small_study(base=base, sweep={"profile": [*profiles, "cylinder"]}, level="summary")
    assert run_study(study, tmp_path, workers=0).counts == {"ok": 3}
    dataset = open_study(tmp_path)
    modulus = 210e9 / (1 - 0.3**2)
    np.testing.assert_allclose(dataset.corner_slope, np.tan([0.02, 0.04, np.nan]))
    np.testing.assert_allclose(dataset.corner_intensity, modulus * dataset.corner_slope / (2 * np.pi))
    centre = 3 * dataset.hertz_half_width + 0.25e-3
    np.testing.assert_allclose(np.abs(dataset.corner_x - centre), [0.15e-3, 0.15e-3, np.nan])
    assert (dataset.corner_distance_error < 0.3 * dataset.corner_distance).values.tolist() == [True, True, False]
    assert dataset.corner_distance.attrs["units"] == "m"


def test_dataset_contains_reference_depths(tmp_path):
    """Tables of a study contain the reference depths of approach and tilt of each case."""
    base = {name: value for name, value in BASE.items() if not name.startswith(("field_", "cells_"))}
    base |= {"e_over_a": 1.0, "stresses": False, "accuracy": 0.1, "roller_body": "finite-length", "tilt": 1e-4}
    del base["roller_length"]
    lengths = [0.3e-3, 0.5e-3]
    study = small_study(base=base, sweep={"roller_length": lengths}, level="surface")
    assert run_study(study, tmp_path, workers=0).counts == {"ok": 2}
    dataset = open_study(tmp_path)
    np.testing.assert_allclose(dataset.reference_depth, lengths + 2 * dataset.hertz_half_width)
    np.testing.assert_allclose(dataset.roller_reference_depth, lengths)
    assert "reference_depth" in dataset.approach.attrs["long_name"]
    assert summary(dataset.isel(roller_length=0))["roller_reference_depth"].text == "0.3 mm"
    table = pd.read_csv(export_results(tmp_path))
    np.testing.assert_allclose(table["roller_reference_depth [m]"], lengths)
    assert table["reference_depth [m]"].tolist() == dataset.reference_depth.values.tolist()


def test_swept_reference_depth_is_the_dimension(tmp_path):
    base = {name: value for name, value in BASE.items() if not name.startswith(("field_", "cells_"))}
    base |= {"body": "half-space", "e_over_a": 1.0, "stresses": False, "accuracy": 0.1}
    run_study(small_study(base=base, sweep={"reference_depth": [1e-3, 2e-3]}), tmp_path, workers=0)
    dataset = open_study(tmp_path)
    assert dataset.reference_depth.dims == ("reference_depth",)
    assert summary(dataset.isel(reference_depth=1))["reference_depth"].text == "2 mm"


def test_collect_keeps_summaries_only(folder):
    summary = collect(folder)
    assert set(summary.dims) == {"e_over_a", "friction", "profile"}
    assert "pressure" not in summary
    assert summary["peak_pressure"].attrs["units"] == "Pa"


def test_file_path_raises_folder_error(tmp_path):
    (tmp_path / "case.nc").write_text("")
    with pytest.raises(StudyFileError, match="it is a file; give the folder"):
        open_study(tmp_path / "case.nc")


def test_folder_without_study_raises(tmp_path):
    with pytest.raises(StudyFileError, match="not the folder of a study"):
        open_study(tmp_path)
