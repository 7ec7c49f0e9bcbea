"""Every check of the suite fails when its physics is switched off."""

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
def switched_off(physics: Callable[[Patch], None]) -> Iterator[None]:
    """Change the physics with an empty cache; cached values would hide the change."""
    with pytest.MonkeyPatch.context() as patch:
        cache.clear()
        physics(patch)
        yield
    cache.clear()


def everywhere(patch: Patch, name: str, value: object) -> None:
    """Replace a name that the modules of checks import."""
    for module in MODULES:
        if hasattr(module, name):
            patch.setattr(module, name, value)


def ends_only_mirrored(patch: Patch) -> None:
    patch.setattr(BodyWithFreeEnds, "terms", property(lambda body: (BodyTerm(1.0, body.extent),)))


def no_ends(patch: Patch) -> None:
    patch.setattr(BodyWithFreeEnds, "terms", property(lambda body: (BodyTerm(1.0, WHOLE_LINE),)))


def wrong_poisson(patch: Patch) -> None:
    def material(poisson: float = 0.3) -> Material:
        return Material(1 - (0.4 * poisson) ** 2, 0.4 * poisson)

    everywhere(patch, "unit_material", material)


def softer(patch: Patch) -> None:
    everywhere(patch, "unit_material", lambda poisson=0.3: Material(0.9 * (1 - poisson**2), poisson))


def first_round_only(patch: Patch) -> None:
    """The first correction at the ends is applied, the following correction of the top is not."""
    patch.setattr(EquationSet, "solve", lambda system, source: (system.scale * source.T).T)


def shear_that_needs_ends(patch: Patch) -> None:
    source = EquationSet.source
    patch.setattr(EquationSet, "source", lambda system, load, spectrum: source(system, Load.NORMAL, spectrum))


def distort_stress(patch: Patch) -> None:
    """Results that are wrong by some percent, differently in different places."""
    real_stress, real_displacement, real_contact = (
        stress.stress_field,
        surface.surface_displacement,
        contact.solve_contact,
    )

    def factor(data: xr.Dataset | xr.DataArray) -> xr.DataArray:
        return 1.03 + 0.02 * data["x"] + 0.02 * data["y"]

    def wrong_stress(*arguments, **keywords):
        result = real_stress(*arguments, **keywords)
        distortion = factor(result) + 0.4 * result["z"]
        return result.assign({name: result[name] * distortion for name in STRESSES})

    def wrong_displacement(*arguments, **keywords):
        displacement = real_displacement(*arguments, **keywords)
        return displacement * factor(displacement)

    def wrong_contact(*arguments, **keywords):
        result = real_contact(*arguments, **keywords)
        return result.assign(pressure=result["pressure"] * factor(result), approach=1.01 * result["approach"])

    everywhere(patch, "stress_field", wrong_stress)
    everywhere(patch, "surface_displacement", wrong_displacement)
    everywhere(patch, "solve_contact", wrong_contact)


def distort_between_ends(patch: Patch) -> None:
    """Distort the stress between two ends only."""
    solve_real = stress.stress_field

    def solve_wrong_stress(body, *arguments, **keywords):
        distorted_stress = solve_real(body, *arguments, **keywords)
        return distorted_stress * 1.05 if isinstance(body, FiniteLengthSpace) else distorted_stress

    everywhere(patch, "stress_field", solve_wrong_stress)


def softer_bodies(patch: Patch) -> None:
    patch.setattr(tribology, "material", lambda shear, poisson: Material(1.8 * shear * (1 + poisson), poisson))


def twice_the_friction(patch: Patch) -> None:
    solve_real = contact.solve_contact

    def solve_with_double_friction(body, gap, *, friction, **keywords):
        return solve_real(body, gap, friction=2 * friction, **keywords)

    patch.setattr(tribology, "solve_contact", solve_with_double_friction)


def conducting_ends(patch: Patch) -> None:
    solve_real = tribology.MovingBody
    patch.setattr(
        tribology, "MovingBody", lambda properties, speed, ends: solve_real(properties, speed, tribology.EVERYWHERE)
    )


