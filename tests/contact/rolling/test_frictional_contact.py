"""Stick and slip of contacts: motions, symmetry, coupling, free ends, and invalid input."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from contactstudy import (
    Case,
    ConvergenceWarning,
    FiniteLengthSpace,
    Grid,
    HalfSpace,
    InvalidInputError,
    Material,
    QuarterSpace,
    Roller,
    Rolling,
    Shift,
    WindowError,
    profiles,
    solve,
    solve_contact,
    surface_displacement,
)
from contactstudy.bodies import Body, Counterbody
from contactstudy.contact import ContactSettings
from tests.contact.rolling.motions import FRICTION, LOAD, MOTIONS

STEEL = Material(0.91, 0.3)
HALF_SPACE = HalfSpace(material=STEEL)
EQUAL_HALF_SPACE = Counterbody(HALF_SPACE)


def make_ball_gap(cells: int = 26, half_window: float = 1.3, centre_x: float = 0.0) -> xr.DataArray:
    """Gap of a ball with a contact radius of about 1."""
    positions = half_window * ((np.arange(cells) + 0.5) / cells * 2 - 1)
    return xr.DataArray(
        0.05 * ((positions[:, None] - centre_x) ** 2 + positions**2),
        coords={"x": positions, "y": positions},
        dims=("x", "y"),
    )


def solve_rolling(motion: Rolling | Shift, **keywords: object) -> xr.Dataset:
    """A ball on a half-space of its material."""
    arguments = {
        "counterbody": EQUAL_HALF_SPACE,
        "gap": make_ball_gap(),
        "load": LOAD,
        "friction": FRICTION,
        "body": HALF_SPACE,
    } | keywords
    settings_values = {
        name: arguments.pop(name) for name in ("coupled", "after", "max_iterations") if name in arguments
    }
    settings = ContactSettings(**settings_values)  # type: ignore[arg-type]
    return solve_contact(**arguments, motion=motion, settings=settings)  # type: ignore[arg-type]


def check_law(result: xr.Dataset) -> None:
    """Check Coulomb's law in each cell of a result."""
    assert result.converged
    traction_size, slip = np.hypot(result.traction_x, result.traction_y), np.hypot(result.slip_x, result.slip_y)
    bound = FRICTION * result.pressure
    max_bound = float(bound.max())
    assert float((traction_size - bound).max()) < 1e-6 * max_bound
    is_sticking = result.stick.astype(bool)
    assert float(slip.where(is_sticking, 0.0).max()) == 0.0
    is_slipping = (~is_sticking) & (result.pressure > 0)
    assert float(np.abs(traction_size - bound).where(is_slipping, 0.0).max()) < 1e-6 * max_bound
    assert float(slip.where(is_slipping, 1.0).min()) > 0.0
    slip_work = result.traction_x * result.slip_x + result.traction_y * result.slip_y
    assert float(np.abs(slip_work - traction_size * slip).where(is_slipping, 0.0).max()) <= 1e-5 * max_bound * float(
        slip.max()
    )
    for name in ("bound_error", "slip_error", "force_error"):
        assert float(result[name]) < 1e-6


@pytest.mark.parametrize("motion", MOTIONS.values(), ids=MOTIONS)
def test_coulomb_law_holds(motion: Rolling | Shift) -> None:
    result = solve_rolling(motion)
    check_law(result)
    area = float(result.x[1] - result.x[0]) * float(result.y[1] - result.y[0])
    forces = [float(result[f"traction_{axis}"].sum()) * area for axis in "xy"]
    assert [float(result.force_x), float(result.force_y)] == pytest.approx(forces, rel=1e-9, abs=1e-12)
    moment_density = result.traction_y * result.x - result.traction_x * result.y
    assert float(result.moment_z) == pytest.approx(float(moment_density.sum()) * area, rel=1e-9, abs=1e-12)
    for name in ("force_x", "force_y", "moment_z"):
        prescribed_value = getattr(motion, name, None)
        if prescribed_value is not None:
            assert float(result[name]) == pytest.approx(prescribed_value, abs=1e-6 * FRICTION * LOAD)


