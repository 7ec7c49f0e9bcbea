"""A short run of random cases: `pytest -m fuzz`; `python -m benchmarks.fuzz` makes long ones."""

from __future__ import annotations

from random import Random

import pytest
from hypothesis import HealthCheck, event, given, settings
from hypothesis import strategies as st

from benchmarks.fuzz.outcome import outcome_of

SHORT = settings(suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large])


def look_at(rng: Random, *, refined: bool) -> None:
    """Run a case and count its outcome."""
    outcome = outcome_of(rng, refined=refined)
    event(outcome.kind)
    assert outcome.kind != "violation", outcome.message


@pytest.mark.fuzz
@settings(SHORT, max_examples=6)
@given(st.randoms(use_true_random=False))
def test_cases_on_given_cells(rng: Random) -> None:
    look_at(rng, refined=False)


@pytest.mark.fuzz
@settings(SHORT, max_examples=2)
@given(st.randoms(use_true_random=False))
def test_cases_on_refined_cells(rng: Random) -> None:
    look_at(rng, refined=True)


def test_seed_determines_case() -> None:
    first_case, second_case = (outcome_of(Random(9)) for _ in range(2))
    assert (first_case.kind, first_case.message, first_case.checked) == (
        second_case.kind,
        second_case.message,
        second_case.checked,
    )
    assert first_case.kind == "converged"
    assert len(first_case.checked) >= 5