def slower_surfaces(patch: Patch) -> None:
    """Omit the heat behind a moving surface."""
    patch.setattr(MovingBody, "drift", property(lambda body: 1e-3 * body.speed / (2 * body.properties.diffusivity)))


def better_conductors(patch: Patch) -> None:
    patch.setattr(tribology, "UNIT_PROPERTIES", tribology.UNIT_PROPERTIES | {"conductivity": 1.1, "density": 1.1})


def heat_in_halves(patch: Patch) -> None:
    """Partition the heat by a constant near one half, without equal temperatures."""
    patch.setattr(flash, "partition_heat", lambda first, second, density, in_contact: (0.49 * density, 0.0))


def wear_that_changes_nothing(patch: Patch) -> None:
    real = WearIntegrator.solve_contact
    patch.setattr(WearIntegrator, "solve_contact", lambda wear, depth, *further: real(wear, 0 * depth, *further))


def milder_wear(patch: Patch) -> None:
    real = WearIntegrator.compute_slip
    patch.setattr(WearIntegrator, "compute_slip", lambda wear, depth: 0.9 * real(wear, depth))


def pressed_harder_by(factor: float) -> Callable[[Patch], None]:
    """Line contacts that pass with another pressure than the checks believe."""

    def patch_pressure(patch: Patch) -> None:
        real = passes.from_top
        patch.setattr(passes, "from_top", lambda friction: (factor * real(friction)).assign(hertz_max_pressure=1.0))

    return patch_pressure


def harder_steel(patch: Patch) -> None:
    real = passes.ElasticPlastic
    patch.setattr(
        passes, "ElasticPlastic", lambda yield_stress, **hardening: real(yield_stress=1.05 * yield_stress, **hardening)
    )


def passed_over_a_body_without_ends(patch: Patch) -> None:
    patch.setattr(passes, "FiniteLengthSpace", lambda length, material: HalfSpace(material=material))


def strained_more(patch: Patch) -> None:
    real = EigenstrainBody.solve
    patch.setattr(EigenstrainBody, "solve", lambda body, strain: real(body, 1.01 * strain))


def faster_flow(patch: Patch) -> None:
    real = line_contact.Fluid.of
    patch.setattr(line_contact.Fluid, "of", lambda oil, scale, speed: real(oil, scale, 1.2 * speed))


def shifted_pressure(patch: Patch) -> None:
    real = line_contact.solve_line

    def shifted_line_film(*numbers: float, **keywords: object) -> line_contact.LineFilm:
        line = real(*numbers, **keywords)
        return line._replace(moment=1.05 * line.moment)

    patch.setattr(line_contact, "solve_line", shifted_line_film)


def wrong_exponent(patch: Patch) -> None:
    real = line_contact.solve_line
    patch.setattr(line_contact, "solve_line", lambda load, *numbers, **keywords: real(load**0.8, *numbers, **keywords))


def unfinished_iteration(patch: Patch) -> None:
    real, loose_settings = film.solve_film, FilmSettings(tolerance=1e-3)
    patch.setattr(film, "solve_film", lambda case, **keywords: real(case, settings=loose_settings, **keywords))


def heavier_film(patch: Patch) -> None:
    real = FilmProblem.resultants.func
    patch.setattr(FilmProblem, "resultants", property(lambda problem: real(problem) / 1.01))


