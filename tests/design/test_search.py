"""The search for profiles with measures in closed form."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from contactstudy import Case, HalfSpace, InvalidInputError, Material, Roller, profiles
from contactstudy.design import BoundWarning, best_profile

CASE = Case(body=HalfSpace(material=Material(210e9, 0.3)), roller=Roller(radius=5e-3, length=1e-3), max_pressure=1e9)
ERROR = 0.01


@pytest.fixture
def install_measure(monkeypatch: pytest.MonkeyPatch):
    """Replace the solver by a function of the profile's two parameters and the case."""

    def replace_solver(measure_function):
        def solve(case: Case, **settings: object) -> xr.Dataset:
            profile = case.roller.profile
            value = measure_function(profile.edge_drop, profile.k1, case)
            result = xr.Dataset({"peak_pressure": value, "peak_pressure_error": ERROR, "tilt": case.tilt})
            result["peak_pressure"].attrs["units"] = "Pa"
            return result

        monkeypatch.setattr("contactstudy.design.solve", solve)

    return replace_solver


def make_profile(edge_drop: float, k1: float = 1.0) -> profiles.Profile:
    return profiles.FujiwaraKawase(1e-6, edge_drop, k1)


BOUNDS = {"edge_drop": (1e-6, 1e-4)}
TWO_BOUNDS = {"edge_drop": (1e-6, 1e-4), "k1": (0.5, 4.0)}


def test_search_finds_optimum_and_flat_range_of_parabola(install_measure) -> None:
    """Measure 1 + 4 s**2 of s decades; at s = 0.0707 it exceeds the minimum by two errors of 0.01."""
    install_measure(lambda drop, k1, case: 1 + 4 * np.log10(drop / 2e-5) ** 2)
    result = best_profile(CASE, make_profile, bounds=BOUNDS)
    assert float(np.log10(result.optimum[0] / 2e-5)) == pytest.approx(0.0, abs=0.03)
    flat_ends = np.log10(np.array([result.flat_from[0], result.flat_to[0]]) / 2e-5)
    np.testing.assert_allclose(flat_ends, [-0.0707, 0.0707], atol=0.045)
    assert float(result.measure) == pytest.approx(1.0, abs=0.005)
    assert float(result.measure_error) == ERROR
    assert result.measure.attrs["units"] == "Pa"
    assert result.sizes["evaluation"] < 30
    assert float(result.design_measure.min()) == float(result.measure)


@pytest.mark.parametrize("max_evaluations", [8, 9, 12, 16, 60])
def test_number_of_designs_is_bounded(install_measure, max_evaluations: int) -> None:
    install_measure(lambda drop, k1, case: 1 + 4 * np.log10(drop / 2e-5) ** 2)
    assert (
        best_profile(CASE, make_profile, bounds=BOUNDS, evaluations=max_evaluations).sizes["evaluation"]
        <= max_evaluations
    )
    install_measure(lambda drop, k1, case: 1 + np.log10(drop / 1e-5) ** 2 + 2 * (k1 - 2.0) ** 2)
    result = best_profile(CASE, make_profile, bounds=TWO_BOUNDS, evaluations=max_evaluations + 1)
    assert result.sizes["evaluation"] <= max_evaluations + 1
    assert (result.flat_from <= result.optimum).all()


def test_optimum_of_two_cases_equalises_measures(install_measure) -> None:
    """The loads have opposite slopes: at the optimum both measures are equal."""
    slopes = {50.0: 1.0, 100.0: -2.0}
    install_measure(lambda drop, k1, case: 3 + slopes[case.normal_load] * np.log10(drop / 1e-5))
    cases = [replace(CASE, max_pressure=None, load=load) for load in slopes]
    result = best_profile(cases, make_profile, bounds=BOUNDS)
    assert float(np.log10(result.optimum[0] / 1e-5)) == pytest.approx(0.0, abs=0.02)
    assert result.case_load.values.tolist() == [50.0, 100.0]
    np.testing.assert_allclose(result.case_measure.max("case"), result.design_measure)
    # The second case rises twice as fast.
    flat_ends = np.abs(np.log10(np.array([result.flat_from[0], result.flat_to[0]]) / float(result.optimum[0])))
    assert (flat_ends < 0.08).all()


def test_optimum_of_two_parameters_equals_minimum(install_measure) -> None:
    install_measure(
        lambda drop, k1, case: 1 + np.log10(drop / 1e-5) ** 2 + 2 * (k1 - 2.0 + 0.5 * np.log10(drop / 1e-5)) ** 2
    )
    result = best_profile(CASE, make_profile, bounds=TWO_BOUNDS, evaluations=80)
    values = result.optimum.to_series()
    assert np.log10(values["edge_drop"] / 1e-5) == pytest.approx(0.0, abs=0.1)
    assert values["k1"] == pytest.approx(2.0, abs=0.15)
    assert make_profile(**values).k1 == values["k1"]
    assert result.flat_from.sel(parameter="k1") < values["k1"] < result.flat_to.sel(parameter="k1")


