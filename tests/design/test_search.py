"""The search on measures in closed form: nothing is solved."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from contactstudy import Case, HalfSpace, InvalidInputError, Material, Roller, profiles
from contactstudy.design import BoundWarning, best_profile

CASE = Case(body=HalfSpace(material=Material(210e9, 0.3)), roller=Roller(radius=5e-3, length=1e-3), max_pressure=1e9)
ERROR = 0.01


@pytest.fixture
def solves(monkeypatch: pytest.MonkeyPatch):
    """Put a function of the profile's two parameters, the load and the tilt in the place of the solver."""

    def install(function):
        def solve(case: Case, **settings: object) -> xr.Dataset:
            own = case.roller.profile
            value = function(own.edge_drop, own.k1, case)
            result = xr.Dataset({"peak_pressure": value, "peak_pressure_error": ERROR, "tilt": case.tilt})
            result["peak_pressure"].attrs["units"] = "Pa"
            return result

        monkeypatch.setattr("contactstudy.design.search.solve", solve)

    return install


def made(edge_drop: float, k1: float = 1.0) -> profiles.Profile:
    return profiles.FujiwaraKawase(1e-6, edge_drop, k1)


ONE = {"edge_drop": (1e-6, 1e-4)}
BOTH = {"edge_drop": (1e-6, 1e-4), "k1": (0.5, 4.0)}


def test_smooth_optimum(solves) -> None:
    """Measure 1 + 4 s**2 in decades s: worse by two errors of 0.01 at s = 0.0707."""
    solves(lambda drop, k1, case: 1 + 4 * np.log10(drop / 2e-5) ** 2)
    found = best_profile(CASE, made, bounds=ONE)
    assert float(np.log10(found.optimum[0] / 2e-5)) == pytest.approx(0.0, abs=0.03)
    ends = np.log10(np.array([found.flat_from[0], found.flat_to[0]]) / 2e-5)
    np.testing.assert_allclose(ends, [-0.0707, 0.0707], atol=0.045)
    assert float(found.measure) == pytest.approx(1.0, abs=0.005)
    assert float(found.measure_error) == ERROR
    assert found.measure.attrs["units"] == "Pa"
    assert found.sizes["evaluation"] < 30
    assert float(found.design_measure.min()) == float(found.measure)


@pytest.mark.parametrize("most", [8, 9, 12, 16, 60])
def test_the_number_of_designs_is_bounded(solves, most: int) -> None:
    solves(lambda drop, k1, case: 1 + 4 * np.log10(drop / 2e-5) ** 2)
    assert best_profile(CASE, made, bounds=ONE, evaluations=most).sizes["evaluation"] <= most
    solves(lambda drop, k1, case: 1 + np.log10(drop / 1e-5) ** 2 + 2 * (k1 - 2.0) ** 2)
    result = best_profile(CASE, made, bounds=BOTH, evaluations=most + 1)
    assert result.sizes["evaluation"] <= most + 1
    assert (result.flat_from <= result.optimum).all()


def test_a_kink_between_two_cases(solves) -> None:
    """One load wants less, the other more: the optimum is where both are equal."""
    slopes = {50.0: 1.0, 100.0: -2.0}
    solves(lambda drop, k1, case: 3 + slopes[case.normal_load] * np.log10(drop / 1e-5))
    found = best_profile(CASE, made, bounds=ONE, loads=list(slopes))
    assert float(np.log10(found.optimum[0] / 1e-5)) == pytest.approx(0.0, abs=0.02)
    assert found.case_load.values.tolist() == [50.0, 100.0]
    np.testing.assert_allclose(found.case_measure.max("case"), found.design_measure)
    # Towards less the second case rises twice as fast.
    ends = np.abs(np.log10(np.array([found.flat_from[0], found.flat_to[0]]) / float(found.optimum[0])))
    assert (ends < 0.08).all()


def test_two_parameters(solves) -> None:
    solves(lambda drop, k1, case: 1 + np.log10(drop / 1e-5) ** 2 + 2 * (k1 - 2.0 + 0.5 * np.log10(drop / 1e-5)) ** 2)
    found = best_profile(CASE, made, bounds=BOTH, evaluations=80)
    values = found.optimum.to_series()
    assert np.log10(values["edge_drop"] / 1e-5) == pytest.approx(0.0, abs=0.1)
    assert values["k1"] == pytest.approx(2.0, abs=0.15)
    assert made(**values).k1 == values["k1"]
    assert found.flat_from.sel(parameter="k1") < values["k1"] < found.flat_to.sel(parameter="k1")


