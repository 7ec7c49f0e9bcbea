"""Mutants change one sign, factor or comparison where something is computed, and nowhere else."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

from tests.mutation.__main__ import PACKAGES, chosen
from tests.mutation.mutants import Mutant, all_mutants, mutants_of
from tests.mutation.trial import ROOT

SOURCE = '''"""A module: 1.5 + 2.5."""
LIMIT = 2.5
def function(x: float | None = -1.5) -> float:
    """Text with 1.0 - 2.0."""
    if x > 1.0:
        raise ValueError(f"{x + 1.0}")
    return (-x  # minus - here
            * (2.0 - x))
'''


def test_what_is_changed() -> None:
    shown = [mutant.shown for mutant in mutants_of("a.py", SOURCE)]
    assert sorted(shown) == sorted(
        [
            "if x > 1.0:  ->  if x < 1.0:",
            "if x > 1.0:  ->  if x > 1.1:",
            "return (-x  # minus - here  ->  return (+x  # minus - here",
            "* (2.0 - x))  ->  / (2.0 - x))",
            "* (2.0 - x))  ->  * (2.2 - x))",
            "* (2.0 - x))  ->  * (2.0 + x))",
        ]
    )


@pytest.fixture(scope="module")
def mutants() -> list[Mutant]:
    return all_mutants(ROOT, PACKAGES)


def test_every_mutant_is_another_program(mutants: list[Mutant]) -> None:
    assert len(mutants) > 1000
    for mutant in mutants[::25]:
        source = (ROOT / mutant.file).read_text(encoding="utf-8")
        changed = mutant.applied(source)
        assert ast.dump(ast.parse(changed)) != ast.dump(ast.parse(source)), mutant


def test_a_sample_takes_every_source_in_turn(mutants: list[Mutant]) -> None:
    files = {mutant.file for mutant in mutants}
    first, more = chosen(mutants, len(files)), chosen(mutants, 2 * len(files))
    assert {mutant.file for mutant in first} == files
    assert more[: len(files)] == first
    assert {Path(mutant.file).parent.name for mutant in first} == set(PACKAGES)
