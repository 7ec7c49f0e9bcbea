"""Every check of the suite fails if the equations that it checks are changed."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np
import pytest
import xarray as xr

from benchmarks import convergence
from contactstudy import cache, film
from contactstudy.arrays.variables import STRESSES
from contactstudy.bodies.material import Material
from contactstudy.bodies.models import WHOLE_LINE, BodyTerm, BodyWithFreeEnds, FiniteLengthSpace, HalfSpace
from contactstudy.contact import solve as contact
from contactstudy.eigenstrain.body import EigenstrainBody
from contactstudy.fields import stress, surface
from contactstudy.film import line_contact
from contactstudy.film.newton import FilmProblem, FilmSettings
from contactstudy.heat import flash
from contactstudy.heat.flash import MovingBody
from contactstudy.kernels.load import Load
from contactstudy.overlapping.equations import EquationSet
from contactstudy.overlapping.quadrature import Resolution
from contactstudy.verification import exact_solutions, free_ends, passes, suite, tribology
from contactstudy.verification.problems import Check
from contactstudy.wear.wear_in import WearIntegrator

MODULES = (exact_solutions, free_ends, convergence)
Patch = pytest.MonkeyPatch


@contextmanager
def changed_physics(change: Callable[[Patch], None]) -> Iterator[None]:
    """Apply a change of the equations with an empty cache."""
    with pytest.MonkeyPatch.context() as patch:
        cache.clear()
        change(patch)
        yield
    cache.clear()


def replace_in_modules(patch: Patch, name: str, value: object) -> None:
    """Replace a name in all modules of checks."""
    for module in MODULES:
        if hasattr(module, name):
            patch.setattr(module, name, value)


def omit_end_correction(patch: Patch) -> None:
    patch.setattr(BodyWithFreeEnds, "terms", property(lambda body: (BodyTerm(1.0, body.extent),)))


def omit_free_ends(patch: Patch) -> None:
    patch.setattr(BodyWithFreeEnds, "terms", property(lambda body: (BodyTerm(1.0, WHOLE_LINE),)))


def reduce_poisson_ratio(patch: Patch) -> None:
    def material(poisson: float = 0.3) -> Material:
        return Material(1 - (0.4 * poisson) ** 2, 0.4 * poisson)

    replace_in_modules(patch, "unit_material", material)


def reduce_modulus(patch: Patch) -> None:
    replace_in_modules(patch, "unit_material", lambda poisson=0.3: Material(0.9 * (1 - poisson**2), poisson))


def omit_correction_of_top(patch: Patch) -> None:
    """Apply the first correction at the ends without the following correction of the top."""
    patch.setattr(EquationSet, "solve", lambda system, source: (system.scale * source.T).T)


def use_normal_load_source(patch: Patch) -> None:
    source = EquationSet.source
    patch.setattr(EquationSet, "source", lambda system, load, spectrum: source(system, Load.NORMAL, spectrum))


def distort_results(patch: Patch) -> None:
    """Change the results by some percent, depending on the position."""
    original_stress, original_displacement, original_contact = (
        stress.stress_field,
        surface.surface_displacement,
        contact.solve_contact,
    )

    def compute_factor(data: xr.Dataset | xr.DataArray) -> xr.DataArray:
        return 1.03 + 0.02 * data["x"] + 0.02 * data["y"]

    def wrong_stress(*arguments, **keywords):
        result = original_stress(*arguments, **keywords)
        distortion = compute_factor(result) + 0.4 * result["z"]
        return result.assign({name: result[name] * distortion for name in STRESSES})

    def wrong_displacement(*arguments, **keywords):
        displacement = original_displacement(*arguments, **keywords)
        return displacement * compute_factor(displacement)

    def wrong_contact(*arguments, **keywords):
        result = original_contact(*arguments, **keywords)
        return result.assign(pressure=result["pressure"] * compute_factor(result), approach=1.01 * result["approach"])

    replace_in_modules(patch, "stress_field", wrong_stress)
    replace_in_modules(patch, "surface_displacement", wrong_displacement)
    replace_in_modules(patch, "solve_contact", wrong_contact)


def distort_between_ends(patch: Patch) -> None:
    """Distort the stress between two ends only."""
    original_solve = stress.stress_field

    def solve_wrong_stress(body, *arguments, **keywords):
        distorted_stress = original_solve(body, *arguments, **keywords)
        return distorted_stress * 1.05 if isinstance(body, FiniteLengthSpace) else distorted_stress

    replace_in_modules(patch, "stress_field", solve_wrong_stress)


def reduce_tribology_modulus(patch: Patch) -> None:
    patch.setattr(tribology, "material", lambda shear, poisson: Material(1.8 * shear * (1 + poisson), poisson))


def double_friction(patch: Patch) -> None:
    original_solve = contact.solve_contact

    def solve_with_double_friction(body, gap, *, friction, **keywords):
        return original_solve(body, gap, friction=2 * friction, **keywords)

    patch.setattr(tribology, "solve_contact", solve_with_double_friction)


def remove_insulation_of_ends(patch: Patch) -> None:
    original_body = tribology.MovingBody
    patch.setattr(
        tribology, "MovingBody", lambda properties, speed, ends: original_body(properties, speed, tribology.EVERYWHERE)
    )


def reduce_heat_transport(patch: Patch) -> None:
    """Reduce the heat transport by the moving surface."""
    patch.setattr(MovingBody, "drift", property(lambda body: 1e-3 * body.speed / (2 * body.properties.diffusivity)))


def increase_conductivity(patch: Patch) -> None:
    patch.setattr(tribology, "UNIT_PROPERTIES", tribology.UNIT_PROPERTIES | {"conductivity": 1.1, "density": 1.1})


def partition_heat_by_constant(patch: Patch) -> None:
    """Partition the heat by a constant near one half, without equal temperatures."""
    patch.setattr(flash, "partition_heat", lambda first, second, density, in_contact: (0.49 * density, 0.0))


def omit_wear_depth(patch: Patch) -> None:
    original = WearIntegrator.solve_contact
    patch.setattr(WearIntegrator, "solve_contact", lambda wear, depth, *further: original(wear, 0 * depth, *further))


def reduce_wear_slip(patch: Patch) -> None:
    original = WearIntegrator.compute_slip
    patch.setattr(WearIntegrator, "compute_slip", lambda wear, depth: 0.9 * original(wear, depth))


def scale_pressure(factor: float) -> Callable[[Patch], None]:
    """Change of the pressure of passing line contacts, with an unchanged nominal pressure."""

    def patch_pressure(patch: Patch) -> None:
        original = passes.contact_from_top
        patch.setattr(
            passes, "contact_from_top", lambda friction: (factor * original(friction)).assign(hertz_max_pressure=1.0)
        )

    return patch_pressure


def increase_yield_stress(patch: Patch) -> None:
    original = passes.ElasticPlastic
    patch.setattr(
        passes,
        "ElasticPlastic",
        lambda yield_stress, **hardening: original(yield_stress=1.05 * yield_stress, **hardening),
    )


def replace_body_by_half_space(patch: Patch) -> None:
    patch.setattr(passes, "FiniteLengthSpace", lambda length, material: HalfSpace(material=material))


def increase_eigenstrain(patch: Patch) -> None:
    original = EigenstrainBody.solve
    patch.setattr(EigenstrainBody, "solve", lambda body, strain: original(body, 1.01 * strain))


def increase_speed(patch: Patch) -> None:
    original = line_contact.Fluid.of
    patch.setattr(line_contact.Fluid, "of", lambda oil, scale, speed: original(oil, scale, 1.2 * speed))


def increase_moment(patch: Patch) -> None:
    original = line_contact.solve_line

    def shifted_line_film(*arguments: float, **keywords: object) -> line_contact.LineFilm:
        line = original(*arguments, **keywords)
        return line._replace(moment=1.05 * line.moment)

    patch.setattr(line_contact, "solve_line", shifted_line_film)


def change_load_exponent(patch: Patch) -> None:
    original = line_contact.solve_line
    patch.setattr(
        line_contact, "solve_line", lambda load, *arguments, **keywords: original(load**0.8, *arguments, **keywords)
    )


def loosen_tolerance(patch: Patch) -> None:
    original, loose_settings = film.solve_film, FilmSettings(tolerance=1e-3)
    patch.setattr(film, "solve_film", lambda case, **keywords: original(case, settings=loose_settings, **keywords))


def reduce_film_resultants(patch: Patch) -> None:
    original = FilmProblem.resultants.func
    patch.setattr(FilmProblem, "resultants", property(lambda problem: original(problem) / 1.01))


def find_failed_checks(checks: Iterator[Check]) -> dict[tuple[str, str], bool]:
    """Whether each check failed."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return {(check.case, check.quantity): not check.passed for check in checks}


