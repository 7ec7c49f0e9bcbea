"""Values of swept parameters by name."""

from __future__ import annotations

import xarray as xr

from contactstudy.arrays.variables import index_of, selection_of


def test_number_and_text_select_same_swept_value() -> None:
    study_coordinates = xr.Dataset(coords={"friction": [0.0, 0.1]})
    assert [index_of(study_coordinates, "friction", value) for value in (0.1, "0.10")] == [1, 1]


def test_selection_splits_name_and_value() -> None:
    assert selection_of(["friction=0.1", "profile=crowned"]) == {"friction": "0.1", "profile": "crowned"}