def test_slip_follows_from_displacements() -> None:
    """The slip of a shift equals the rigid shift minus the surfaces' displacement, from the public operator."""
    result = solve_rolling(Shift(y=0.012, x=0.005))
    displacements = surface_displacement(
        HALF_SPACE, 0 * result.pressure, traction_x=result.traction_x, traction_y=result.traction_y, components="xy"
    )
    is_slipping = (result.pressure > 0) & ~result.stick.astype(bool)
    for axis, shift in (("x", 0.005), ("y", 0.012)):
        expected = shift - 2 * displacements[f"displacement_{axis}"]
        assert float(np.abs(result[f"slip_{axis}"] - expected).where(is_slipping).max()) < 1e-9
    # The same force, prescribed, causes the same shift.
    force_result = solve_rolling(Shift(force_y=float(result.force_y), force_x=float(result.force_x)))
    assert [float(force_result.shift_x), float(force_result.shift_y)] == pytest.approx([0.005, 0.012], rel=1e-5)


def test_prescribed_force_reproduces_creepage() -> None:
    creepages = {"longitudinal_creepage": 0.006, "lateral_creepage": -0.004, "spin": 0.008}
    creepage_result = solve_rolling(Rolling(**creepages))
    forces = {name: float(creepage_result[name]) for name in ("force_x", "force_y", "moment_z")}
    force_result = solve_rolling(Rolling(**forces))
    for name, value in creepages.items():
        assert float(force_result[name]) == pytest.approx(value, rel=1e-4)


def test_reversed_creepage_reverses_the_tractions() -> None:
    forward_result = solve_rolling(Rolling(longitudinal_creepage=0.006, lateral_creepage=0.004, spin=0.01))
    reversed_result = solve_rolling(Rolling(longitudinal_creepage=-0.006, lateral_creepage=-0.004, spin=-0.01))
    for axis in "xy":
        assert np.abs(forward_result[f"traction_{axis}"] + reversed_result[f"traction_{axis}"]).max() < 1e-6 * float(
            forward_result.pressure.max()
        )


def test_large_creepage_is_full_sliding() -> None:
    result = solve_rolling(Rolling(longitudinal_creepage=50.0))
    assert float(result.force_y) == pytest.approx(FRICTION * LOAD, rel=1e-5)
    assert not result.stick.any()
    assert float(result.friction_work) == pytest.approx(50.0 * FRICTION * LOAD, rel=0.02)
    check_law(result)


def test_sticking_cells_are_at_leading_edge() -> None:
    """Rolling along +y, material enters at the leading edge without traction and sticks first."""
    result = solve_rolling(Rolling(longitudinal_creepage=0.01))
    middle_column = result.isel(x=13)
    sticking_y = result.y.values[middle_column.stick.values.astype(bool)]
    slipping_y = result.y.values[(middle_column.pressure.values > 0) & ~middle_column.stick.values.astype(bool)]
    assert sticking_y.min() > slipping_y.max()
    assert float(result.force_y) > 0


@pytest.mark.parametrize(
    "motion", [Rolling(longitudinal_creepage=0.008, spin=0.01), Shift(y=0.012)], ids=["roll", "shift"]
)
def test_material_mismatch_causes_slip(motion: Rolling | Shift) -> None:
    uncoupled_rigid = solve_rolling(motion, counterbody=None)
    check_law(uncoupled_rigid)
    coupled_rigid = solve_rolling(motion, counterbody=None, coupled=True)
    check_law(coupled_rigid)
    change = np.abs(coupled_rigid.pressure - uncoupled_rigid.pressure).max() / uncoupled_rigid.pressure.max()
    assert 1e-3 < float(change) < 0.2
    assert float(coupled_rigid.penetration_error) < 1e-5
    uncoupled_equal = solve_rolling(motion)
    coupled_equal = solve_rolling(motion, coupled=True)
    assert float(np.abs(uncoupled_equal.pressure - coupled_equal.pressure).max()) < 1e-9 * float(
        uncoupled_equal.pressure.max()
    )


def test_free_rolling_of_different_bodies_has_creepage() -> None:
    """A rigid ball rolls freely on a compressible body, without any force."""
    result = solve_rolling(Rolling(force_y=0.0, force_x=0.0), counterbody=None)
    check_law(result)
    assert abs(float(result.longitudinal_creepage)) > 1e-4
    assert abs(float(result.lateral_creepage)) < 1e-8
    assert float(np.hypot(result.traction_x, result.traction_y).max()) > 0


