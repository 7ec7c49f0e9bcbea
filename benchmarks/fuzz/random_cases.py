"""Random cases of plausible dimensions, on few cells."""

from __future__ import annotations

from dataclasses import dataclass, replace
from random import Random

import numpy as np

from benchmarks.fuzz.motions import draw_motion, mirror_motion, scale_motion
from benchmarks.fuzz.shapes import draw_magnitude, draw_profile, mirror_profile, stretch_profile
from contactstudy import Case, FiniteLengthSpace, Grid, HalfSpace, Material, QuarterSpace, Roller
from contactstudy.bodies.material import contact_modulus
from contactstudy.bodies.models import MODELS, Body

REFINED_FRACTION = 0.06
"""Fraction of the cases with refined cells, which take several seconds."""

MOVING_FRACTION = 0.2
"""Fraction of the cases with rolling or a shift, with stick and slip."""


@dataclass(frozen=True)
class RandomCase:
    """Case and settings of the solver.

    Attributes
    ----------
    case : Case
        Random case.
    grid : Grid or None
        Given cells; None if the solver refines the cells.
    accuracy : float
        Accuracy of refined cells.
    """

    case: Case
    grid: Grid | None
    accuracy: float = 0.05

    def reverse_case(self) -> RandomCase:
        """Return the case mirrored about mid-length, for symmetric bodies."""
        case, grid = self.case, self.grid
        low, high = case.body.extent
        length = low + high if np.isfinite(high) else 2 * case.roller_start + case.roller.length
        position = case.load_position
        mirrored_case = replace(
            case,
            roller=replace(case.roller, profile=mirror_profile(case.roller.profile)),
            end_distance=length - case.roller_start - case.roller.length,
            tilt=-case.tilt,
            load_position=None if position is None else length - position,
            motion=mirror_motion(case.motion),
        )
        if grid is None:
            return replace(self, case=mirrored_case)
        edges = (length - grid.x_edges)[::-1]
        if np.isfinite(high):
            edges[0], edges[-1] = 0.0, high
        return replace(self, case=mirrored_case, grid=make_grid(grid, edges, grid.y_range))

    def scale(self, length: float, modulus: float) -> RandomCase:
        """Return the case with every length and every modulus multiplied: strains are unchanged."""
        case, grid = self.case, self.grid

        def scale_material(material: Material) -> Material:
            return Material(modulus * material.young, material.poisson)

        def multiply(value: float | None, factor: float) -> float | None:
            return None if value is None else factor * value

        body, roller = case.body, case.roller
        length_argument = {"length": length * body.length} if isinstance(body, FiniteLengthSpace) else {}
        scaled_case = Case(
            body=replace(body, material=scale_material(body.material), **length_argument),
            roller=Roller(
                radius=length * roller.radius,
                length=length * roller.length,
                profile=stretch_profile(roller.profile, length),
                material=None if roller.material is None else scale_material(roller.material),
                ends=roller.ends,
            ),
            max_pressure=multiply(case.max_pressure, modulus),
            load=multiply(case.load, modulus * length**2),
            friction=case.friction,
            end_distance=multiply(case.end_distance, length),
            coupled=case.coupled,
            tilt=case.tilt,
            load_position=multiply(case.load_position, length),
            motion=scale_motion(case.motion, length, modulus),
        )
        if grid is None:
            return replace(self, case=scaled_case)
        edges = length * grid.x_edges
        if np.isfinite(high := scaled_case.body.extent[1]):
            edges[-1] = high
        return replace(
            self, case=scaled_case, grid=make_grid(grid, edges, (length * grid.y_range[0], length * grid.y_range[1]))
        )


def make_grid(grid: Grid, edges: np.ndarray, y_range: tuple[float, float]) -> Grid:
    """Grid of the same number of cells on other edges, uniform if `grid` is uniform."""
    if grid.uniform:
        return Grid(
            x_range=(float(edges[0]), float(edges[-1])), y_range=y_range, cells_x=grid.cells_x, cells_y=grid.cells_y
        )
    return Grid.between(edges, y_range, grid.cells_y)


def draw_material(rng: Random) -> Material:
    """From rubber to diamond; Poisson's ratio often at a limit."""
    poisson = rng.choice((0.3, 0.3, 0.0, 0.5, rng.uniform(-0.5, 0.5)))
    return Material(rng.choice((210e9, draw_magnitude(rng, 1e6, 1e12))), poisson)


