"""Notebooks as tests: each notebook runs (nbmake) in an empty folder and contains no stored output."""

from __future__ import annotations

import shutil
import tempfile

import nbformat
import pytest

SLOW_NOTEBOOKS = {"designing_a_profile.ipynb", "rolling.ipynb"}
"""Notebooks that need more than 20 s."""
MAX_BYTES = 30_000
"""Largest size of a notebook without output, bytes."""


def _is_notebook(item: pytest.Item) -> bool:
    return getattr(item, "nbmake", False) is True


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Put notebooks into their tiers."""
    for item in filter(_is_notebook, items):
        item.add_marker(pytest.mark.slow if item.path.name in SLOW_NOTEBOOKS else pytest.mark.system)
        # Warnings of Jupyter's event loop are ignored.
        item.add_marker(pytest.mark.filterwarnings("ignore"))


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item: pytest.Item):
    """Check the stored notebook, and run a copy in an empty folder."""
    if not _is_notebook(item):
        return (yield)
    notebook = nbformat.read(item.path, as_version=4)
    nbformat.validate(notebook)
    for cell in notebook.cells:
        assert not cell.get("outputs"), "clear the outputs before committing"
        assert cell.get("execution_count") is None, "clear the outputs before committing"
    assert item.path.stat().st_size < MAX_BYTES
    folder = tempfile.mkdtemp(prefix="contactstudy-notebook-")
    try:
        item.filename = shutil.copy(item.path, folder)  # type: ignore[attr-defined]
        with pytest.MonkeyPatch.context() as patch:
            patch.delenv("MPLBACKEND", raising=False)  # figures are drawn into the notebook
            return (yield)
    finally:
        shutil.rmtree(folder)