def test_optimum_equals_a_brute_force_scan(install_measure) -> None:
    def measure_with_local_minima(drop: float, k1: float, case: Case) -> float:
        s = np.log10(drop / 1e-6) / 2
        return float(2 + np.cos(5 * s) + 1.5 * s)

    install_measure(measure_with_local_minima)
    result = best_profile(CASE, make_profile, bounds=BOUNDS)
    scan = min(measure_with_local_minima(drop, 1.0, CASE) for drop in np.geomspace(1e-6, 1e-4, 2001))
    assert float(result.measure) == pytest.approx(scan, abs=ERROR)


def test_search_excludes_infinite_measures_and_invalid_profiles(install_measure) -> None:
    def make_singular_measure(drop: float, k1: float, case: Case) -> float:
        if drop > 5e-5:
            raise InvalidInputError("profile", drop, "smaller")
        return np.inf if drop < 1e-5 else 1 + np.log10(drop / 1.5e-5) ** 2

    install_measure(make_singular_measure)
    result = best_profile(CASE, make_profile, bounds=BOUNDS)
    assert float(result.optimum[0]) == pytest.approx(1.5e-5, rel=0.15)
    assert 0.9e-5 < float(result.flat_from[0]) <= float(result.flat_to[0]) < 5e-5
    assert np.isinf(result.design_measure).any()


def test_optimum_on_a_bound_warns(install_measure) -> None:
    install_measure(lambda drop, k1, case: 1 + np.log10(drop / 1e-6))
    with pytest.warns(BoundWarning, match=r"the best edge_drop = 1e-06 lies at a bound \(1e-06 to 0.0001\)"):
        result = best_profile(CASE, make_profile, bounds=BOUNDS)
    assert float(result.flat_from[0]) == pytest.approx(float(result.lower_bound[0]))
    assert result.at_bound.values.tolist() == [True]


def test_error_of_measure_function_defaults_to_accuracy(install_measure) -> None:
    install_measure(lambda drop, k1, case: 1.0 + abs(case.tilt))
    pressures = (1e9, 2e9)
    cases = [replace(CASE, max_pressure=pressure, tilt=tilt) for pressure in pressures for tilt in (0.0, 1e-3)]
    result_with_error = best_profile(
        [*cases, replace(CASE, load_position=0.4e-3)],
        make_profile,
        bounds=BOUNDS,
        measure=lambda result: (2 * result.peak_pressure, 0.5),
        evaluations=8,
    )
    assert result_with_error.case_tilt.values.tolist() == [0.0, 1e-3, 0.0, 1e-3, 0.0]
    np.testing.assert_array_equal(result_with_error.case_load_position, [np.nan] * 4 + [0.4e-3])
    assert float(result_with_error.measure) == pytest.approx(2.002)
    assert float(result_with_error.measure_error) == 0.5
    # The measure is constant: the flat range equals the bounds, without a warning.
    assert not result_with_error.at_bound.any()
    assert float(result_with_error.flat_from[0]) == pytest.approx(1e-6)
    assert float(result_with_error.flat_to[0]) == pytest.approx(1e-4)
    result_without_error = best_profile(
        CASE,
        make_profile,
        bounds=BOUNDS,
        measure=lambda result: result.peak_pressure,
        accuracy=0.02,
        evaluations=8,
    )
    assert float(result_without_error.measure_error) == pytest.approx(0.02)


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
        ({"cases": "a case"}, "cases = 'a': must be a Case, or a sequence of Cases"),
        ({"cases": []}, r"cases = \[\]: must be a Case, or a sequence of Cases"),
        ({"cases": replace(CASE, max_pressure=None, approach=1e-6)}, "load"),
        ({"accuracy": 0.5}, "accuracy = 0.5"),
        ({"evaluations": 1}, "evaluations = 1"),
        ({"measure": lambda result: np.inf}, "finite somewhere"),
    ],
)
def test_invalid_argument_raises(install_measure, arguments, message: str) -> None:
    install_measure(lambda drop, k1, case: 1.0)
    with pytest.raises(InvalidInputError, match=message):
        best_profile(**({"cases": CASE, "profile": make_profile, "bounds": BOUNDS} | arguments))


def test_bounds_without_valid_profile_are_rejected(install_measure) -> None:
    install_measure(lambda drop, k1, case: 1.0)
    with pytest.raises(InvalidInputError, match="edge_drop"):
        best_profile(CASE, make_profile, bounds={"edge_drop": (-2.0, -1.0)})
