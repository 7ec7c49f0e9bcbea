"""The physics: every check of `contactstudy verify` is a test under the check's name."""

from __future__ import annotations

import functools
import itertools

import pytest

from contactstudy.verification import Verification, suite
from contactstudy.verification.problems import Check
from tests.verification import check_names

LISTED = check_names.read()
LONG = {entry.group for entry in LISTED if entry.level == "full"}
"""Groups with further checks at the full level: the slow tier runs this level, which contains the quick one."""
FULL = [entry for entry in LISTED if entry.group in LONG]
TIGHTER = {
    "six stresses / p0, z >= 0.1a, largest difference": 1e-3,
    "six stresses / p0, z >= 0.1a, median difference": 3e-6,
    "traction on the ends / p0, z = 0.02a, 0.05a": 1e-5,
    "traction on the ends / p0, z >= 0.1a": 1e-5,
}
"""Bounds near the computed differences, tighter than the suite's tolerances."""


@functools.cache
def quick(group: str) -> dict[tuple[str, str], Check]:
    """Checks of a group at the quick level."""
    checks = list(itertools.chain.from_iterable(suite.GROUPS[group](False)))
    check_of_name = {(check.case, check.quantity): check for check in checks}
    assert len(check_of_name) == len(checks), "two checks have one name"
    return check_of_name


@functools.cache
def full_verification() -> Verification:
    """The full level, without the groups equal to the quick level's."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(suite, "GROUPS", {name: make for name, make in suite.GROUPS.items() if name in LONG})
        return suite.run("full")


def assert_check_passed(check: Check) -> None:
    """Fail with the line that the command prints."""
    assert check.passed, suite.format_line(check)
    assert check.source
    assert abs(check.difference) <= TIGHTER.get(check.quantity, check.tolerance), suite.format_line(check)


def parameters(*, slow: bool) -> list[object]:
    """Checks of the default or the slow tier under their names."""
    return [pytest.param(entry, id=entry.name) for entry in LISTED if (entry.group in LONG) == slow]


@pytest.mark.parametrize("entry", parameters(slow=False))
def test_check(entry: check_names.ListedCheck) -> None:
    assert_check_passed(quick(entry.group)[entry.case, entry.quantity])


@pytest.mark.slow
@pytest.mark.parametrize("entry", parameters(slow=True))
def test_full_level_check_passes(entry: check_names.ListedCheck) -> None:
    (check,) = [
        c for c in full_verification().groups[entry.group] if (c.case, c.quantity) == (entry.case, entry.quantity)
    ]
    assert_check_passed(check)


@pytest.mark.parametrize("group", [group for group in suite.GROUPS if group not in LONG])
def test_list_contains_all_checks(group: str) -> None:
    entries = [(entry.case, entry.quantity) for entry in LISTED if (entry.level, entry.group) == ("quick", group)]
    assert entries
    assert sorted(entries) == sorted(quick(group))


@pytest.mark.slow
def test_list_contains_all_full_checks() -> None:
    assert sorted(entry[1:] for entry in FULL) == sorted(check_names.names(full_verification()))
    data = full_verification().to_dataset()
    assert bool(data["passed"].all())
    assert data.sizes["check"] == len(FULL)
