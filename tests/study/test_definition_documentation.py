"""docs/reference/study_file.md has a valid study file and all levels; files in docs/ pages exist."""

import re
import tomllib

from contactstudy.study import Study
from contactstudy.study.definition import KEYS
from contactstudy.study.plan import LEVELS
from tests.study.conftest import ROOT

REFERENCE = (ROOT / "docs" / "reference" / "study_file.md").read_text()
TUTORIAL = (ROOT / "docs" / "tutorial" / "first_study.md").read_text()


def list_code_blocks(text, language):
    return re.findall(rf"```{language}\n(.*?)```", text, re.DOTALL)


def test_documented_example_is_study():
    first_block, single_block, _ = (tomllib.loads(block) for block in list_code_blocks(REFERENCE, "toml"))
    assert {*first_block, *single_block} == set(KEYS)
    plan = Study.from_mapping(first_block).plan()
    assert (plan.cube.dims, len(plan), plan.skipped) == (("friction", "profile", "max_pressure"), 6, [])
    assert len(Study.from_mapping(first_block | single_block).plan().unique) == 7


def test_every_level_is_explained():
    for name in LEVELS:
        assert f"| `{name}` |" in REFERENCE, name


def test_tutorial_file_equals_python_study():
    namespace = {}
    source = list_code_blocks(TUTORIAL, "python")[0]
    exec(source[: source.index("report =")], namespace)
    file_study = Study.from_mapping(tomllib.loads(list_code_blocks(TUTORIAL, "toml")[0]))
    assert [case.id for case in file_study.plan()] == [case.id for case in namespace["study"].plan()]


def test_named_files_exist():
    for page in (ROOT / "docs").rglob("*.md"):
        for name in re.findall(r"(?:tests|studies|contactstudy|docs)/[\w/]+\.(?:py|toml|md)", page.read_text()):
            assert (ROOT / name).exists(), (page.name, name)
