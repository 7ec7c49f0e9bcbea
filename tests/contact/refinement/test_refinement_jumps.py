"""Jumps of the pressure that mark columns for splitting."""

from __future__ import annotations

import numpy as np
import pytest

from contactstudy.contact.refinement.refinement import MIN_HALF_PRESSURE, _crest_jumps, _power_jumps


def test_low_crest_jumps_relative_to_own_pressure() -> None:
    """A crest of one column with the pressure 1.4, near an end of a contact of peak 3, has a jump relative to 1.4."""
    section_peaks = np.array([0.0, 0.0, 0.8, 1.4, 1.2, 2.0, 2.8, 3.0, 3.0, 2.8])
    steps = _crest_jumps(section_peaks[:, None])
    assert steps[3] == pytest.approx(1 - (0.8 / 1.4) ** 2)
    assert np.count_nonzero(steps) == 1
    # A crest below a tenth of the peak has no jump, and noise on a plateau is no crest.
    assert not _crest_jumps(np.array([0.0, 0.1, 0.29, 0.2, 3.0, 3.0])[:, None]).any()
    assert _crest_jumps(np.array([3.0, 3.001, 3.0])[:, None]).max() < 1e-2


@pytest.mark.parametrize("height_ratio", [0.5, 0.02])
def test_jumps_are_relative_to_half_peak(height_ratio: float) -> None:
    """The jump of the squared pressure is over the half's peak, at least a fraction of the largest pressure."""
    rng = np.random.default_rng(0)
    edges = np.array([3.0, 4.0, 4.5, 5.5, 6.0, 7.0, 8.0, 9.0, 10.0])
    left_columns = np.array([0, 1, 2, 3])  # The middle, 6.5, is the centre of the fifth column.
    pressure = rng.uniform(0.5, 1.0, (8, 5))
    pressure[left_columns] *= height_ratio
    computed = _power_jumps(edges, pressure, 2.0)
    for i in range(8):
        cell_pressure = pressure[left_columns] if i in left_columns else pressure[4:]
        section_peaks = max(cell_pressure.max(), MIN_HALF_PRESSURE * pressure.max())
        steps = [np.abs(pressure[i] ** 2 - pressure[j] ** 2).max() for j in (i - 1, i + 1) if 0 <= j < 8]
        assert computed[i] == pytest.approx(max(steps) / section_peaks**2)
