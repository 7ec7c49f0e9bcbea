"""Files of stored references."""

from pathlib import Path

import numpy as np
import xarray as xr

from benchmarks.finite_elements.reference_files import append_case, create_file


def test_reference_file_contains_cases_in_single_precision(tmp_path: Path) -> None:
    path = tmp_path / "stored.nc"
    solution = xr.Dataset({"film": ("x", [0.1, 0.2], {"units": "a"})}, {"x": [0.3, 0.6]}, {"length": 8.0})
    for _ in range(2):  # A second file replaces the first.
        create_file(path, "film", title="films")
        append_case(path, "thin", solution)
    append_case(path, "thick", 2 * solution)
    attributes, thin_case = xr.load_dataset(path).attrs, xr.load_dataset(path, group="thin")
    assert attributes["title"] == "films"
    assert attributes["regenerate"].endswith("generate film")
    assert thin_case["film"].dtype == np.float32
    assert thin_case.attrs == {"length": 8.0}
    assert thin_case["film"].attrs == {"units": "a"}
    np.testing.assert_array_equal(thin_case["x"], solution["x"])
    np.testing.assert_allclose(xr.load_dataset(path, group="thick")["film"], [0.2, 0.4])
