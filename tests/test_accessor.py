"""Dataset.contact: its methods equal the functions of the package, for every order of imports."""

from __future__ import annotations

import inspect
import subprocess
import sys

import numpy as np
import pytest
import xarray as xr

from contactstudy import analysis, report

ARGUMENTS = {
    "along_line": ((0.1e-3, 0, 0), (0.4e-3, 0, 50e-6)),
    "in_plane": {"y": 0.0},
    "load_between": (0.1e-3, 0.2e-3),
    "measure": ("tresca",),
    "largest_sample": ("maximum_shear",),
    "slices": (5,),
    "edge_factors": ("von_mises",),
}
FUNCTIONS = sorted(
    name
    for name in analysis.__all__
    if inspect.isfunction(function := getattr(analysis, name)) and "dataset" in inspect.signature(function).parameters
)


@pytest.mark.parametrize("name", [*FUNCTIONS, "summary", "assess", "citations"])
def test_accessor_methods_equal_functions(case_result: xr.Dataset, name: str) -> None:
    arguments = ARGUMENTS.get(name, ())
    positional_arguments, options = ((), arguments) if isinstance(arguments, dict) else (arguments, {})
    result = getattr(case_result.contact, name)(*positional_arguments, **options)
    expected = getattr(analysis if name in FUNCTIONS else report, name)(case_result, *positional_arguments, **options)
    assert result.identical(expected) if hasattr(result, "identical") else repr(result) == repr(expected)


def test_accessor_signatures_match_functions() -> None:
    method, function = inspect.signature(xr.Dataset().contact.edge_factors), inspect.signature(analysis.edge_factors)
    assert list(method.parameters.values()) == list(function.parameters.values())[1:]


def test_accessor_text_contains_main_values(case_result: xr.Dataset, study_dataset: xr.Dataset) -> None:
    assert repr(case_result.contact) == repr(case_result.contact.summary())
    assert "1.5 GPa" in case_result.contact._repr_html_()
    assert repr(study_dataset.contact).startswith("study of 12 cases over e_over_a (3), friction (2), body (2): ")
    assert "<pre>study of" in study_dataset.contact._repr_html_()


def test_accessor_of_opened_file_equals_result(case_result: xr.Dataset, tmp_path) -> None:
    case_result.to_netcdf(tmp_path / "case.nc")
    with xr.open_dataset(tmp_path / "case.nc") as stored_result:
        assert float(stored_result.contact.largest_sample()["largest_von_mises"]) == float(
            case_result["von_mises"].max()
        )
        assert np.array_equal(
            stored_result.contact.half_width()["half_width"], case_result.contact.half_width()["half_width"]
        )


@pytest.mark.system
@pytest.mark.parametrize(
    "import_statement",
    [
        "import xarray, contactstudy",
        "import contactstudy.accessor",
        "import contactstudy as cs; cs.analysis",
        "import contactstudy as cs; cs.solve",
        "import contactstudy as cs; cs.surface_displacement",
        "import contactstudy as cs; cs.stress.tresca",
        "import contactstudy as cs; cs.open_study",
    ],
)
def test_accessor_is_registered_in_any_import_order(import_statement: str) -> None:
    code = f"{import_statement}\nimport xarray\nxarray.Dataset().contact"
    subprocess.run([sys.executable, "-c", code], check=True)


@pytest.mark.system
def test_accessor_is_registered_by_xarray_backend(case_result: xr.Dataset, tmp_path) -> None:
    case_result.to_netcdf(tmp_path / "case.nc")
    code = "import sys, xarray; print(xarray.open_dataset(sys.argv[1]).contact.summary())"
    finished_process = subprocess.run(
        [sys.executable, "-c", code, tmp_path / "case.nc"], check=True, capture_output=True, text=True
    )
    assert "Hertz pressure p0" in finished_process.stdout
