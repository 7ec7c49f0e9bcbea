"""Mutants: single changes of signs, factors and comparisons."""

from __future__ import annotations

import ast
import functools

import pytest

from benchmarks.mutation.equivalent import EQUIVALENT
from benchmarks.mutation.mutants import PACKAGES, Mutant, list_mutants, list_mutants_of_function

SOURCE = '''"""A module: 1.5 + 2.5."""
LIMIT = 2.5
def function(x: float | None = -1.5) -> float:
    """Text with 1.0 - 2.0."""
    if x > 1.0:
        raise ValueError(f"{x + 1.0}")
    return (-x  # minus - here
            * (2.0 - x))
'''


def test_mutants_of_source_change_arithmetic_only() -> None:
    mutants = [(mutant.description, len(mutant.lines)) for mutant in list_mutants_of_function("a.py", SOURCE)]
    assert sorted(mutants) == [
        ("* (2.0 - x))  ->  * (2.0 + x))", 2),
        ("* (2.0 - x))  ->  * (2.2 - x))", 2),
        ("* (2.0 - x))  ->  / (2.0 - x))", 2),
        ("if x > 1.0:  ->  if x < 1.0:", 1),
        ("if x > 1.0:  ->  if x > 1.1:", 1),
        ("return (-x  # minus - here  ->  return (+x  # minus - here", 2),
    ]


@pytest.fixture(scope="module")
def mutants() -> list[Mutant]:
    return list_mutants()


def test_every_mutant_is_another_program(mutants: list[Mutant]) -> None:
    assert len(mutants) > 1000
    packages = {"/".join(mutant.file.split("/")[1:-1]) for mutant in mutants}
    assert packages == {*PACKAGES, "contact/normal", "contact/refinement", "contact/rolling"}
    dump = functools.cache(lambda text: ast.dump(ast.parse(text)))
    for mutant in mutants[::25]:
        assert dump(mutant.changed) != dump(mutant.source), mutant


def test_keys_of_mutants_are_unique(mutants: list[Mutant]) -> None:
    assert len({mutant.key for mutant in mutants}) == len(mutants)


def test_equivalent_list_contains_existing_mutants(mutants: list[Mutant]) -> None:
    assert set(EQUIVALENT) <= {mutant.key for mutant in mutants}
    assert all(EQUIVALENT.values())