def coarsen_quadratures(patch: Patch) -> None:
    coarse_resolution = Resolution(
        step=0.6, reach=12.5, lateral_nodes=4, lateral_ratio=12.0, lateral_order=4, lateral_reach=2.5
    )
    patch.setattr(convergence, "Resolution", lambda: coarse_resolution)


def fix_stress_grid(patch: Patch) -> None:
    original = free_ends.create_pressure
    patch.setattr(convergence, "create_pressure", lambda case, count: original(case, 8))


def add_grid_noise(patch: Patch) -> None:
    original = contact.solve_contact

    def solve_wrong_contact(body, gap, load, **keywords):
        result = original(body, gap, load=load, **keywords)
        factor = 1 + 0.05 * np.sin(gap.size)
        return result.assign(pressure=factor * result["pressure"], approach=factor * result["approach"])

    patch.setattr(convergence, "solve_contact", solve_wrong_contact)


Faults = tuple[Callable[[Patch], None], ...]
FAULTS: dict[str, tuple[Faults, ...]] = {
    "half-space": (
        (reduce_modulus,),
        (reduce_poisson_ratio,),
        (reduce_poisson_ratio,),
        (distort_results,),
        (reduce_poisson_ratio,),
    ),
    "limits": ((distort_between_ends,), (omit_end_correction,), (distort_between_ends,)),
    "quarter space": (
        (omit_free_ends,),
        (omit_end_correction,),
        (omit_correction_of_top,),
        (omit_end_correction,),
        (use_normal_load_source,),
    ),
    "finite elements": ((omit_free_ends,),),
    "published": ((reduce_poisson_ratio,), (omit_end_correction,), (omit_end_correction,)),
    "friction": (
        (double_friction,),
        (reduce_tribology_modulus,),
        (reduce_tribology_modulus,),
        (double_friction,),
        (reduce_tribology_modulus,),
        (double_friction,),
    ),
    "heat": (
        (reduce_heat_transport, partition_heat_by_constant),
        (increase_conductivity,),
        (increase_conductivity,),
        (remove_insulation_of_ends,),
    ),
    "wear": ((omit_wear_depth, reduce_wear_slip), (reduce_wear_slip,)),
    "passes": (
        (scale_pressure(1.05),),
        (replace_body_by_half_space, increase_eigenstrain),
        (scale_pressure(1.05), scale_pressure(0.9)),
        (increase_yield_stress,),
        (increase_yield_stress,),
    ),
    "film": (
        (increase_speed, increase_moment, change_load_exponent),
        (reduce_film_resultants, change_load_exponent),
        (loosen_tolerance, reduce_film_resultants, change_load_exponent),
        (increase_speed,),
    ),
    "consistency": (
        (omit_end_correction,),
        (distort_results,),
        (distort_results,),
        (distort_results,),
        (omit_correction_of_top,),
    ),
}
"""Faults for each group of checks and each part of a group; each check fails for one of these faults."""


