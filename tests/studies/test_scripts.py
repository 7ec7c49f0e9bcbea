"""The scripts of the studies, on small problems."""

from __future__ import annotations

import importlib.util
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
import xarray as xr
from matplotlib import pyplot

from contactstudy import HalfSpace, Study, open_study, run_study

pytestmark = pytest.mark.system

STUDIES = Path(__file__).resolve().parents[2] / "studies"


def load_script(name: str) -> ModuleType:
    specification = importlib.util.spec_from_file_location(name, STUDIES / f"{name}.py")
    assert specification is not None
    assert specification.loader is not None
    module = importlib.util.module_from_spec(specification)
    # Dataclasses need the module in `sys.modules`.
    sys.modules[name] = module
    specification.loader.exec_module(module)
    return module


@pytest.fixture(autouse=True)
def _close_figures() -> Iterator[None]:
    yield
    pyplot.close("all")


def test_every_study_file_can_be_planned():
    for path in sorted(STUDIES.glob("*.toml")):
        plan = Study.from_toml(path).plan()
        assert plan, path.name
        assert len(plan.skipped) < len(plan) / 2, path.name


@pytest.fixture(scope="module")
def regime_errors(tmp_path_factory):
    """Errors of a few cases of the regime map, to a coarse accuracy."""
    module = load_script("regime_map")
    study = Study.from_toml(STUDIES / "regime_map.toml")
    small_study = replace(
        study,
        base={**study.base, "accuracy": 0.1},
        sweep={
            **study.sweep,
            "e_over_a": [0.0],
            "gamma": [0.078],
            "profile": study.sweep["profile"][:1],
        },
    )
    folder = tmp_path_factory.mktemp("regime_map")
    run_study(small_study, folder, workers=0)
    return module.compute_errors(module.select_quantities(open_study(folder)))


def test_regime_map_compares_models_with_exact_ends(regime_errors):
    module = load_script("regime_map")
    full_crown = regime_errors.sel(profile="full crown")
    assert np.isfinite(full_crown["peak_pressure_first"]).all()
    flush_results = full_crown.sel(e_over_a=0.0, friction=0.0)
    model_results = {model: flush_results.sel(approximation=model) for model in module.MODELS}
    assert float(model_results["half-space"]["peak_pressure_first"].min()) > 3
    assert float(model_results["half-space"]["end_load_first"].min()) > 30
    assert float(np.abs(model_results["single mirror"]["end_load_first"]).max()) < 3
    # In the model the body continues beyond the other end and carries less load at this end.
    assert float(model_results["quarter space"]["end_load_first"].max()) < -10
    # Friction does not change the pressure.
    for name in ("peak_pressure_first", "end_load_first"):
        np.testing.assert_allclose(full_crown[name].sel(friction=0.3), full_crown[name].sel(friction=0.0), atol=1e-9)
    for profile in regime_errors["profile"].values:
        assert len(module.draw(regime_errors, profile).axes) == 16
    assert module.format_table(regime_errors).count("\n") == 15


def test_regime_map_marks_singularities_of_models(regime_errors):
    """On the half-space the end pressure of a slight crown is infinite."""
    module = load_script("regime_map")
    unbounded_errors = regime_errors.copy(deep=True)
    unbounded_errors["peak_pressure_first"].loc[{"approximation": "half-space"}] = np.inf
    figure = module.draw(unbounded_errors, "full crown")
    assert any(text.get_text() == "\N{INFINITY}" for text in figure.axes[0].texts)


def test_regime_map_states_distance_of_small_errors():
    module = load_script("regime_map")
    # Small at 0 but not at 1, and so from 2 on only; never small; small at 0, where longer distances do not exist.
    values = [[-2.0, 9.0, -0.5], [8.0, 9.0, np.nan], [-0.5, 7.0, np.nan], [0.7, np.nan, np.nan]]
    error = xr.Dataset(
        {"end_load_first": (("e_over_a", "gamma"), values)},
        {"e_over_a": [0.0, 1.0, 2.0, 4.0], "gamma": [3.0, 2.0, 1.0]},
    )
    bound = module.find_limits(error)["end_load_first"]
    np.testing.assert_array_equal(bound.sel(below=5.0), [2.0, np.nan, 0.0])
    np.testing.assert_array_equal(bound.sel(below=1.0), [2.0, np.nan, 0.0])