BODIES_WITH_ENDS: dict[str, Body] = {
    "quarter space": QuarterSpace(material=STEEL),
    "finite length": FiniteLengthSpace(length=2.6, material=STEEL),
}


@pytest.mark.parametrize(
    ("name", "motion"), [("quarter space", "shift"), ("finite length", "all"), ("finite length", "forces")]
)
def test_coulomb_law_holds_at_free_ends(name: str, motion: str) -> None:
    body, gap = BODIES_WITH_ENDS[name], make_ball_gap(26)
    gap = gap.assign_coords(x=gap.x + 1.3)
    counterbody = Counterbody(body) if isinstance(body, FiniteLengthSpace) else None
    check_law(solve_rolling(MOTIONS[motion], body=body, gap=gap, counterbody=counterbody))


def test_rolling_between_free_ends_is_symmetric_about_the_middle() -> None:
    grid = Grid(x_range=(0.0, 3.0), y_range=(-1.4, 1.4), cells_x=15, cells_y=28)
    gap = xr.DataArray(0.5 * grid.y**2 + 0 * grid.x[:, None], coords={"x": grid.x, "y": grid.y}, dims=("x", "y"))
    body = FiniteLengthSpace(length=3.0, material=STEEL)
    result = solve_contact(
        body, gap, load=1.0, friction=FRICTION, counterbody=Counterbody(body), motion=Rolling(longitudinal_creepage=0.1)
    )
    check_law(result)
    peak = float(result.pressure.max())
    assert np.abs(result.traction_y.values - result.traction_y.values[::-1]).max() < 1e-6 * peak
    assert np.abs(result.traction_x.values + result.traction_x.values[::-1]).max() < 1e-6 * peak
    # Near free ends the tractions have a transverse component, unlike on a half-space.
    assert 0.05 < float(np.abs(result.traction_x).max()) / (FRICTION * peak) < 0.5
    assert abs(float(result.force_x)) < 1e-6 * float(result.force_y)


def test_equal_flush_bodies_do_not_slip_under_pressure() -> None:
    grid = Grid(x_range=(0.0, 3.0), y_range=(-1.4, 1.4), cells_x=15, cells_y=28)
    gap = xr.DataArray(0.5 * grid.y**2 + 0 * grid.x[:, None], coords={"x": grid.x, "y": grid.y}, dims=("x", "y"))
    long_body, equal_body = FiniteLengthSpace(length=3.0, material=STEEL), FiniteLengthSpace(length=3.0, material=STEEL)
    flush_result = solve_contact(
        long_body, gap, load=1.0, friction=0.1, counterbody=Counterbody(equal_body), motion=Rolling()
    )
    assert float(np.hypot(flush_result.traction_x, flush_result.traction_y).max()) < 1e-8 * float(
        flush_result.pressure.max()
    )
    short_counterbody = Counterbody(FiniteLengthSpace(length=2.0, material=STEEL), start=0.4)
    short_gap = gap.where((gap.x > 0.4) & (gap.x < 2.4), np.inf)
    short_result = solve_contact(
        long_body, short_gap, load=0.7, friction=0.1, counterbody=short_counterbody, motion=Rolling()
    )
    assert float(np.abs(short_result.traction_x).max()) > 0.03 * float(short_result.pressure.max())
    assert float(short_result.friction_work) > 0


def test_sticking_contact_has_no_friction_work() -> None:
    """The elastic roller overhangs both ends of a body much narrower than its contact."""
    body = FiniteLengthSpace(length=0.29, material=STEEL, model="mirror")
    roller = Roller(radius=5e3, length=0.5, material=STEEL)
    motion = Rolling()
    case = Case(
        body=body, roller=roller, end_distance=-0.107, max_pressure=2.5e-5, friction=0.66, coupled=True, motion=motion
    )
    result = solve(case, grid=Grid(x_range=(0.0, 0.29), y_range=(-1.0, 1.3), cells_x=6, cells_y=16), stresses=False)
    assert float(np.abs(result.traction_y).max()) > 0
    assert not result.slip_x.any()
    assert float(result.friction_work) == 0.0


def test_zero_friction_has_zero_traction() -> None:
    result = solve_rolling(Rolling(longitudinal_creepage=0.1), friction=0.0)
    assert not result.traction_y.any()
    assert result.converged


