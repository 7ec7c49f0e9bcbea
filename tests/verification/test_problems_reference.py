"""A check fails beyond its tolerance and for NaN."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchmarks.convergence import SETTINGS, Table
from contactstudy.verification.problems import Reference
from contactstudy.verification.suite import format_line

FINITE_NUMBERS = st.floats(-1e6, 1e6)


@given(FINITE_NUMBERS, FINITE_NUMBERS, st.floats(0, 1e3))
def test_check_passes_within_tolerance(computed: float, expected: float, tolerance: float) -> None:
    check = Reference("case", "source").compare("quantity", computed, expected, tolerance)
    assert check.passed == (abs(computed - expected) <= tolerance)
    assert format_line(check).startswith("ok" if check.passed else "FAIL")


@given(st.lists(FINITE_NUMBERS, min_size=1, max_size=8), st.integers(0, 7))
def test_difference_of_field_is_largest_difference(expected: list[float], index: int) -> None:
    computed = np.array(expected)
    computed[index % computed.size] += 1.0
    check = Reference("case", "source").compare("field", computed, expected, 0.5)
    assert check.difference == pytest.approx(1.0, abs=1e-6)
    assert not check.passed


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_nan_fails_check(value: float) -> None:
    assert not Reference("case", "source").compare("quantity", value, 1.0, 1e9).passed
    assert not Reference("case", "source").compare("field", [1.0, value], [1.0, 1.0], 1e9).passed
    assert not Reference("case", "source").compare("field", [1.0, 1.0, np.nan], 1.0, 1e9, median=True).passed


def test_convergence_requires_small_error_and_order() -> None:
    def list_failed_quantities(errors: tuple[float, ...]) -> list[str]:
        table = Table(
            title="case",
            setting="cells",
            source="exact",
            values=(8, 16, 32),
            errors={"error": errors},
            value_in_use=32,
            tolerance=0.01,
            order=1.5,
        )
        return [check.quantity for check in table.checks() if not check.passed]

    assert list_failed_quantities((0.16, 0.04, 0.01)) == []
    assert list_failed_quantities((0.016, 0.014, 0.012)) == [
        "error, error",
        "order in the cells, at least 1.5, shortfall",
    ]
    assert len(list_failed_quantities((0.001, 0.001, 0.001))) == 1


def test_check_fails_for_each_quadrature_setting() -> None:
    from dataclasses import asdict

    from contactstudy.overlapping.quadrature import Resolution

    defaults = asdict(Resolution())
    assert set(SETTINGS) == set(defaults)
    assert all(defaults[name] in values for name, values in SETTINGS.items())
