"""The package's public names, and what importing it costs."""

from __future__ import annotations

import importlib
import importlib.metadata
import subprocess
import sys
from pathlib import Path

import pytest
import xarray as xr

import contactstudy


@pytest.mark.system
def test_import_is_fast_because_it_imports_nothing_heavy() -> None:
    code = (
        "import contactstudy, sys; print(sorted({'numpy', 'xarray', 'scipy', 'matplotlib', 'dask'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_every_public_name_can_be_imported() -> None:
    for name in contactstudy.__all__:
        assert getattr(contactstudy, name) is not None
    assert sorted(contactstudy.__all__) == contactstudy.__all__


def test_no_public_name_is_hidden_by_a_module_of_that_name() -> None:
    """Importing a submodule sets it as an attribute of the package, over a function of the same name."""
    modules = {path.stem for path in Path(contactstudy.__file__).parent.iterdir()}
    shared = modules & set(contactstudy.__all__)
    assert {"analysis", "plots", "profiles"} <= shared
    for name in shared:
        assert getattr(contactstudy, name) is importlib.import_module(f"contactstudy.{name}"), name


def test_the_version_is_that_of_the_installation() -> None:
    assert contactstudy.__version__ == importlib.metadata.version("contactstudy")


def test_a_name_that_is_nearly_right_is_suggested() -> None:
    with pytest.raises(AttributeError, match=r"'solv'; did you mean solve\?"):
        _ = contactstudy.solv
    with pytest.raises(AttributeError, match=r"'xyzzy'$"):
        _ = contactstudy.xyzzy


MODULES = sorted(name for name in contactstudy.__all__ if hasattr(getattr(contactstudy, name), "__path__"))


@pytest.mark.parametrize("module", [*MODULES, "bodies", "case", "heat", "study"])
def test_every_public_package_suggests_the_name_that_is_meant(module: str) -> None:
    package = importlib.import_module(f"contactstudy.{module}")
    for name in package.__all__:
        mistyped = f"{name}e"
        with pytest.raises(
            AttributeError, match=rf"'contactstudy.{module}' has no attribute '{mistyped}'; did you mean"
        ):
            getattr(package, mistyped)
    assert not hasattr(package, "_xyzzy")


def test_the_accessor_suggests_the_name_that_is_meant() -> None:
    assert contactstudy.analysis.MEASURES  # registers the accessor
    accessor = xr.Dataset().contact
    with pytest.raises(AttributeError, match=r"Dataset.contact has no attribute 'edge_presure'; did you mean edge_pre"):
        accessor.edge_presure()
    assert not hasattr(accessor, "_repr_png_")