def test_regime_map_checks_accuracy():
    module = load_script("regime_map")
    study = Study.from_toml(STUDIES / "regime_map.toml")
    case_names = {case.name for case in study.plan()}
    check = module.refine_study(study).plan()
    assert len(check)
    assert not check.skipped
    assert {case.name for case in check} < case_names
    assert {case.parameters["accuracy"] for case in check} == {study.base["accuracy"] / 4}


def test_best_profile_needs_less_crown_between_free_ends():
    module = load_script("best_profile")
    task = module.Task(length=0.8e-3, pressures=(1.5e9,), offsets=(0.04e-3,), accuracy=0.1, points=(20, 61, 22))
    designs = module.compare_designs(task)
    crown_factors = designs["delta"].sel(design=["half-space", "free ends"]).values
    assert task.bounds[0] < crown_factors[1] < crown_factors[0] < task.bounds[1]
    assert float(designs["worst_pressure"].sel(design="free ends")) <= float(
        designs["worst_pressure"].sel(design="half-space")
    )
    assert task.find_worst_pressure(float(crown_factors[1]), HalfSpace(material=task.material))[0] > 1.2
    assert "| free ends |" in module.format_table(designs)


def test_elastic_roller_is_softer_at_ends():
    module = load_script("real_roller")
    length = 0.8e-3
    result = module.solve_all({"Lundberg": module.PROFILES["Lundberg"]}, 0.1, length, workers=0)
    assert dict(result.sizes) == {"raceway": 2, "profile": 1, "model": 4}
    wide_raceway, flush_raceway = (result.isel(raceway=i, profile=0) for i in (0, 1))
    elastic_model, rigid_model = "both finite", "finite raceway, rigid roller"
    for name in ("end_load", "peak_von_mises"):
        assert float(wide_raceway[name].sel(model=elastic_model)) < float(wide_raceway[name].sel(model=rigid_model))
        # Two bodies with common ends equal a rigid roller on one body of half the stiffness.
        assert float(flush_raceway[name].sel(model=elastic_model)) == pytest.approx(
            float(flush_raceway[name].sel(model=rigid_model)), rel=2e-3
        )
        first_value, second_value = (
            float(raceway[name].sel(model="half-spaces")) for raceway in (wide_raceway, flush_raceway)
        )
        # The search for the largest stress starts from different points.
        assert first_value == pytest.approx(second_value, rel=1e-6 if name == "end_load" else 1e-4)
    for table in (module.format_table, module.load_table):
        assert "| Lundberg |" in table(result.isel(raceway=0))
        assert "±" in table(result.isel(raceway=0))


@pytest.mark.parametrize(
    ("law", "text"),
    [
        ({"end_pressure": 0.0}, "open"),
        ({"end_pressure": 0.5}, "0.500 ± 0.010"),
        ({"end_pressure": np.inf, "end_intensity": np.nan}, "singular (logarithm)"),
        ({"end_pressure": np.inf, "end_intensity": 0.8}, "singular, K = 0.800 ± 0.020, m = 0.50"),
    ],
)
def test_end_text_of_singular_pressure_contains_law(law, text):
    law_values = {
        "end_pressure_error": 0.01,
        "end_intensity_error": 0.02,
        "end_exponent": 0.5,
        "end_intensity": np.nan,
    } | law
    assert load_script("real_roller").describe_end(law_values) == text


@pytest.fixture(scope="module")
def edge_results():
    """Module, shapes and results of the sphere and the cylinder near an edge, on coarse cells."""
    module = load_script("quarter_space")
    cylinder = replace(
        module.cylinder(length=6.0, accuracy=0.1), x=tuple(np.linspace(1.3, 1.7, 9)), z=tuple(np.linspace(0.0, 0.15, 6))
    )
    shapes = {"sphere": module.sphere(accuracy=0.1), "cylinder": cylinder}
    return module, shapes, module.solve_all(shapes, (0.0, 8.0))


