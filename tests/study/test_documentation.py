"""docs/studies.md: its study is one, its tables are complete, its code runs."""

import re
import tomllib

import pytest

from contactstudy.cli import main
from contactstudy.study import Study
from contactstudy.study.definition import KEYS
from contactstudy.study.parameters import PARAMETERS, documented
from contactstudy.study.plan import LEVELS
from tests.study.conftest import ROOT
from tests.study.fakes import solve_fake

TEXT = (ROOT / "docs" / "studies.md").read_text()


def blocks(language):
    return re.findall(rf"```{language}\n(.*?)```", TEXT, re.DOTALL)


def test_the_example_is_a_study():
    first, single, _ = (tomllib.loads(block) for block in blocks("toml"))
    assert {*first, *single} == set(KEYS)
    plan = Study.from_mapping(first).plan()
    assert (plan.cube.dims, len(plan.cases), plan.skipped) == (("friction", "profile", "max_pressure"), 6, ())
    assert len(Study.from_mapping(first | single).plan().unique) == 7


def test_every_key_parameter_and_level_is_explained():
    for name in (*PARAMETERS, *LEVELS):
        assert f"`{name}`" in TEXT, name


def test_the_table_of_parameters_is_made_from_the_code():
    """`python -c "from contactstudy.study.parameters import documented; print(documented())"` makes it anew."""
    assert documented() in TEXT


def test_the_results_are_read_as_shown(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "studies").mkdir()
    (tmp_path / "studies" / "ends.toml").write_text(blocks("toml")[0])
    assert main(["run", "studies/ends.toml", "--workers", "0"], solver=solve_fake) == 0
    import contactstudy as cs

    names = {"cs": cs}
    exec(blocks("python")[-1], names)
    assert float(names["axial"].max()) > 1e9
    assert names["axial"]["distance"].attrs["units"] == "1"
    pytest.importorskip("h5py")
    path = next((tmp_path / "results" / "ends" / "cases").glob("*.nc"))
    exec(blocks("python")[-2], {"path": path})


def test_code_that_needs_other_machines_is_python():
    for block in blocks("python"):
        compile(block, "studies.md", "exec")


def test_named_files_exist():
    for name in re.findall(r"tests/[\w/]+\.py", TEXT):
        assert (ROOT / name).exists(), name
