"""The server listens before the study is read, fills the page when it is, and ends with the reason if it cannot be."""

from __future__ import annotations

import gc
import json
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("panel")

from contactstudy import ContactStudyError, InvalidInputError
from contactstudy.explorer import serve
from contactstudy.study import StudyFileError

WITHOUT = """
import sys
import contactstudy.cli, contactstudy.explorer
slow = {"numpy", "pandas", "xarray", "panel"} & set(sys.modules)
assert slow <= {"numpy"}, slow
"""

WITHOUT_DASK = """
import sys
sys.modules["dask"] = None
from contactstudy.explorer.cases import of_folder
from contactstudy.explorer.page import Page
page = Page(of_folder(sys.argv[1]))
page.choices[0]["max_pressure"].value = 2
assert ">1.5 GPa<" in page.table.object
page.view()
assert "distributed" not in sys.modules
"""


def test_the_page_of_a_folder_does_without_dask(folder: Path) -> None:
    subprocess.run([sys.executable, "-c", WITHOUT_DASK, str(folder)], check=True)


def test_it_starts_without_what_takes_long_to_import() -> None:
    subprocess.run([sys.executable, "-c", WITHOUT], check=True)


def test_a_folder_without_a_study_is_refused_before_anything_is_served(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(StudyFileError, match=r"holds no study\.json"):
        serve(tmp_path, show=False)
    with pytest.raises(StudyFileError, match="there is no such folder"):
        serve(tmp_path / "nowhere", show=False)
    with pytest.raises(InvalidInputError, match="folder"):
        serve(3, show=False)  # type: ignore[arg-type]
    assert capsys.readouterr().out == ""


@pytest.mark.parametrize("content", ["{", json.dumps({"name": "wrong", "base": {"no_such_parameter": 1}})])
def test_a_study_that_cannot_be_read_ends_the_server(tmp_path: Path, content: str) -> None:
    (tmp_path / "study.json").write_text(content)
    with pytest.raises(ContactStudyError, match=r"study\.json"):
        serve(tmp_path, show=False)
    assert gc.isenabled()
