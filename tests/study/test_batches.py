"""Columns and ragged arrays of a batch."""

import numpy as np

from contactstudy.study.batches import Batch, common_attributes


def test_offsets_of_arrays_of_different_shapes():
    sizes = {"x": np.array([2, 3]), "y": np.array([2, 1])}
    ids, columns = np.array([b"a", b"b"]), np.zeros(2, dtype=np.int64)
    batch = Batch(ids=ids, status=columns.astype(np.int8), runs=columns, texts={}, sizes=sizes)
    assert batch.offsets(("x", "y")).tolist() == [0, 4, 7]


def test_attributes_of_intensities_with_different_exponents():
    attributes, other_attributes = {"units": "Pa m0.5", "long_name": "K"}, {"units": "Pa m0.226"}
    assert "end_exponent" in common_attributes("end_intensity", attributes, other_attributes)["comment"]
    assert common_attributes("end_intensity", attributes, attributes) == attributes