def test_history_of_shifts_continues_tractions() -> None:
    """Mindlin and Deresiewicz (1953): unloading is a shift with twice the friction; a closed cycle returns to its
    start."""
    max_force = 0.6 * FRICTION * LOAD
    steps = [solve_rolling(Shift(force_y=max_force))]
    for force in (0.0, -max_force, 0.0, max_force):
        steps.append(solve_rolling(Shift(force_y=force), after=steps[-1]))
    loaded_step, unloaded_step, reversed_step, _, repeated_step = steps
    for step in steps:
        assert step.converged
    bound = FRICTION * float(loaded_step.pressure.max())
    assert np.abs(loaded_step.traction_y + reversed_step.traction_y).max() < 1e-3 * bound
    assert np.abs(loaded_step.traction_y - repeated_step.traction_y).max() < 1e-3 * bound
    # After unloading, tractions remain, reversed at the edge and along the first force inside.
    assert float(unloaded_step.traction_y.min()) < -0.02 * bound < 0.02 * bound < float(unloaded_step.traction_y.max())
    # The shift of a half-cycle is twice that of the first loading.
    shift = float(loaded_step.shift_y)
    half_cycle_shift = float(unloaded_step.shift_y) + float(reversed_step.shift_y)
    assert half_cycle_shift == pytest.approx(-2 * shift, rel=1e-3)
    two_step_result = solve_rolling(Shift(force_y=0.3 * FRICTION * LOAD))
    two_step_result = solve_rolling(Shift(force_y=max_force), after=two_step_result)
    assert np.abs(two_step_result.traction_y - loaded_step.traction_y).max() < 2e-3 * bound
    repeated_result = solve_rolling(Shift(), after=loaded_step)
    assert np.abs(repeated_result.traction_y - loaded_step.traction_y).max() < 1e-3 * bound


def test_invalid_input_raises_error() -> None:
    with pytest.raises(InvalidInputError, match=r"friction = -0.1.*not below zero"):
        solve_rolling(Rolling(), friction=-0.1)
    with pytest.raises(InvalidInputError, match=r"force_y = .* less than full sliding's force_y = .*Sliding\(\)"):
        solve_rolling(Rolling(force_y=1.01 * FRICTION * LOAD))
    with pytest.raises(InvalidInputError, match=r"force_y = .*full sliding"):
        solve_rolling(Rolling(force_y=0.0), friction=0.0)
    with pytest.raises(InvalidInputError, match=r"force_y, moment_z = .*force_y = .* N, moment_z = .* N m"):
        solve_rolling(Rolling(force_y=0.9 * FRICTION * LOAD, moment_z=0.4 * FRICTION * LOAD))
    shifted_result = solve_rolling(Shift(y=0.01))
    with pytest.raises(InvalidInputError, match="rolling is steady"):
        solve_rolling(Rolling(), after=shifted_result)
    with pytest.raises(InvalidInputError, match=r"after = .*cells"):
        solve_rolling(Shift(y=0.01), after=shifted_result, gap=make_ball_gap(20))
    with pytest.raises(InvalidInputError, match="after = 'without traction_x'"):
        solve_rolling(Shift(y=0.01), after=shifted_result.drop_vars("traction_x"))
    with pytest.raises(InvalidInputError, match=r"load = 0.0.*positive"):
        solve_rolling(Shift(y=0.01), after=shifted_result, load=0.0)
    with pytest.raises(InvalidInputError, match="motion = 'rolls'"):
        solve_rolling("rolls")  # type: ignore[arg-type]
    with pytest.raises(WindowError, match=r"last two cells along \+y"):
        solve_rolling(Rolling(), gap=make_ball_gap(26, 1.04))


GRADED_GRID = Grid.from_edges(np.concatenate([np.linspace(-1.3, 0.4, 15), np.linspace(0.5, 1.3, 19)]), (-1.3, 1.3), 26)


