"""The compared codes as functions of one signature: pressure of a problem at a tolerance."""

from __future__ import annotations

import importlib
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np
import xarray as xr

from benchmarks.performance.classic import solve_classic
from benchmarks.performance.problems import FloatArray, Problem
from benchmarks.performance.timing import nudge
from contactstudy import solve_contact
from contactstudy.contact import ContactSettings

Solver = Callable[[Problem, float], FloatArray]

OURS = "ours"
SETTINGS = tuple(factor * 10.0**power for power in range(-4, -10, -1) for factor in (1.0, 0.3))
LIMIT_SETTING = 1e-10


def solve_ours(problem: Problem, tolerance: float) -> FloatArray:
    """Pressure by this package, with an empty cache."""
    return np.asarray(solve_peer_contact(problem, tolerance, stretch=nudge())["pressure"].values)


def solve_peer_contact(problem: Problem, tolerance: float = 1e-6, *, stretch: float = 1.0) -> xr.Dataset:
    """Contact by this package under a load that no earlier contact has; the operator of a `stretch` is reused."""
    return solve_contact(
        problem.body,
        problem.make_gap_array(stretch),
        load=problem.compute_changed_load(),
        settings=ContactSettings(tolerance=tolerance, max_iterations=5000),
    )


def _aspher() -> Solver:
    aspher = importlib.import_module("aspher")

    def solve(problem: Problem, tolerance: float) -> FloatArray:
        cells = problem.gap.shape[0]
        side_length = problem.size[0]
        result = aspher.solve_nested(
            grid_size=cells,
            gap=problem.gap.ravel(),
            p_nominal=problem.load / side_length**2,
            domain_size=side_length,
            E_star=problem.contact_modulus,
            tol=tolerance,
            backend="fft",
        )
        return np.asarray(result.pressure).reshape(problem.gap.shape)

    return solve


def _tamaas() -> Solver:
    tamaas = importlib.import_module("tamaas")
    tamaas.set_log_level(tamaas.LogLevel.error)

    def solve(problem: Problem, tolerance: float) -> FloatArray:
        # The stopping rule has units, so inputs are scaled to about 1.
        unit, depth = problem.size[1], float(np.ptp(problem.gap[np.isfinite(problem.gap)]))
        scale = problem.contact_modulus * depth / unit
        size = [length / unit for length in problem.size]
        model = tamaas.ModelFactory.createModel(tamaas.model_type.basic_2d, size, list(problem.gap.shape))
        # The operator uses the modulus at its registration.
        model.E, model.nu = 1.0, 0.0
        tamaas.ModelFactory.registerNonPeriodic(model, "dcfft")
        solver = tamaas.PolonskyKeerRey(model, -problem.finite_gap / depth, tolerance)
        solver.setIntegralOperator("dcfft")
        solver.max_iter = 5000
        solver.solve(problem.load / (problem.size[0] * problem.size[1]) / scale)
        return np.array(model.traction) * scale

    return solve


def _contact_mechanics() -> Solver:
    substrates = importlib.import_module("ContactMechanics")
    topography = importlib.import_module("SurfaceTopography")

    def solve(problem: Problem, tolerance: float) -> FloatArray:
        shape = problem.gap.shape
        substrate = substrates.FreeFFTElasticHalfSpace(shape, problem.contact_modulus, physical_sizes=problem.size)
        surface = topography.Topography(-problem.finite_gap, problem.size)
        system = substrates.Systems.NonSmoothContactSystem(substrate, surface)
        depth = np.ptp(problem.gap[np.isfinite(problem.gap)])
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            result = system.minimize_proxy(
                external_force=problem.load,
                pentol=tolerance * depth,
                forcetol=tolerance * problem.load,
                thermotol=tolerance,
                maxiter=5000,
            )
        if not result.success:
            raise RuntimeError(str(result.message))
        cell_area = problem.size[0] * problem.size[1] / problem.gap.size
        return np.asarray(result.jac)[: shape[0], : shape[1]] / cell_area

    return solve


SOLVER_FACTORIES = {"aspher": _aspher, "tamaas": _tamaas, "ContactMechanics": _contact_mechanics}


def load_codes(names: tuple[str, ...], remark: Callable[[str], None]) -> Iterator[tuple[str, Solver]]:
    """Yield this package and the installed codes; pass the reason for each missing code to `remark`."""
    yield OURS, solve_ours
    for name in names:
        if name == "plain SciPy":
            yield name, solve_classic
            continue
        try:
            yield name, SOLVER_FACTORIES[name]()
        except ImportError as error:
            remark(f"{name} is skipped: {error}")


@contextmanager
def ignore_warnings() -> Iterator[None]:
    """Suppress the warnings of codes at tolerances below their rounding errors."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield
