"""A short run of random cases by `pytest -m fuzz`; the command for long runs is `python -m benchmarks.fuzz`."""

from __future__ import annotations

from random import Random

import pytest
from hypothesis import HealthCheck, event, given, settings
from hypothesis import strategies as st

from benchmarks.fuzz.outcome import classify_outcome

FUZZ_SETTINGS = settings(suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large])


def check_outcome(rng: Random, *, refined: bool) -> None:
    """Solve a random case; its outcome is no violation."""
    outcome = classify_outcome(rng, refined=refined)
    event(outcome.kind)
    assert outcome.kind != "violation", outcome.message


@pytest.mark.fuzz
@settings(FUZZ_SETTINGS, max_examples=6)
@given(st.randoms(use_true_random=False))
def test_random_cases_on_given_cells_have_no_violation(rng: Random) -> None:
    check_outcome(rng, refined=False)


@pytest.mark.fuzz
@settings(FUZZ_SETTINGS, max_examples=2)
@given(st.randoms(use_true_random=False))
def test_random_cases_on_refined_cells_have_no_violation(rng: Random) -> None:
    check_outcome(rng, refined=True)


def test_seed_determines_case() -> None:
    first_case, second_case = (classify_outcome(Random(9)) for _ in range(2))
    assert (first_case.kind, first_case.message, first_case.checked) == (
        second_case.kind,
        second_case.message,
        second_case.checked,
    )
    assert first_case.kind == "converged"
    assert len(first_case.checked) >= 5
