"""Notebooks as tests: each runs from end to end (nbmake) in an empty folder; none contains stored output."""

from __future__ import annotations

import shutil
import tempfile

import nbformat
import pytest

SLOW = {"designing_a_profile.ipynb", "rolling.ipynb"}
"""Notebooks that need more than 20 s."""
LARGEST = 30_000
"""Largest size of a notebook, bytes; a notebook without output is smaller."""


def _is_notebook(item: pytest.Item) -> bool:
    return getattr(item, "nbmake", False) is True


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Put notebooks into their tiers."""
    for item in filter(_is_notebook, items):
        item.add_marker(pytest.mark.slow if item.path.name in SLOW else pytest.mark.system)
        # Warnings of Jupyter's event loop are ignored; in the notebook errors remain errors.
        item.add_marker(pytest.mark.filterwarnings("ignore"))


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item: pytest.Item):
    """Check the stored notebook, and run a copy in an empty folder."""
    if not _is_notebook(item):
        return (yield)
    stored_case = nbformat.read(item.path, as_version=4)
    nbformat.validate(stored_case)
    for cell in stored_case.cells:
        assert not cell.get("outputs"), "clear the outputs before committing"
        assert cell.get("execution_count") is None, "clear the outputs before committing"
    assert item.path.stat().st_size < LARGEST
    folder = tempfile.mkdtemp(prefix="contactstudy-notebook-")
    try:
        item.filename = shutil.copy(item.path, folder)  # type: ignore[attr-defined]
        with pytest.MonkeyPatch.context() as patch:
            patch.delenv("MPLBACKEND", raising=False)  # figures are drawn into the notebook
            return (yield)
    finally:
        shutil.rmtree(folder)
