"""Limits of first yield and shakedown in a study."""

from __future__ import annotations

import numpy as np
import pytest

from contactstudy import open_study, run_study
from contactstudy.fatigue import shakedown_limit
from contactstudy.solution import solve
from contactstudy.study.case_setup import build_setup
from tests.small_study import BASE, small_study

PASSAGE_POSITIONS = {"field_y_over_a": np.linspace(-2.0, 2.0, 17).tolist()}


@pytest.mark.slow
def test_shakedown_limits_with_sufficient_positions(tmp_path):
    sweep = {"e_over_a": [1.0], "friction": [0.0, 0.1]}
    run_study(small_study(base=BASE | PASSAGE_POSITIONS, sweep=sweep, level="summary"), tmp_path, workers=0)
    dataset = open_study(tmp_path)
    assert dataset["shakedown_limit"].dims == ("e_over_a", "friction")
    assert dataset["shakedown_limit"].attrs["units"] == "1"
    assert (dataset["shakedown_limit"] > dataset["first_yield_limit"]).all()
    assert (dataset["shakedown_limit"].sel(friction=0.1) < dataset["shakedown_limit"].sel(friction=0.0)).all()
    setup = build_setup(BASE | PASSAGE_POSITIONS | {"e_over_a": 1.0, "friction": 0.1})
    expected = shakedown_limit(solve(setup.case, setup.grid, **setup.options))
    dataset_case = dataset.sel(e_over_a=1.0, friction=0.1)
    for name in ("shakedown_limit", "first_yield_limit", "peak_shakedown_stress_z"):
        np.testing.assert_allclose(dataset_case[name], expected[name], rtol=1e-6)


def test_shakedown_limits_missing_with_few_positions(tmp_path):
    half_space = BASE | {"body": "half-space"}
    run_study(small_study(base=half_space, sweep={"e_over_a": [0.0]}, level="summary"), tmp_path, workers=0)
    dataset = open_study(tmp_path)
    assert "peak_von_mises" in dataset
    assert "shakedown_limit" not in dataset
