"""The certificate states each violation of a contact's conditions separately, over the violation's scale."""

from __future__ import annotations

from dataclasses import asdict

import numpy as np
import pytest

from contactstudy.contact.normal.contact import CONVERGED_TOLERANCES, OPEN_TOLERANCES, Certificate, certify

TOLERANCE = 1e-6
DISPLACEMENT = 3e-5 * np.array([[1.0, 2.0, 3.0]])  # the variation is 6e-5
VARIATION = 6e-5
PRESSURE = 1e9 * np.array([[0.0, 0.5, 2.0]])


def certificate(
    opening: list[float], *, pressure: np.ndarray = PRESSURE, carried_load: float = 5.0, **overrides
) -> Certificate:
    """Certificate of a contact with a gap `opening` over the variation of the displacement."""
    arguments = {"load": 5.0, "position_error": 0.0} | overrides
    gap = VARIATION * np.array([opening])
    return certify(pressure, gap, DISPLACEMENT, carried_load=carried_load, tolerance=TOLERANCE, **arguments)


def test_exact_contact_has_no_violations() -> None:
    assert set(asdict(certificate([0.3, 0.0, 0.0])).values()) == {0.0}
    assert certificate([0.3, 0.0, 0.0]).holds(TOLERANCE)
    assert certificate([np.inf, 0.0, 0.0]).holds(TOLERANCE)


@pytest.mark.parametrize("opening", [[0.3, 2e-3, 0.0], [0.3, -2e-3, 0.0], [-2e-3, 0.0, 1e-3]])
def test_gaps_and_overlaps_are_violations(opening: list[float]) -> None:
    assert certificate(opening).penetration_error == pytest.approx(2e-3)
    assert not certificate(opening).holds(TOLERANCE)


def test_open_pressure_begins_beyond_tolerances() -> None:
    for factor, error in ((0.5, 0.0), (1.5, 0.25)):
        opening = [0.3, factor * OPEN_TOLERANCES * TOLERANCE, 0.0]
        assert certificate(opening).open_pressure_error == pytest.approx(error)
    assert not certificate([0.3, 1.5 * OPEN_TOLERANCES * TOLERANCE, 0.0]).holds(TOLERANCE)


def test_load_errors_measure_size_and_position() -> None:
    assert certificate([0.3, 0.0, 0.0], carried_load=5.5).load_error == pytest.approx(0.1)
    assert certificate([0.3, 0.0, 0.0], carried_load=4.5).load_error == pytest.approx(-0.1)
    assert certificate([0.3, 0.0, 0.0], carried_load=5.5, load=None).load_error == 0.0
    assert certificate([0.3, 0.0, 0.0], position_error=0.2).load_position_error == 0.2


@pytest.mark.parametrize("name", ["load_error", "penetration_error", "open_pressure_error", "load_position_error"])
@pytest.mark.parametrize("sign", [1, -1])
def test_certificate_fails_beyond_bound(name: str, sign: int) -> None:
    complete = asdict(certificate([0.3, 0.0, 0.0]))
    bound = CONVERGED_TOLERANCES * TOLERANCE
    assert Certificate(**(complete | {name: 0.9 * sign * bound})).holds(TOLERANCE)
    assert not Certificate(**(complete | {name: 1.1 * sign * bound})).holds(TOLERANCE)
