"""Studies from tables of parameters and from opened studies."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from contactstudy import InvalidInputError, profiles
from contactstudy.study import Study, collect, open_study, run_study
from tests.small_study import BASE, small_study
from tests.stand_in_solver import solve_fake


def list_ids(study: Study) -> list[str]:
    return [case.id for case in study.plan()]


def test_table_of_coordinates_is_product() -> None:
    table = xr.Dataset(coords={"e_over_a": [0.0, 1.0], "friction": [0.0, 0.1]})
    study = Study.from_dataset(table, "small", base=BASE)
    assert study == small_study(sweep={"e_over_a": [0.0, 1.0], "friction": [0.0, 0.1]})


def test_table_of_rows_makes_listed_cases() -> None:
    frame = pd.DataFrame({"e_over_a": [0.0, 1.0, 1.0], "friction": [0.0, 0.0, 0.1], "body": "half-space"})
    study = Study.from_dataset(frame.rename_axis("case").to_xarray(), "rows", base=BASE)
    columns = {"e_over_a": [0.0, 1.0, 1.0], "friction": [0.0, 0.0, 0.1], "body": 3 * ["half-space"]}
    assert list_ids(study) == list_ids(small_study(sweep={}, zip=columns))
    assert study.name == "rows"


def test_table_may_contain_units_and_profiles() -> None:
    crown = profiles.FullCrown(1.0)
    table = xr.Dataset(
        {
            "profile": ("which", np.array([crown, {"kind": "cylinder", "name": "sharp"}], dtype=object)),
            "coupled": ("which", [True, False]),
            "tilt": ("tilt", [0.0, 0.2], {"units": "mrad"}),
            "e_over_a": 1.0,
        },
    )
    study = Study.from_dataset(table, base=BASE)
    expected = small_study(
        base=BASE | {"e_over_a": 1.0},
        sweep={"tilt": [0.0, 0.2e-3]},
        zip={"profile": [crown, {"kind": "cylinder", "name": "sharp"}], "coupled": [True, False]},
    )
    assert list_ids(study) == list_ids(expected)


def test_two_dimensional_table_makes_explicit_cases() -> None:
    pressure = xr.DataArray([[1.0, 1.5], [np.nan, 2.0]], dims=("e_over_a", "friction"), attrs={"units": "GPa"})
    load = xr.DataArray([[np.nan, np.nan], [40.0, np.nan]], dims=("e_over_a", "friction"), attrs={"units": "N"})
    table = xr.Dataset(
        {"max_pressure": pressure, "load": load}, coords={"e_over_a": [0.0, 1.0], "friction": [0.0, 0.1]}
    )
    study = Study.from_dataset(table, base={key: value for key, value in BASE.items() if key != "max_pressure"})
    assert [case.get("max_pressure", case.get("load")) for case in study.cases] == [1e9, 1.5e9, 40.0, 2e9]
    assert not study.plan().skipped


def test_profile_tables_are_labels_of_two_dimensions() -> None:
    tables = np.array([{"kind": "cylinder"}, {"kind": "full-crown", "crown_radius": 1.0}], dtype=object)
    pressure = (("friction", "profile"), [[1.0, 1.5], [1.2, 2.0]], {"units": "GPa"})
    table = xr.Dataset({"max_pressure": pressure}, coords={"friction": [0.0, 0.1], "profile": tables})
    base = {key: value for key, value in BASE.items() if key != "max_pressure"} | {"e_over_a": 1.0}
    study = Study.from_dataset(table, base=base)
    assert [case["max_pressure"] for case in study.cases] == [1e9, 1.5e9, 1.2e9, 2e9]
    assert [case["profile"]["kind"] for case in study.cases] == 2 * ["cylinder", "full-crown"]


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"frction": ("case", [0.1])}, "variable of the table = 'frction'.*did you mean 'friction'"),
        ({"radius": ("case", [5.0], {"units": "inch"})}, r"radius.attrs\['units'\] = 'inch': must be one of m, mm"),
        ({"body": ("case", ["half-space"], {"units": "m"})}, r"body.attrs\['units'\] = 'm': must be left out"),
        ({"friction": ("case", ["much"])}, "friction = 'much'"),
        ({"field_z_over_a": ("z", [0.0, 1.0])}, "a list in base"),
        ({"young": ("case", [1e9])}, "base = 'young': must be a parameter that the table does not have"),
    ],
)
def test_invalid_parameter_table_raises(table: dict, message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        Study.from_dataset(xr.Dataset(table), base=BASE)


def test_table_of_wrong_type_raises() -> None:
    with pytest.raises(InvalidInputError, match=r"an xarray.Dataset of parameters"):
        Study.from_dataset({"friction": [0.1]})


ROUND_TRIPS = {
    "product": small_study(),
    "zip": small_study(
        sweep={"e_over_a": [0.0, 1.0]}, zip={"friction": [0.0, 0.1], "profile": ["cylinder", profiles.FullCrown(1.0)]}
    ),
    "excluded": small_study(exclude=[{"e_over_a": 1.0, "friction": 0.1}]),
    "cases": small_study(sweep={}, cases=[{"e_over_a": 0.0}, {"e_over_a": 1.0, "friction": 0.1}]),
    "one": small_study(sweep={}, base=BASE | {"e_over_a": 1.0}),
}


@pytest.mark.parametrize("study", ROUND_TRIPS.values(), ids=ROUND_TRIPS)
def test_study_from_opened_dataset_equals_study(study: Study, tmp_path) -> None:
    run_study(study, tmp_path, workers=0, solver=solve_fake, progress=False)
    restored_study = Study.from_dataset(open_study(tmp_path))
    assert restored_study.to_json() == study.to_json()
    assert Study.from_dataset(collect(tmp_path), "other", level="summary").level == "summary"


def test_study_from_selection_of_dataset_has_selected_values(tmp_path) -> None:
    study = small_study(
        sweep={"e_over_a": [0.0, 1.0, 2.0], "friction": [0.0, 0.1]},
        zip={
            "profile": [{"kind": "cylinder", "name": "sharp"}, {"kind": "ellipsoid", "crown_radius": 0.5}],
            "tilt": [0.0, 1e-4],
        },
    )
    run_study(study, tmp_path, workers=0, solver=solve_fake, progress=False)
    dataset = collect(tmp_path)
    selection = dataset.sel(e_over_a=[0, 2], friction=0.1)
    finer_study = Study.from_dataset(selection, "finer", base={"cells_x": 8})
    assert finer_study.sweep == {"e_over_a": [0.0, 2.0], "friction": [0.1]}
    assert finer_study.zip[0]["profile"][0]["name"] == "sharp"
    assert finer_study.base["cells_x"] == 8.0
    equal_study = Study.from_dataset(selection)
    assert set(list_ids(equal_study)) == set(selection["case_id"].values.ravel())
    listed_cases = dataset.stack(all=dataset["case_id"].dims).isel(all=[0, 3, 7])
    assert set(list_ids(Study.from_dataset(listed_cases))) == set(listed_cases["case_id"].values)
    with pytest.raises(InvalidInputError, match="base = 'tilt': must be a parameter that is not swept"):
        Study.from_dataset(selection, base={"tilt": 0.0})


def test_unknown_coordinate_raises() -> None:
    table = xr.Dataset(coords={"max_pressure": [1e9, 1.5e9], "tillt": [0.0, 1e-3]})
    with pytest.raises(InvalidInputError, match=r"variable of the table = 'tillt'.*did you mean 'tilt'"):
        Study.from_dataset(table)
