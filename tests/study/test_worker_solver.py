"""Studies with the package's own solver on small grids."""

import numpy as np
import pytest

from contactstudy import cache, solve
from contactstudy.fields import surface
from contactstudy.study import Study, load_case, open_study, run_study
from contactstudy.study.case_setup import build_setup
from tests.small_study import BASE, small_study


def test_quarter_space_study_keeps_end_distance(tmp_path):
    study = small_study(sweep={"body": ["quarter-space"], "e_over_a": [0.0, 2.0]})
    assert run_study(study, tmp_path, workers=0).counts == {"ok": 2}
    dataset = open_study(tmp_path).sel(body="quarter-space")
    for e_over_a in (0.0, 2.0):
        case = dataset.sel(e_over_a=e_over_a)
        loaded_positions = case["x_over_a"].where(case["pressure"].max("y_over_a") > 0)
        step = float(case["x_over_a"].diff("x_over_a").max())
        assert float(loaded_positions.min()) == pytest.approx(e_over_a + step / 2, abs=step)
        assert float(case["end_traction_residual"]) < 1e-4
    # The end pressure of a sharp roller is low at a free end and high away from the free end.
    assert float(dataset["end_pressure_over_p0_first"].sel(e_over_a=0.0)) < 1.0
    assert float(dataset["end_pressure_over_p0_first"].sel(e_over_a=2.0)) > 1.0


def test_study_equals_solver_result(tmp_path):
    study = small_study(sweep={"body": ["half-space"], "e_over_a": [1.0], "friction": [0.1]})
    run_study(study, tmp_path, workers=0)
    (case,) = study.plan()
    setup = build_setup(case.parameters)
    separate_result = solve(setup.case, setup.grid, **setup.options)
    stored_case = load_case(tmp_path, case.id)
    np.testing.assert_array_equal(stored_case["pressure"], separate_result["pressure"])
    np.testing.assert_array_equal(stored_case["tau_xz"], separate_result["tau_xz"].astype(np.float32))


@pytest.mark.slow
def test_study_over_end_models(tmp_path):
    study = small_study(
        level="surface",
        base=BASE
        | {"roller_length": 0.3e-3, "field_x_over_a": [0.0], "field_y_over_a": [0.0], "field_z_over_a": [1.0]},
        sweep={
            "model": ["exact", "mirror", "single-mirror"],
            "e_over_a": [0.0],
            "body": ["finite-length", "half-space"],
        },
    )
    report = run_study(study, tmp_path, workers=0)
    assert report.counts == {"ok": 4, "skipped": 2}
    dataset = open_study(tmp_path).squeeze("e_over_a")
    assert dataset["status"].sel(body="half-space").values.tolist() == ["ok", "skipped", "skipped"]
    assert "no free end" in dataset["message"].sel(body="half-space", model="mirror").item()
    residual = dataset["end_traction_residual"].sel(body="finite-length")
    exact_residual, single_residual, mirror_residual = (
        float(residual.sel(model=model)) for model in ("exact", "single-mirror", "mirror")
    )
    assert exact_residual < 3e-4 < single_residual < mirror_residual  # the depths begin at 0.02 a
    end_pressures = dataset["end_pressure_over_p0"].sel(body="finite-length").values
    assert len({round(pressure, 4) for pressure in end_pressures.tolist()}) == 3


def test_number_types_have_same_identity(tmp_path):
    base = BASE | {"body": "half-space", "stresses": False}
    for index, value in enumerate([1, 1.0, np.int64(1), np.float32(1)]):
        study = small_study(base=base, sweep={"e_over_a": [value], "friction": [0]})
        assert run_study(study, tmp_path, workers=0).solved == (index == 0)


def test_common_operator_is_computed_once(tmp_path, monkeypatch):
    kernel_requests = []
    create_kernel = surface.end_kernel_of
    monkeypatch.setattr(
        surface, "end_kernel_of", lambda *arguments: kernel_requests.append(arguments) or create_kernel(*arguments)
    )
    # The friction is the outer parameter of the sweep: solved in this order, the operators would alternate.
    sweep = {"friction": [0.0, 0.1, 0.2], "e_over_a": [0.0, 1.0]}
    study = small_study(base=BASE | {"stresses": False, "radius": 5.001e-3}, sweep=sweep, level="summary")
    assert run_study(study, tmp_path, workers=0).counts == {"ok": 6}
    assert len([term for term, *_ in kernel_requests if term.free_ends]) == 2
    assert len(kernel_requests) == len(set(kernel_requests))
    assert cache.info().limit <= 2**31


def test_study_over_approach_contains_load_errors(tmp_path) -> None:
    base = {"young": 210e9, "poisson": 0.3, "radius": 5e-3, "roller_length": 0.3e-3, "end_distance": 0.1e-3}
    study = Study(
        name="pressed",
        base=base | {"body": "half-space", "stresses": False, "accuracy": 0.1},
        sweep={"approach": [1e-6, 2e-6]},
    )
    assert run_study(study, tmp_path, workers=0, progress=False).counts == {"ok": 2}
    dataset = open_study(tmp_path)
    assert dataset.approach.dims == ("approach",)
    assert (np.diff(dataset.normal_load) > 0).all()
    assert (dataset.normal_load_error < 0.02 * dataset.normal_load).all()
    np.testing.assert_allclose(dataset.e_over_a, 0.1e-3 / dataset.hertz_half_width)
