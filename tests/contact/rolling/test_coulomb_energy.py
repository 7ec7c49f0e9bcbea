"""Tractions under a shift as the minimum of an energy."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

import contactstudy as cs
from contactstudy.checks import FloatArray
from contactstudy.contact import ContactSettings
from contactstudy.contact.rolling.coulomb import CoulombProblem, solve_coulomb
from contactstudy.fields.surface import SurfaceOperator
from tests.contact.rolling.test_coulomb import check_law, make_problem

CELLS = 24


def make_graded_problem(seed: int, *, unit: float = 1.0, pressure: float = 1.0, forces: bool = False) -> CoulombProblem:
    """Cells of different sizes in some units, on which the compliance times the areas is symmetric."""
    rng = np.random.default_rng(seed)
    bound, areas = pressure * rng.uniform(0.2, 1.0, CELLS), rng.uniform(0.2, 2.0, CELLS)
    prescribed_forces = 0.6 * float((areas * bound).sum()) * np.array([0.6, -0.8]) if forces else None
    template = make_problem(0.3 * unit * rng.standard_normal((2, CELLS)), bound, forces=prescribed_forces, seed=seed)
    columns = [
        template.apply_compliance(unit_traction.reshape(2, CELLS)).ravel() for unit_traction in np.eye(2 * CELLS)
    ]
    matrix = unit / pressure * np.stack(columns, axis=1) * np.tile(areas, 2)
    inverse = np.linalg.inv(matrix)
    return replace(
        template,
        apply_compliance=lambda traction: (matrix @ traction.ravel()).reshape(traction.shape),
        inverse=lambda slip: (inverse @ slip.ravel()).reshape(slip.shape),
        resultant_weights=0.01 * areas * template.resultant_weights,
        resultants=0.01 * template.resultants,
        relative_areas=areas,
        symmetric=True,
    )


def minimise_energy(request: CoulombProblem) -> FloatArray:
    """Minimise the energy by projected gradients of equal step lengths."""
    step_length = 1 / np.linalg.norm(
        [request.apply_compliance(unit_traction.reshape(2, CELLS)).ravel() for unit_traction in np.eye(2 * CELLS)], 2
    )
    traction = np.zeros_like(request.prescribed_slip)
    for _ in range(4000):
        traction = traction + step_length * request.slip(traction, np.zeros(0))
        traction = traction * np.minimum(1.0, request.bound / np.maximum(np.hypot(*traction), 1e-300))
    return traction


@pytest.mark.parametrize("seed", range(4))
def test_newton_minimises_energy(seed: int) -> None:
    request = make_graded_problem(seed)
    assert np.abs(solve_coulomb(request).traction - minimise_energy(request)).max() < 1e-5


@pytest.mark.parametrize(("unit", "pressure"), [(1e-6, 1.0), (1.0, 1.0), (1.0, 1e-9), (1e3, 1e9)])
@pytest.mark.parametrize("forces", [False, True])
def test_newton_converges_in_any_unit(unit: float, pressure: float, *, forces: bool) -> None:
    request = make_graded_problem(8, unit=unit, pressure=pressure, forces=forces)
    computed = solve_coulomb(request)
    assert computed.converged
    assert computed.steps == solve_coulomb(make_graded_problem(8, forces=forces)).steps
    check_law(request, computed)


@pytest.mark.parametrize("seed", range(3))
def test_every_step_reduces_energy(seed: int) -> None:
    request = make_graded_problem(seed)
    solutions = [solve_coulomb(replace(request, max_steps=steps)) for steps in range(1, 12)]
    energies = [request.energy(solution.traction, solution.slip, solution.amplitudes) for solution in solutions]
    assert (np.diff(energies) < 1e-12 * abs(energies[-1])).all()
    assert energies[0] < request.energy(np.zeros_like(request.prescribed_slip), request.prescribed_slip, np.zeros(0))


@pytest.mark.parametrize(
    ("poisson", "friction", "length", "width", "drop", "load", "force"),
    [
        (0.0, 0.3, 0.3286e-3, 0.4766e-3, 1.376e-6, 46.73, (-4.121, -11.925)),
        (0.5, 0.05, 0.7195e-3, 0.4949e-3, 1.1905e-6, 93.76, (0.1754, 0.1556)),
    ],
)
def test_shift_of_rigid_roller_between_ends_takes_few_applications(
    monkeypatch: pytest.MonkeyPatch,
    poisson: float,
    friction: float,
    length: float,
    width: float,
    drop: float,
    load: float,
    force: tuple[float, float],
) -> None:
    """An iteration of active sets alone cycles on these cases."""
    steel = cs.Material(200e9, poisson)
    x = (np.arange(40) + 0.5) * length / 40
    y = (np.arange(24) - 11.5) * width / 24
    height = (drop * (2 * x / length - 1) ** 2)[:, None] + y**2 / 10e-3
    gap = xr.DataArray(height, coords={"x": x, "y": y}, dims=("x", "y"))
    applications = []
    apply_operator = SurfaceOperator.compute_displacements

    def count_applications(operator: SurfaceOperator, *arguments: object) -> object:
        applications.append(arguments)
        return apply_operator(operator, *arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(SurfaceOperator, "compute_displacements", count_applications)
    result = cs.solve_contact(
        cs.FiniteLengthSpace(length=length, material=steel),
        gap,
        load=load,
        friction=friction,
        motion=cs.Shift(force_x=force[0], force_y=force[1]),
        settings=ContactSettings(tolerance=1e-6),
    )
    assert bool(result["converged"])
    assert [float(result["force_x"]), float(result["force_y"])] == pytest.approx(force, rel=1e-5)
    assert len(applications) < 300
