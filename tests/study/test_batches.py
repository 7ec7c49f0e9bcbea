"""Columns and ragged arrays of a batch."""

import pandas as pd

from contactstudy.study.batches import Batch, common_attributes


def test_offsets_follow_array_sizes():
    batch = Batch(cases=pd.DataFrame({"x_size": [2, 3], "y_size": [2, 1]}))
    assert batch.offsets(("x", "y")).tolist() == [0, 4, 7]


def test_common_attributes_of_different_units_have_comment():
    attributes, other_attributes = {"units": "Pa m0.5", "long_name": "K"}, {"units": "Pa m0.226"}
    assert "end_exponent" in common_attributes("end_intensity", attributes, other_attributes)["comment"]
    assert common_attributes("end_intensity", attributes, attributes) == attributes
