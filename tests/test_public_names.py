"""Public names of the package, and the modules that its import loads."""

from __future__ import annotations

import importlib
import importlib.metadata
import subprocess
import sys
from pathlib import Path

import pytest

import contactstudy


@pytest.mark.system
@pytest.mark.parametrize(
    ("module", "heavy_modules"),
    [
        ("contactstudy", {"numpy", "xarray", "scipy", "matplotlib", "dask"}),
        ("contactstudy.study.worker", {"scipy.interpolate", "scipy.optimize", "matplotlib", "distributed"}),
    ],
)
def test_import_avoids_heavy_modules(module: str, heavy_modules: set[str]) -> None:
    code = f"import {module}, sys; print(sorted({heavy_modules} & set(sys.modules)))"
    finished_process = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert finished_process.stdout.strip() == "[]"


def test_every_public_name_can_be_imported() -> None:
    for name in contactstudy.__all__:
        assert getattr(contactstudy, name) is not None
    assert sorted(contactstudy.__all__) == contactstudy.__all__


def test_modules_do_not_hide_public_names() -> None:
    """Importing a submodule overwrites a package attribute of the same name."""
    modules = {path.stem for path in Path(contactstudy.__file__).parent.iterdir()}
    hidden_names = modules & set(contactstudy.__all__)
    assert {"analysis", "plots", "profiles"} <= hidden_names
    for name in hidden_names:
        assert getattr(contactstudy, name) is importlib.import_module(f"contactstudy.{name}"), name


def test_version_matches_installation() -> None:
    assert contactstudy.__version__ == importlib.metadata.version("contactstudy")


def test_python_suggests_public_names_not_yet_imported() -> None:
    code = "import contactstudy; contactstudy.solv"
    finished_process = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert "Did you mean: 'solve'" in finished_process.stderr
