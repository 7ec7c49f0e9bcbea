"""Dataset.contact calls the functions of the analysis, on any Dataset, in whatever order things are imported."""

from __future__ import annotations

import inspect
import subprocess
import sys

import numpy as np
import pytest
import xarray as xr

from contactstudy import analysis
from contactstudy.analysis.accessor import ContactAccessor

ARGUMENTS = {
    "along_line": ((0.1e-3, 0, 0), (0.4e-3, 0, 50e-6)),
    "in_plane": {"y": 0.0},
    "load_between": (0.1e-3, 0.2e-3),
    "measure": ("tresca",),
    "section_peak": ("maximum_shear",),
    "slices": (5,),
    "edge_factors": ("von_mises",),
}
METHODS = sorted(name for name, _ in inspect.getmembers(ContactAccessor, inspect.isfunction) if name[0] != "_")
METHODS.remove("explore")  # tests/explorer


def test_methods_give_what_the_functions_give(solved: xr.Dataset) -> None:
    for name in METHODS:
        given = ARGUMENTS.get(name, ())
        positional, named = ((), given) if isinstance(given, dict) else (given, {})
        result = getattr(solved.contact, name)(*positional, **named)
        expected = getattr(analysis, name)(solved, *positional, **named)
        same = result.identical(expected) if hasattr(result, "identical") else repr(result) == repr(expected)
        assert same, name


def test_methods_take_what_the_functions_take() -> None:
    for name in METHODS:
        method, function = (
            list(inspect.signature(getattr(owner, name)).parameters.values())[1:]
            for owner in (ContactAccessor, analysis)
        )
        assert [(p.name, p.default, p.kind) for p in method] == [(p.name, p.default, p.kind) for p in function], name


def test_every_function_is_a_method() -> None:
    functions = {name for name in analysis.__all__ if inspect.isfunction(getattr(analysis, name))}
    assert functions - set(METHODS) == {"dimension_along", "discretisation_error", "positions"}


def test_the_accessor_shows_the_main_numbers(solved: xr.Dataset, opened: xr.Dataset) -> None:
    assert repr(solved.contact) == repr(solved.contact.short())
    assert "1.5 GPa" in solved.contact._repr_html_()
    assert repr(opened.contact).startswith("study of 12 cases over e_over_a (3), friction (2), body (2): ")
    assert "<pre>study of" in opened.contact._repr_html_()


def test_a_file_opened_with_xarray(solved: xr.Dataset, tmp_path) -> None:
    solved.to_netcdf(tmp_path / "case.nc")
    with xr.open_dataset(tmp_path / "case.nc") as again:
        assert float(again.contact.peak()["peak_von_mises"]) == float(solved["von_mises"].max())
        assert np.array_equal(again.contact.half_width()["half_width"], solved.contact.half_width()["half_width"])


@pytest.mark.system
@pytest.mark.parametrize(
    "first",
    [
        "import xarray, contactstudy",
        "import contactstudy.analysis.accessor",
        "import contactstudy as cs; cs.analysis",
        "import contactstudy as cs; cs.solve",
        "import contactstudy as cs; cs.surface_displacement",
        "import contactstudy as cs; cs.tresca",
        "import contactstudy as cs; cs.open_study",
    ],
)
def test_it_is_there_whatever_is_imported_first(first: str) -> None:
    code = f"{first}\nimport xarray\nxarray.Dataset().contact"
    subprocess.run([sys.executable, "-c", code], check=True)


@pytest.mark.system
def test_it_is_there_for_a_file_that_xarray_opens_alone(solved: xr.Dataset, tmp_path) -> None:
    solved.to_netcdf(tmp_path / "case.nc")
    code = "import sys, xarray; print(xarray.open_dataset(sys.argv[1]).contact.short())"
    run = subprocess.run([sys.executable, "-c", code, tmp_path / "case.nc"], check=True, capture_output=True, text=True)
    assert "Hertz pressure p0" in run.stdout