def draw_case(rng: Random, *, refined: bool | None = None) -> RandomCase:
    """Draw a case and its cells; refined or given cells at random by default.

    Raises
    ------
    ContactStudyError
        If the drawn parameters contradict each other.
    """
    material = draw_material(rng)
    radius = rng.choice((5e-3, draw_magnitude(rng, 1e-7, 1.0)))
    strain = draw_magnitude(rng, 1e-4, 0.05)  # half-width over radius
    half_width = strain * radius
    length = half_width * draw_magnitude(rng, 0.5, 12.0)
    roller = Roller(
        radius=radius,
        length=length,
        profile=draw_profile(rng, radius, length, 0.5 * half_width * strain),
        material=rng.choice((None, None, None, material, draw_material(rng))),
        ends=rng.choice(("free", "free", "none")),
    )
    body = _draw_body(rng, material, length, half_width)
    pressure = 0.5 * strain * contact_modulus(material, roller.material)
    case = Case(
        body=body,
        roller=roller,
        friction=rng.choice((0.0, 0.1, rng.uniform(-1.0, 1.0))),
        coupled=rng.random() < 0.25,
        end_distance=_draw_end_distance(rng, body, length, half_width),
        max_pressure=pressure,
    )
    case = replace(case, **_draw_tilt(rng, case, strain))
    if rng.random() < 0.3:
        case = replace(case, max_pressure=None, load=case.normal_load)
    random_case = _add_cells(rng, case, refined)
    if rng.random() < MOVING_FRACTION:
        friction = abs(case.friction) or 0.1
        moving_case = replace(case, friction=friction, motion=draw_motion(rng, case, friction))
        random_case = replace(random_case, case=moving_case)
    return random_case


def _draw_body(rng: Random, material: Material, length: float, half_width: float) -> Body:
    """A body longer than the roller, or about as long."""
    kind = rng.choice((FiniteLengthSpace, FiniteLengthSpace, FiniteLengthSpace, QuarterSpace, HalfSpace))
    if kind is HalfSpace:
        return HalfSpace(material=material)
    model = rng.choice(("exact", "exact", "exact", rng.choice(MODELS)))
    if kind is QuarterSpace:
        return QuarterSpace(material=material, model="exact" if model == "single-mirror" else model)
    added_length = rng.choice((0.0, rng.uniform(0.0, 4.0) * half_width, rng.uniform(-0.5, 0.0) * length))
    return FiniteLengthSpace(length=length + added_length, material=material, model=model)


def _draw_end_distance(rng: Random, body: Body, length: float, half_width: float) -> float | None:
    """Flush, inside, or overhanging."""
    if isinstance(body, FiniteLengthSpace) and body.length < length:
        return rng.choice((0.5, rng.random())) * (body.length - length)
    return rng.choice((None, 0.0, rng.uniform(0.0, 3.0) * half_width, -rng.uniform(0.0, 0.4) * length))


def _draw_tilt(rng: Random, case: Case, strain: float) -> dict[str, float]:
    """Held tilt, a prescribed position of the load, or neither."""
    draw = rng.random()
    start, stop = case.contact_range
    if draw < 0.2:
        depth = 0.5 * strain**2 * case.roller.radius
        return {"tilt": rng.uniform(-1, 1) * min(depth / case.contact_length, 0.05)}
    if draw < 0.4:
        return {"load_position": start + rng.uniform(0.3, 0.7) * (stop - start)}
    return {}


def _add_cells(rng: Random, case: Case, refined: bool | None) -> RandomCase:
    """Uniform, graded or refined cells."""
    draw = rng.random()
    if draw < REFINED_FRACTION if refined is None else refined:
        return RandomCase(case, None, rng.choice((0.1, 0.1, 0.05, 0.02)))
    a = case.hertz_half_width
    half_window = rng.choice((2.0, 2.0, 3.0, 4.0)) * a
    low, high = case.body.extent
    start, stop = case.roller_start, case.roller_start + case.roller.length
    margin = 2 * half_window
    x_start = low if np.isfinite(low) else start - margin
    x_stop = high if np.isfinite(high) else stop + margin
    window = (-half_window, half_window)
    if rng.random() < 0.1:  # a window that is not symmetric in y
        window = (-half_window, 1.3 * half_window)
    cells_y = rng.randint(10, 20)
    if draw < 0.7:
        cells_x = max(6, min(40, round((x_stop - x_start) / a * rng.uniform(2.0, 5.0))))
        if rng.random() < 0.1:
            cells_x = 2 * rng.randint(1, 4)
        return RandomCase(case, Grid(x_range=(x_start, x_stop), y_range=window, cells_x=cells_x, cells_y=cells_y))
    return RandomCase(
        case, Grid.from_edges(_draw_graded_edges(rng, x_start, x_stop, rng.randint(6, 30)), window, cells_y)
    )


def _draw_graded_edges(rng: Random, x_start: float, x_stop: float, cells: int) -> np.ndarray:
    """Edges whose steps vary by up to a factor of 1.8 from one to the next."""
    steps = np.exp(np.cumsum([rng.uniform(-0.55, 0.55) for _ in range(cells)]))
    edges = x_start + (x_stop - x_start) * np.concatenate([[0.0], np.cumsum(steps) / steps.sum()])
    edges[-1] = x_stop
    return np.asarray(edges)