@pytest.mark.slow
@pytest.mark.parametrize("group", FAULTS)
def test_changed_physics_fails_checks(group: str) -> None:
    for part in range(len(FAULTS[group])):
        assert find_passed_checks(group, part, full=False) == set()


@pytest.mark.slow
@pytest.mark.parametrize("part", [1, 4])
def test_changed_physics_fails_full_level_checks_of_friction(part: int) -> None:
    """The parts check slopes and Kalker's coefficients; other parts of this level would take minutes."""
    assert find_passed_checks("friction", part, full=True) == set()


def find_passed_checks(group: str, part: int, *, full: bool) -> set[tuple[str, str]]:
    """Checks of a part that pass with every fault."""
    passed_checks = []
    for fault in FAULTS[group][part]:
        with changed_physics(fault):
            is_failed = find_failed_checks(suite.GROUPS[group](full)[part])
        passed_checks.append({check for check, fails in is_failed.items() if not fails})
    return set.intersection(*passed_checks)


@pytest.mark.slow
@pytest.mark.parametrize(
    "make_table", [convergence.tabulate_point_contact, convergence.tabulate_contact_grid, convergence.tabulate_window]
)
def test_grid_noise_fails_convergence_checks(make_table: Callable[[], convergence.Table]) -> None:
    with changed_physics(add_grid_noise):
        assert all(find_failed_checks(make_table().checks()).values())


@pytest.mark.slow
def test_coarse_quadratures_fail_checks() -> None:
    with changed_physics(coarsen_quadratures):
        assert all(find_failed_checks(convergence.check_quadratures()).values())


@pytest.mark.slow
def test_fixed_grid_fails_convergence_checks() -> None:
    with changed_physics(fix_stress_grid):
        assert all(find_failed_checks(convergence.tabulate_stress_grid().checks()).values())


def test_every_part_has_faults() -> None:
    assert {group: len(parts(False)) for group, parts in suite.GROUPS.items()} == {
        group: len(faults) for group, faults in FAULTS.items()
    }