def test_quarter_space_is_softer_at_edge(edge_results):
    module, _, result = edge_results
    sphere_result = result.sel(indenter="sphere")
    equal_approach_result = sphere_result.sel(condition="depth")
    # Solved on cells of a quarter of the size.
    for name, value in (("load", 0.3985), ("contact_area", 0.471), ("peak_pressure", 0.843), ("von_mises", 0.6796)):
        assert abs(float(equal_approach_result[name].sel(e_over_a=0.0)) - value) <= float(
            equal_approach_result[f"{name}_error"].sel(e_over_a=0.0)
        )
    assert float(equal_approach_result["load"].sel(e_over_a=8.0)) == pytest.approx(module.far_load(0.3, 8.0), abs=2e-3)
    stress_ratio = result["von_mises"].sel(e_over_a=0.0) / result["von_mises"].sel(e_over_a=np.inf)
    assert float(stress_ratio.sel(indenter="sphere", condition="load")) == pytest.approx(1.49, abs=0.01)
    assert float(stress_ratio.sel(indenter="cylinder", condition="load")) < 0.95
    assert float(result["end_traction_residual"].max()) < 1e-4


def test_quarter_space_passes_checks_on_coarse_cells(edge_results):
    module, shapes, _ = edge_results
    rows = module.checks(shapes["sphere"], shapes["cylinder"])
    *sphere_errors, cylinder_error = (abs(row.value - row.expected) for row in rows)
    assert max(sphere_errors) < 2e-3
    assert cylinder_error < 0.05
    assert module.check_table(rows).count("\n") == len(rows) + 1


def test_quarter_space_draws_and_tabulates_every_distance(edge_results):
    module, _, result = edge_results
    assert len(module.draw(result).axes) == 4
    table = module.format_table(result, "sphere", "load")
    assert table.splitlines()[0].startswith("| e / a | depth |")
    assert table.count("\n") == 4
    assert "nu = 0.3" in module.poisson_table(result)


def test_quarter_space_ignores_maximum_at_border(edge_results):
    module, shapes, _ = edge_results
    shallow_shape = replace(shapes["sphere"], z=(0.05, 0.1, 0.15, 0.2))
    with pytest.raises(ValueError, match="border of the points"):
        module.solve_with_errors(shallow_shape, module.HALF_SPACE, None, ("load",))


def test_worn_profile_is_flat_at_design_load():
    module = load_script("worn_profile")
    task = module.Task(length=0.6e-3, mean_depths=(1e-6, 1e-5), pressures=(1.5e9, 2e9), offsets=(0.0,))
    wear_result = module.wear_roller(task)
    result = module.press_profiles(task, wear_result).sel(offset=0.0)
    off_the_ends = result["relative_load"].where(result["relative_load"].max(["profile", "max_pressure"]) > 0)
    worn_in = off_the_ends.sel(profile="worn by 10 µm")
    assert float(abs(worn_in.sel(max_pressure=1.5e9) - 1).max()) < 0.02
    assert float(worn_in.sel(max_pressure=2e9).max()) > 1.1
    maximum = result["largest_pressure"].sel(max_pressure=1.5e9)
    assert float(maximum.sel(profile="best crown")) < float(maximum.sel(profile="worn by 10 µm"))
    assert float(maximum.sel(profile="worn by 10 µm")) < float(maximum.sel(profile="sharp"))
    assert len(module.draw(task, wear_result, result.expand_dims(offset=[0.0])).axes) == 3
    assert "| best crown |" in module.format_table(result.expand_dims(offset=[0.0]))


def test_rolling_script_draws_four_studies(tmp_path):
    module = load_script("rolling")
    reduced_sweeps = {
        "traction_curve": {"longitudinal_creepage": [0.0, 2e-3], "roller_length": [0.26e-3]},
        "axial_slip": {"e_over_a": [0.0, 1.0]},
        "spin": {"spin": [0.0, 4.0], "roller_length": [0.26e-3]},
        "partial_slip": {"longitudinal_creepage": [1e-3, 0.1], "friction": [0.3]},
    }
    studies = {}
    for name in module.NAMES:
        study = Study.from_toml(STUDIES / f"{name}.toml")
        length = {} if "roller_length" in study.sweep else {"roller_length": 0.26e-3}
        parameters = {**study.base, **length, "accuracy": 0.1}
        if name in ("traction_curve", "partial_slip"):
            del parameters["accuracy"]
            parameters |= {"cells_x": 3, "cells_y": 8, "window": 1.5}
        if name == "partial_slip":
            parameters |= {"field_x_over_a": [0.0, 1.0], "field_y_over_a": [0.0, 0.8], "field_z_over_a": [0.0, 0.4]}
        small_study = replace(
            study,
            base=parameters,
            sweep={**study.sweep, **reduced_sweeps[name]},
        )
        run_study(small_study, tmp_path / name, workers=0, progress=False)
        studies[name] = open_study(tmp_path / name)
    figure = module.draw(studies)
    assert [len(ax.get_legend().get_texts()) for ax in figure.axes] == [3, 3, 2, 2]
    # Flush ends of like bodies do not slip by pressure alone; ends inside the face do.
    friction_work = studies["axial_slip"]["friction_work"]
    assert float(friction_work.sel(e_over_a=0.0)) < 1e-8 < float(friction_work.sel(e_over_a=1.0))


