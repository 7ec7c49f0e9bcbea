"""Columns and ragged arrays of a batch."""

import netCDF4
import pandas as pd
import pytest

from contactstudy.errors import StoreError
from contactstudy.study import run_study
from contactstudy.study.batches import Batch, batch_paths, common_attributes, read_batch
from tests.stand_in_solver import solve_fake


def test_offsets_follow_array_sizes():
    batch = Batch(cases=pd.DataFrame({"x_size": [2, 3], "y_size": [2, 1]}))
    assert batch.offsets(("x", "y")).tolist() == [0, 4, 7]


def test_common_attributes_of_different_units_have_comment():
    attributes, other_attributes = {"units": "Pa m0.5", "long_name": "K"}, {"units": "Pa m0.226"}
    assert "end_exponent" in common_attributes("end_intensity", attributes, other_attributes)["comment"]
    assert common_attributes("end_intensity", attributes, attributes) == attributes


@pytest.mark.parametrize(
    "change",
    [
        lambda file: file.setncattr("contactstudy_run", "[]"),
        lambda file: file.setncattr("contactstudy_run", '{"contactstudy": ["1"]}'),
        lambda file: file.setncattr("contactstudy_coordinates", '["level"]'),
        lambda file: file.renameVariable("run", "runs"),
        lambda file: file.renameVariable("message", "messages"),
        lambda file: file["warnings"].__setitem__(slice(None), b"{"),
        lambda file: file["x_size"].__setitem__(0, -1),
    ],
)
def test_batch_of_another_form_raises(study, tmp_path, change):
    run_study(study, tmp_path, workers=0, solver=solve_fake, progress=False)
    (path,) = batch_paths(tmp_path / "batches")
    with netCDF4.Dataset(path, "r+") as file:
        file.set_auto_chartostring(False)
        change(file)
    with pytest.raises(StoreError, match="cannot read"):
        read_batch(path)