def test_brute_force_finds_nothing_better(solves) -> None:
    def bumpy(drop: float, k1: float, case: Case) -> float:
        s = np.log10(drop / 1e-6) / 2
        return float(2 + np.cos(5 * s) + 1.5 * s)

    solves(bumpy)
    found = best_profile(CASE, made, bounds=ONE)
    scan = min(bumpy(drop, 1.0, CASE) for drop in np.geomspace(1e-6, 1e-4, 2001))
    assert float(found.measure) == pytest.approx(scan, abs=ERROR)


def test_infinite_measures_and_impossible_profiles(solves) -> None:
    def singular(drop: float, k1: float, case: Case) -> float:
        if drop > 5e-5:
            raise InvalidInputError("profile", drop, "smaller")
        return np.inf if drop < 1e-5 else 1 + np.log10(drop / 1.5e-5) ** 2

    solves(singular)
    found = best_profile(CASE, made, bounds=ONE)
    assert float(found.optimum[0]) == pytest.approx(1.5e-5, rel=0.15)
    assert 0.9e-5 < float(found.flat_from[0]) <= float(found.flat_to[0]) < 5e-5
    assert np.isinf(found.design_measure).any()


def test_optimum_on_a_bound(solves) -> None:
    solves(lambda drop, k1, case: 1 + np.log10(drop / 1e-6))
    with pytest.warns(BoundWarning, match=r"the best edge_drop = 1e-06 lies at a bound \(1e-06 to 0.0001\)"):
        found = best_profile(CASE, made, bounds=ONE)
    assert float(found.flat_from[0]) == pytest.approx(float(found.lower_bound[0]))
    assert found.at_bound.values.tolist() == [True]


def test_tilts_and_errors_of_functions(solves) -> None:
    solves(lambda drop, k1, case: 1.0 + abs(case.tilt))
    found = best_profile(
        CASE,
        made,
        bounds=ONE,
        measure=lambda result: (2 * result.peak_pressure, 0.5),
        max_pressures=[1e9, 2e9],
        tilts=[0.0, 1e-3],
        evaluations=8,
    )
    assert found.sizes["case"] == 4
    assert float(found.measure) == pytest.approx(2.002)
    assert float(found.measure_error) == 0.5
    # All is as good as the best, so nothing is said of the bounds.
    assert not found.at_bound.any()
    assert float(found.flat_from[0]) == pytest.approx(1e-6)
    assert float(found.flat_to[0]) == pytest.approx(1e-4)
    plain = best_profile(
        CASE, made, bounds=ONE, measure=lambda result: result.peak_pressure, accuracy=0.02, evaluations=8
    )
    assert float(plain.measure_error) == pytest.approx(0.02)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"measure": "peak_pressur"}, "measure = 'peak_pressur': must be one of .*did you mean 'peak_pressure'"),
        ({"measure": lambda result: np.nan}, "measure = nan"),
        ({"measure": 3}, "measure = 3"),
        ({"measure": lambda result: np.ones(3)}, r"measure = 'an array of shape \(3,\)': must be a function that"),
        ({"measure": lambda result: "1"}, "measure = '1': must be a function that returns a number"),
        ({"measure": lambda result: (1.0, 0.1, 2.0)}, r"measure = \(1.0, 0.1, 2.0\): must be a function that returns"),
        ({"evaluations": 3}, "evaluations = 3: must be a whole number not below 8"),
        ({"profile": "Lundberg"}, "profile = 'Lundberg'"),
        ({"bounds": {}}, "bounds = {}"),
        ({"bounds": {"edge_drop": (1e-4, 1e-6)}}, r"bounds\['edge_drop'\]"),
        ({"bounds": {"edge_dorp": (1e-6, 1e-4)}}, r"bounds = \['edge_dorp'\]: must be of the keywords.*edge_dorp"),
        ({"bounds": {"edge_drop": 1e-6}}, r"bounds\['edge_drop'\]"),
        ({"loads": [1.0], "max_pressures": [1e9]}, "loads, max_pressures"),
        ({"tilts": [1.0]}, "tilt = 1.0: must be a small angle"),
        ({"accuracy": 0.5}, "accuracy = 0.5"),
        ({"evaluations": 1}, "evaluations = 1"),
        ({"measure": lambda result: np.inf}, "finite somewhere"),
    ],
)
def test_bad_arguments_are_named(solves, arguments, message: str) -> None:
    solves(lambda drop, k1, case: 1.0)
    with pytest.raises(InvalidInputError, match=message):
        best_profile(**({"case": CASE, "profile": made, "bounds": ONE} | arguments))


def test_no_possible_profile(solves) -> None:
    solves(lambda drop, k1, case: 1.0)
    with pytest.raises(InvalidInputError, match="edge_drop"):
        best_profile(CASE, made, bounds={"edge_drop": (-2.0, -1.0)})
