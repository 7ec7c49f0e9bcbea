"""The best profile of a real roller against a scan."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from contactstudy import Case, HalfSpace, Material, Roller, profiles, solve
from contactstudy.design import best_profile


def test_the_best_crown_against_a_scan() -> None:
    case = Case(
        body=HalfSpace(material=Material(210e9, 0.3)), roller=Roller(radius=5e-3, length=0.3e-3), max_pressure=1.5e9
    )
    found = best_profile(case, profiles.Lundberg, bounds={"amplitude": (0.05e-6, 1e-6)}, accuracy=0.02, evaluations=20)
    assert found.measure.attrs["units"] == "Pa"
    assert found.parameter_units.item() == "m"

    def peak(amplitude: float) -> float:
        roller = replace(case.roller, profile=profiles.Lundberg(amplitude))
        return float(solve(replace(case, roller=roller), stresses=False, accuracy=0.02).peak_pressure)

    least, room = float(found.measure), 2 * float(found.measure_error)
    low, high = float(found.flat_from[0]), float(found.flat_to[0])
    scan = {amplitude: peak(amplitude) for amplitude in np.geomspace(0.05e-6, 1e-6, 7)}
    assert least < min(scan.values()) + room
    outside = [value for amplitude, value in scan.items() if not 0.9 * low < amplitude < 1.1 * high]
    assert min(outside) > least
    assert max(peak(low), peak(high)) < least + 1.2 * room
