"""Every check of `contactstudy verify` is a test with the name of the check."""

from __future__ import annotations

import functools
import itertools

import pytest

from contactstudy.verification import Verification, suite
from contactstudy.verification.problems import Check
from tests.verification import check_names

CHECKS = check_names.read_list()
FULL_LEVEL_GROUPS = {entry.group for entry in CHECKS if entry.level == "full"}
"""Groups with more checks at the full level; the slow tier runs this level."""
FULL_LEVEL_CHECKS = [entry for entry in CHECKS if entry.group in FULL_LEVEL_GROUPS]
TIGHT_TOLERANCES = {
    "six stresses / p0, z >= 0.1a, largest difference": 1e-3,
    "six stresses / p0, z >= 0.1a, median difference": 3e-6,
    "traction on the ends / p0, z = 0.02a, 0.05a": 1e-5,
    "traction on the ends / p0, z >= 0.1a": 1e-5,
}
"""Tolerances smaller than those of the suite."""


@functools.cache
def run_quick_level(group: str) -> dict[tuple[str, str], Check]:
    """Checks of a group at the quick level."""
    checks = list(itertools.chain.from_iterable(suite.GROUPS[group](False)))
    checks_by_name = {(check.case, check.quantity): check for check in checks}
    assert len(checks_by_name) == len(checks), "two checks have one name"
    return checks_by_name


@functools.cache
def run_full_level() -> Verification:
    """Checks of the full level, for groups with more checks than at the quick level."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(
            suite,
            "GROUPS",
            {name: make_checks for name, make_checks in suite.GROUPS.items() if name in FULL_LEVEL_GROUPS},
        )
        return suite.run("full")


def assert_check_passed(check: Check) -> None:
    """Fail with the line that the command prints."""
    assert check.passed, suite.format_line(check)
    assert check.source
    assert abs(check.difference) <= TIGHT_TOLERANCES.get(check.quantity, check.tolerance), suite.format_line(check)


def make_parameters(*, slow: bool) -> list[object]:
    """Checks of the default or the slow tier, as test parameters."""
    return [pytest.param(entry, id=entry.name) for entry in CHECKS if (entry.group in FULL_LEVEL_GROUPS) == slow]


@pytest.mark.parametrize("entry", make_parameters(slow=False))
def test_quick_level_check_passes(entry: check_names.ListedCheck) -> None:
    assert_check_passed(run_quick_level(entry.group)[entry.case, entry.quantity])


@pytest.mark.slow
@pytest.mark.parametrize("entry", make_parameters(slow=True))
def test_full_level_check_passes(entry: check_names.ListedCheck) -> None:
    (check,) = [
        candidate
        for candidate in run_full_level().groups[entry.group]
        if (candidate.case, candidate.quantity) == (entry.case, entry.quantity)
    ]
    assert_check_passed(check)


@pytest.mark.parametrize("group", [group for group in suite.GROUPS if group not in FULL_LEVEL_GROUPS])
def test_list_contains_all_checks(group: str) -> None:
    entries = [(entry.case, entry.quantity) for entry in CHECKS if (entry.level, entry.group) == ("quick", group)]
    assert entries
    assert sorted(entries) == sorted(run_quick_level(group))


@pytest.mark.slow
def test_list_contains_all_full_checks() -> None:
    assert sorted(entry[1:] for entry in FULL_LEVEL_CHECKS) == sorted(check_names.list_names(run_full_level()))
    data = run_full_level().to_dataset()
    assert bool(data["passed"].all())
    assert data.sizes["check"] == len(FULL_LEVEL_CHECKS)