def test_shakedown_is_drawn_beside_the_line_contact(tmp_path):
    module = load_script("shakedown")
    study = Study.from_toml(STUDIES / "shakedown.toml")
    distances, positions_x = study.zip[0].values()
    small_study = replace(
        study,
        base={**study.base, "accuracy": 0.05, "field_z_over_a": [0.0, 0.04, 0.08, 0.12, 0.2, 0.4, 0.6, 0.8, 1.0]},
        sweep={**study.sweep, "friction": [0.0, 0.2], "profile": study.sweep["profile"][1:]},
        zip=[{"e_over_a": [distances[0], distances[-1]], "field_x_over_a": [positions_x[0], positions_x[-1]]}],
    )
    run_study(small_study, tmp_path, workers=0)
    result = open_study(tmp_path)
    line_contact_result = module.line_contact(result["friction"].values, 0.3)
    johnson_limit = line_contact_result["along rolling and axis (Johnson)"]
    assert float(johnson_limit.sel(friction=0.0)) == pytest.approx(4.0, rel=5e-3)
    # A crowned roller endures less than the line contact; far inside the face the pressure at its end is high.
    bound = result["shakedown_limit"].isel(profile=0)
    assert (bound < line_contact_result["along rolling"]).all()
    assert (bound.sel(e_over_a=4.0) < bound.sel(e_over_a=0.0)).all()
    assert (bound.sel(friction=0.2) < bound.sel(friction=0.0)).all()
    assert float(module.stated_errors(result).max()) < 0.1
    assert len(module.draw(result, line_contact_result).axes) == 3
    assert module.format_table(result, line_contact_result).count("\n") == 6


def test_residual_stress_at_free_end_is_small():
    module = load_script("residual_stress")
    result = module.roll_passes(module.Task(length=0.6e-3, cells_x=12, cells_z=9, positions_y=31, passes=3))
    end_depths, near_end_depths, mid_length_depths = module.select_depths(result).values()
    along_axis = [
        float(abs(position["sigma_xx"].isel(pass_number=-1)).max())
        for position in (end_depths, near_end_depths, mid_length_depths)
    ]
    assert along_axis[0] < 0.2 * min(along_axis[1:])
    # Rolling leaves compression in the yielded middle.
    assert float(mid_length_depths["sigma_yy"].isel(pass_number=-1).min()) < -0.05
    first_value, *_, last_value = module.compute_flow(near_end_depths).values
    assert 0 < last_value < 0.02 * first_value
    assert len(module.draw(result).axes) == 5
    assert "| in the middle |" in module.format_table(result)


def test_thickest_film_needs_more_crown_than_the_lowest_pressure():
    module = load_script("film_profiles")
    task = module.Task(pressures=(1.2e9,), crowns=(0.25, 1.0), length=0.5e-3, accuracy=0.2)
    films = module.solve_all(task)
    assert dict(films.sizes) == {"model": 3, "max_pressure": 1, "crown": 2}
    choice = module.choose_crowns(films).sel(model="flush", max_pressure=1.2e9)
    assert float(choice["crown_film"]) > float(choice["crown_pressure"])
    assert float(choice["film_loss"]) > float(choice["film_loss_error"])
    assert float(choice["pressure_gain"]) > 0.01
    end_film_ratio = films["end_film_ratio"].sel(crown=1.0, max_pressure=1.2e9)
    assert float(end_film_ratio.sel(model="flush")) > 1.3 * float(end_film_ratio.sel(model="half-space"))
    assert "| 1.2 | flush |" in module.format_table(films)
    assert len(module.draw(films).axes) == 2