@pytest.mark.parametrize("name", ["all", "moment", "shift"])
def test_rolling_on_graded_cells_matches_uniform_cells(name: str) -> None:
    """On graded cells Coulomb's law holds, and the resultants approximate those on uniform cells."""
    gap = xr.DataArray(
        0.05 * (GRADED_GRID.x[:, None] ** 2 + GRADED_GRID.y**2),
        coords={"x": GRADED_GRID.x, "y": GRADED_GRID.y, "x_width": ("x", GRADED_GRID.widths)},
        dims=("x", "y"),
    )
    graded_result, uniform_result = solve_rolling(MOTIONS[name], gap=gap), solve_rolling(MOTIONS[name])
    check_law(graded_result)
    areas = GRADED_GRID.widths[:, None] * GRADED_GRID.dy
    for axis in "xy":
        assert float((graded_result[f"traction_{axis}"] * areas).sum()) == pytest.approx(
            float(graded_result[f"force_{axis}"])
        )
    scale = FRICTION * LOAD
    for name, load_scale in {
        "force_x": scale,
        "force_y": scale,
        "moment_z": scale,
        "friction_work": 0.02 * scale,
    }.items():
        assert float(graded_result[name]) == pytest.approx(float(uniform_result[name]), abs=0.01 * load_scale)


def test_fastsim_on_graded_cells_matches_uniform_cells() -> None:
    gap = xr.DataArray(
        0.05 * (GRADED_GRID.x[:, None] ** 2 + GRADED_GRID.y**2),
        coords={"x": GRADED_GRID.x, "y": GRADED_GRID.y, "x_width": ("x", GRADED_GRID.widths)},
        dims=("x", "y"),
    )
    motion = Rolling(longitudinal_creepage=0.01, spin=0.01, model="fastsim")
    graded_result, uniform_result = solve_rolling(motion, gap=gap), solve_rolling(motion)
    assert float(graded_result.force_y) == pytest.approx(float(uniform_result.force_y), abs=0.01 * FRICTION * LOAD)


def test_unconverged_tractions_warn() -> None:
    motion = Rolling(longitudinal_creepage=0.01)
    converged_result = solve_rolling(motion)
    with pytest.warns(ConvergenceWarning):
        result = solve_rolling(motion, max_iterations=2)
    assert converged_result.converged
    assert not result.converged
    assert float(result.slip_error) > 1e-6 or float(result.bound_error) > 1e-6


def test_reference_x_is_middle_of_finite_gap() -> None:
    """Further cells with an infinite gap, and another position along x, change no moment and no spin."""
    motion = Rolling(longitudinal_creepage=0.005, spin=0.02)
    baseline, gap = solve_rolling(motion, gap=make_ball_gap(centre_x=0.2)), make_ball_gap(centre_x=0.2)
    step = float(gap.x[1] - gap.x[0])
    wider_x = np.concatenate([gap.x.values, gap.x.values[-1] + step * np.arange(1.0, 9.0)]) + 5.0
    wider_gap = xr.DataArray(
        np.vstack([gap.values, np.full((8, gap.y.size), np.inf)]), coords={"x": wider_x, "y": gap.y}, dims=("x", "y")
    )
    wide_result = solve_rolling(motion, gap=wider_gap)
    for name in ("moment_z", "force_y", "friction_work"):
        assert float(wide_result[name]) == pytest.approx(float(baseline[name]), rel=1e-5)


def test_sticking_part_is_relative_to_loaded_area() -> None:
    result = solve_rolling(MOTIONS["all"])
    is_loaded = result.pressure > 0
    assert 0.05 < float(result.sticking_part) < 0.95
    assert float(result.sticking_part) == pytest.approx(float(result.stick.sum() / is_loaded.sum()))


@pytest.mark.slow
@pytest.mark.parametrize(("poisson", "spin"), [(0.3, 10.0), pytest.param(0.0, 5.0, marks=pytest.mark.slow)])
def test_pressure_and_tractions_of_a_large_spin_converge(poisson: float, spin: float) -> None:
    """Columns and leading edges chosen anew for each pressure would alternate between two choices."""
    steel = Material(210e9, poisson)
    crown = profiles.Lundberg.for_pressure(1.5e9, radius=5e-3, modulus=210e9 / 0.91)
    case = Case(
        body=QuarterSpace(material=steel),
        roller=Roller(radius=5e-3, length=1e-3, profile=crown),
        max_pressure=1.5e9,
        friction=0.3,
        coupled=True,
        motion=Rolling(spin=spin),
    )
    assert solve(case, stresses=False, accuracy=0.1).converged
