"""Studies of motions: parameters, invalid parameters, and results independent of the run."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from contactstudy import InvalidInputError, Rolling, Shift, Sliding, solve
from contactstudy.study import Study, load_case, open_study, run_study
from contactstudy.study.case_setup import build_setup
from contactstudy.study.common_cells import resample
from tests.small_study import BASE, case_id, small_study
from tests.study.test_common_cells import make_resampling

ROLLS: dict[str, Any] = {
    "young": 210e9,
    "poisson": 0.3,
    "radius": 5e-3,
    "roller_length": 0.1e-3,
    "roller_body": "half-space",
    "body": "half-space",
    "max_pressure": 1.5e9,
    "e_over_a": 0.0,
    "friction": 0.1,
    "accuracy": 0.1,
    "stresses": False,
    "motion": "rolling",
}


def rolling_study(**changes: Any) -> Study:
    """Four cases of a roller on a half-space: two creepages, two pressures."""
    sweep = {"longitudinal_creepage": [0.0, 5e-4], "max_pressure": [1.0e9, 1.5e9]}
    content = {"base": ROLLS, "sweep": sweep, "level": "surface"} | changes
    return Study(name="rolls", **content)


@pytest.mark.parametrize(
    ("parameters", "expected"),
    [
        ({}, Sliding()),
        ({"motion": "sliding"}, Sliding()),
        ({"motion": "shift", "shift_x": 1e-6, "force_y": 2.0}, Shift(x=1e-6, force_y=2.0)),
        (
            {"motion": "rolling", "longitudinal_creepage": 1e-3, "force_x": 0.0, "spin": 2},
            Rolling(longitudinal_creepage=1e-3, force_x=0.0, spin=2.0),
        ),
        ({"motion": "rolling", "moment_z": 0.1}, Rolling(moment_z=0.1)),
        ({"motion": "rolling", "rolling_model": "fastsim"}, Rolling(model="fastsim")),
    ],
)
def test_parameters_determine_motion(parameters: dict[str, Any], expected: object) -> None:
    assert build_setup(BASE | {"e_over_a": 0.0} | parameters).case.motion == expected


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"longitudinal_creepage": 1e-3}, "longitudinal_creepage = 0.001.*left out for motion = 'sliding'.*'rolling'"),
        ({"force_y": 1.0}, "force_y = 1.0.*'shift' or 'rolling'"),
        ({"motion": "shift", "spin": 1.0}, "spin = 1.0.*left out for motion = 'shift'"),
        ({"motion": "rolling", "shift_y": 1e-6}, "shift_y = 1e-06.*belongs to 'shift'"),
        ({"motion": "rolling", "longitudinal_creepage": 0.0, "force_y": 1.0}, "longitudinal_creepage, force_y = "),
        ({"motion": "shift", "rolling_model": "fastsim"}, "rolling_model = 'fastsim'.*left out"),
        ({"motion": "rollin"}, "did you mean 'rolling'"),
        ({"motion": "rolling", "rolling_model": "exat"}, "did you mean 'exact'"),
        ({"motion": "rolling", "spin": "fast"}, "spin = 'fast'"),
    ],
)
def test_parameter_of_other_motion_raises(parameters: dict[str, Any], message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        build_setup(BASE | {"e_over_a": 0.0} | parameters)


def test_impossible_motions_are_skipped() -> None:
    study = small_study(sweep={"e_over_a": [0.0], "motion": ["sliding", "rolling"], "spin": [1.0]})
    assert [bool(case.reason) for case in study.plan()] == [True, False]


def test_identity_contains_motion_without_defaults() -> None:
    assert case_id({"friction": 0.1, "motion": "sliding", "rolling_model": "exact"}) == case_id({"friction": 0.1})
    rolling_parameters = {"friction": 0.1, "motion": "rolling"}
    assert (
        len(
            {
                case_id(rolling_parameters | motion_parameters)
                for motion_parameters in ({}, {"spin": 1.0}, {"force_y": 0.0}, {"force_x": 0.0})
            }
        )
        == 4
    )


@pytest.fixture(scope="module")
def rolling_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Results of the four cases from this process, without a cluster."""
    folder = tmp_path_factory.mktemp("rolled")
    assert run_study(rolling_study(), folder, workers=0, progress=False).counts == {"ok": 4}
    return folder


def test_motion_results_equal_solver_results(rolling_folder: Path) -> None:
    study = rolling_study()
    dataset = open_study(rolling_folder)
    first_case, *_, last_case = study.plan()
    for case in (first_case, last_case):
        setup = build_setup(case.parameters)
        separate_result = solve(setup.case, setup.grid, **setup.options)
        stored_case = load_case(rolling_folder, case.id)
        for name in ("pressure", "traction_x", "traction_y", "slip_x", "slip_y", "stick"):
            np.testing.assert_array_equal(stored_case[name], separate_result[name])
        case_result = dataset.isel(dict(zip(study.plan().cube.dims, case.position, strict=True)))
        for name in ("force_y", "force_y_error", "friction_work", "sticking_part", "moment_z"):
            assert float(case_result[name]) == pytest.approx(float(separate_result[name]), nan_ok=True)
        dy = float((case_result["y_over_a"][1] - case_result["y_over_a"][0]) * case_result["hertz_half_width"])
        total_force = dy * (case_result["traction_y"] * case_result["x_width"]).sum()
        assert float(total_force) == pytest.approx(float(separate_result["force_y"]), rel=1e-6, abs=1e-9)
    # The creepage is a dimension in the study, not a variable.
    assert dataset["force_y"].dims == ("longitudinal_creepage", "max_pressure")
    assert bool((dataset["force_y"].diff("longitudinal_creepage") > 0).all())
    assert bool((dataset["sticking_part"].diff("longitudinal_creepage") < 0).all())
    assert np.isin(dataset["stick"].values, (0, 1)).all()
    assert "cell at the centre" in dataset["stick"].attrs["comment"]
    assert "averaged" in dataset["traction_x"].attrs["comment"]
    assert dataset["longitudinal_creepage"].attrs["units"] == "1"


def test_resumed_motion_study_is_bit_identical(rolling_folder: Path, tmp_path: Path) -> None:
    partial_study, study = (
        rolling_study(sweep={"longitudinal_creepage": [5e-4], "max_pressure": [1.0e9]}),
        rolling_study(),
    )
    run_study(partial_study, tmp_path / "parts", workers=0, progress=False)
    report = run_study(study, tmp_path / "parts", workers=0, progress=False)
    assert (report.solved, report.counts) == (3, {"ok": 4})
    for case in study.plan():
        resumed_case, direct_case = (load_case(folder, case.id) for folder in (tmp_path / "parts", rolling_folder))
        assert resumed_case.drop_vars("seconds").identical(
            direct_case.drop_vars("seconds").assign_attrs(resumed_case.attrs)
        )


def test_flags_on_common_cells_are_zero_or_one() -> None:
    cell_borders, common_borders = np.array([0.0, 1.0, 3.0]), np.array([0.0, 0.4, 0.9, 1.2, 3.0, 4.0])
    stick = resample("stick", np.array([True, False]), [make_resampling(cell_borders, common_borders, np.nan)])
    assert stick.tolist() == [1, 1, 0, 0, 0]
