"""docs/studies.md: its study is one, its tables are complete, its code runs."""

import re
import tomllib

from contactstudy.study import Study
from contactstudy.study.definition import KEYS
from contactstudy.study.parameters import PARAMETERS
from contactstudy.study.plan import LEVELS
from tests.documentation.pages import page
from tests.study.conftest import ROOT

TEXT = page("studies").read_text()


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


def test_defaults_are_those_of_the_code():
    rows = dict(re.findall(r"^\| (`[^|]+`) \| ([^|]*) \|", TEXT, re.MULTILINE))
    for names, default in rows.items():
        for name, value in zip(re.findall(r"`(\w+)`", names), default.strip(" `").split(", "), strict=False):
            if name in PARAMETERS and isinstance(PARAMETERS[name].default, (float, bool, str)):
                parsed = value if isinstance(PARAMETERS[name].default, str) else tomllib.loads(f"x = {value}")["x"]
                assert parsed == PARAMETERS[name].default, name


def test_named_files_exist():
    for name in re.findall(r"tests/[\w/]+\.py", TEXT):
        assert (ROOT / name).exists(), name