def failed_checks(checks: Iterator[Check]) -> dict[tuple[str, str], bool]:
    """Whether each check failed."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return {(check.case, check.quantity): not check.passed for check in checks}


def coarse_quadratures(patch: Patch) -> None:
    coarse_resolution = Resolution(
        step=0.6, reach=12.5, lateral_nodes=4, lateral_ratio=12.0, lateral_order=4, lateral_reach=2.5
    )
    patch.setattr(convergence, "Resolution", lambda: coarse_resolution)


def grid_without_effect(patch: Patch) -> None:
    real = free_ends.pressure_of
    patch.setattr(convergence, "pressure_of", lambda case, count: real(case, 8))


def results_that_depend_on_the_grid(patch: Patch) -> None:
    real = contact.solve_contact

    def solve_wrong_contact(body, gap, load, **keywords):
        result = real(body, gap, load=load, **keywords)
        factor = 1 + 0.05 * np.sin(gap.size)
        return result.assign(pressure=factor * result["pressure"], approach=factor * result["approach"])

    patch.setattr(convergence, "solve_contact", solve_wrong_contact)


Faults = tuple[Callable[[Patch], None], ...]
FAULTS: dict[str, tuple[Faults, ...]] = {
    "half-space": ((softer,), (wrong_poisson,), (wrong_poisson,), (distort_stress,), (wrong_poisson,)),
    "limits": ((distort_between_ends,), (ends_only_mirrored,), (distort_between_ends,)),
    "quarter space": (
        (no_ends,),
        (ends_only_mirrored,),
        (first_round_only,),
        (ends_only_mirrored,),
        (shear_that_needs_ends,),
    ),
    "finite elements": ((no_ends,),),
    "published": ((wrong_poisson,), (ends_only_mirrored,), (ends_only_mirrored,)),
    "friction": (
        (twice_the_friction,),
        (softer_bodies,),
        (softer_bodies,),
        (twice_the_friction,),
        (softer_bodies,),
        (twice_the_friction,),
    ),
    "heat": ((slower_surfaces, heat_in_halves), (better_conductors,), (better_conductors,), (conducting_ends,)),
    "wear": ((wear_that_changes_nothing, milder_wear), (milder_wear,)),
    "passes": (
        (pressed_harder_by(1.05),),
        (passed_over_a_body_without_ends, strained_more),
        (pressed_harder_by(1.05), pressed_harder_by(0.9)),
        (harder_steel,),
        (harder_steel,),
    ),
    "film": (
        (faster_flow, shifted_pressure, wrong_exponent),
        (heavier_film, wrong_exponent),
        (unfinished_iteration, heavier_film, wrong_exponent),
        (faster_flow,),
    ),
    "consistency": (
        (ends_only_mirrored,),
        (distort_stress,),
        (distort_stress,),
        (distort_stress,),
        (first_round_only,),
    ),
}
"""Faults by the group and its part: each check of the part fails with one of these faults."""


@pytest.mark.slow
@pytest.mark.parametrize("group", FAULTS)
def test_switched_off_physics_fails_checks(group: str) -> None:
    for part in range(len(FAULTS[group])):
        assert checks_that_pass(group, part, full=False) == set()


@pytest.mark.slow
@pytest.mark.parametrize("part", [1, 4])
def test_switched_off_physics_fails_checks_of_friction_at_the_full_level(part: int) -> None:
    """Slopes and Kalker's coefficients; further checks of this level take minutes."""
    assert checks_that_pass("friction", part, full=True) == set()


def checks_that_pass(group: str, part: int, *, full: bool) -> set[tuple[str, str]]:
    """Checks of a part that pass with every fault."""
    passed = []
    for fault in FAULTS[group][part]:
        with switched_off(fault):
            is_failed = failed_checks(suite.GROUPS[group](full)[part])
        passed.append({check for check, fails in is_failed.items() if not fails})
    return set.intersection(*passed)


@pytest.mark.slow
@pytest.mark.parametrize(
    "table", [convergence.tabulate_point_contact, convergence.tabulate_contact_grid, convergence.tabulate_window]
)
def test_convergence_with_noise_of_the_grid(table: Callable[[], convergence.Table]) -> None:
    with switched_off(results_that_depend_on_the_grid):
        assert all(failed_checks(table().checks()).values())


@pytest.mark.slow
def test_coarse_quadratures() -> None:
    with switched_off(coarse_quadratures):
        assert all(failed_checks(convergence.check_quadratures()).values())


@pytest.mark.slow
def test_refinement_without_effect() -> None:
    with switched_off(grid_without_effect):
        assert all(failed_checks(convergence.tabulate_stress_grid().checks()).values())


def test_every_part_has_faults() -> None:
    assert {group: len(parts(False)) for group, parts in suite.GROUPS.items()} == {
        group: len(faults) for group, faults in FAULTS.items()
    }
