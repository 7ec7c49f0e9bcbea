"""The best profile of a solved roller against a scan."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contactstudy import Case, HalfSpace, Material, Roller, profiles, solve
from contactstudy.design import best_profile


def test_best_crown_has_lower_peak_than_scan() -> None:
    case = Case(
        body=HalfSpace(material=Material(210e9, 0.3)), roller=Roller(radius=5e-3, length=0.3e-3), max_pressure=1.5e9
    )
    result = best_profile(case, profiles.Lundberg, bounds={"amplitude": (0.05e-6, 1e-6)}, accuracy=0.05, evaluations=20)
    assert result.measure.attrs["units"] == "Pa"
    assert result.parameter_units.item() == "m"

    def solve_peak(amplitude: float) -> float:
        roller = replace(case.roller, profile=profiles.Lundberg(amplitude))
        return float(solve(replace(case, roller=roller), stresses=False, accuracy=0.05).peak_pressure)

    best_measure, margin = float(result.measure), 2 * float(result.measure_error)
    low, high = float(result.flat_from[0]), float(result.flat_to[0])
    scan = {amplitude: solve_peak(amplitude) for amplitude in np.geomspace(0.05e-6, 1e-6, 7)}
    assert best_measure < min(scan.values()) + margin
    scanned_peaks_outside = [value for amplitude, value in scan.items() if not 0.9 * low < amplitude < 1.1 * high]
    assert min(scanned_peaks_outside) > best_measure
    assert max(solve_peak(low), solve_peak(high)) < best_measure + 1.2 * margin
