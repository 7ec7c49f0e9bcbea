"""The elastic bodies and their free end faces, and the second body of a contact.

Axes of the package: x along the roller's axis, y the rolling and sliding direction, z into the
body from its loaded top ``z = 0``. No body has a boundary in y or at depth.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from contactstudy import checks
from contactstudy.arrays.engineering import format_quantity
from contactstudy.arrays.grid import Grid, growing_edges
from contactstudy.bodies.material import Material
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError

Extent = tuple[float, float]


class FreeEnds(NamedTuple):
    """Free ends, from which the normal stress of the mirrored loads is removed."""

    length: float  # m; infinite for one end
    mirrored_once: bool = False  # one pair of images instead of all


class BodyTerm(NamedTuple):
    """Term of a body's weighted sum: a half-space with the load mirrored in the ends."""

    weight: float
    extent: Extent  # positions of the mirrors; infinite for none
    free_ends: FreeEnds | None = None


# Maximum ratio of a cell's sides, and of the window's width to the body's length; more suggest a wrong unit. Limit.
MAX_CELL_RATIO, MAX_WINDOW_RATIO = 1e6, 1e4
WHOLE_LINE: Extent = (-np.inf, np.inf)


@dataclass(frozen=True, kw_only=True, repr=False)
class Body:
    """Base of the elastic bodies below ``z = 0``.

    Parameters
    ----------
    material : Material
        Material of the body.
    reference_depth : float, optional
        Depth (m) of the material line along x, below the load, to which approach and tilt of a contact refer, such as
        the axis of a roller or the thickness of a ring. Default: the length between two free ends; else infinite.
    """

    material: Material
    reference_depth: float | None = field(default=None, metadata=checks.number(checks.positive, "metres"))

    def __post_init__(self) -> None:
        if type(self) in (Body, BodyWithFreeEnds):
            raise InvalidInputError("body", type(self).__name__, "a HalfSpace, a QuarterSpace or a FiniteLengthSpace")
        checks.instance("material", self.material, Material, "a Material")
        checks.store_numbers(self)

    def __repr__(self) -> str:
        low, high = self.extent
        values = [f"L = {format_quantity(high, 'm')}"] if np.isfinite(high - low) else []
        values.append(f"E = {format_quantity(self.material.young, 'Pa')}, nu = {self.material.poisson:g}")
        if self.reference_depth is not None:
            values.append(f"reference depth {format_quantity(self.reference_depth, 'm')}")
        model = getattr(self, "model", "exact")
        return f"{type(self).__name__}({', '.join(values if model == 'exact' else [*values, f'model={model!r}'])})"

    @property
    def extent(self) -> Extent:
        """Smallest and largest x inside the body, metres (infinite where it has no end)."""
        return WHOLE_LINE

    @property
    def terms(self) -> tuple[BodyTerm, ...]:
        """Half-spaces whose weighted sum is the body."""
        return (BodyTerm(1.0, self.extent),)

    def check_span(self, grid: Grid) -> None:
        """Raise unless a grid begins at the body's end, or spans both ends, with cells and window in proportion."""
        low, high = self.extent
        start, stop = grid.x_range
        # The tolerance allows for rounding of the grid's edge and the body's end.
        tolerance = 1e-3 * grid.dx
        if np.isfinite(low) and abs(start - low) > tolerance:
            raise InvalidInputError("x", f"cells from {start:g} m", f"cells that begin at the free end, {low:g} m")
        if np.isfinite(high) and abs(stop - high) > tolerance:
            raise InvalidInputError("x", f"cells up to {stop:g} m", f"cells that end at the free end, {high:g} m")
        if not 1 / MAX_CELL_RATIO <= grid.dx / grid.dy <= MAX_CELL_RATIO:
            sides = f"{grid.dx:.3g} by {grid.dy:.3g} m"
            raise InvalidInputError("grid", f"cells of {sides}", f"with sides in a ratio of at most {MAX_CELL_RATIO:g}")
        window = grid.y_range[1] - grid.y_range[0]
        if window > MAX_WINDOW_RATIO * (high - low):
            allowed = f"a window along y of at most {MAX_WINDOW_RATIO:g} times the body's length, {high - low:.3g} m"
            raise InvalidInputError("y", f"a window of {window:.3g} m", allowed)

    @property
    def depth(self) -> float:
        """Depth of the line to which approach and tilt refer, metres; infinite far away."""
        if self.reference_depth is not None:
            return self.reference_depth
        return self.extent[1] - self.extent[0]


@dataclass(frozen=True, kw_only=True, repr=False)
class HalfSpace(Body):
    """Elastic half-space ``z >= 0``: no free end.

    Examples
    --------
    >>> HalfSpace(material=Material(210e9, 0.3)).extent
    (-inf, inf)
    """


MODELS = ("exact", "mirror", "mirror-factor", "single-mirror")


@dataclass(frozen=True, kw_only=True, repr=False)
class BodyWithFreeEnds(Body):
    """A body with free ends; :class:`FiniteLengthSpace` describes the models."""

    model: str = "exact"

    def __post_init__(self) -> None:
        super().__post_init__()
        checks.known_name("model", self.model, MODELS)

    @property
    def terms(self) -> tuple[BodyTerm, ...]:
        """Half-spaces whose weighted sum is the body."""
        if self.model == "mirror-factor":
            factor = guilbault_factor(self.material.poisson)
            return (BodyTerm(factor, self.extent), BodyTerm(1 - factor, WHOLE_LINE))
        low, high = self.extent
        if self.model == "single-mirror":
            # The load and one image per end: two pairs of load and image, less the load that is in both pairs.
            free_ends = FreeEnds(high, mirrored_once=True)
            return (BodyTerm(1.0, (low, np.inf), free_ends), BodyTerm(1.0, (-np.inf, high)), BodyTerm(-1.0, WHOLE_LINE))
        return (BodyTerm(1.0, self.extent, FreeEnds(high) if self.model == "exact" else None),)


def guilbault_factor(poisson: float) -> float:
    """Guilbault's factor on mirrored loads, ``1.29 - (0.08 - 0.5 nu) / (1 - nu)`` (J. Tribology 133 (2011) 031402).

    The factor is quoted from a secondary source: compare with the exact ends.
    """
    return 1.29 - (0.08 - 0.5 * poisson) / (1 - poisson)


@dataclass(frozen=True, kw_only=True, repr=False)
class QuarterSpace(BodyWithFreeEnds):
    """Elastic body ``x >= 0``, ``z >= 0`` with one free end face at ``x = 0``.

    Parameters
    ----------
    material : Material
        Material of the body.
    model : str
        Model of the end, "exact", "mirror" or "mirror-factor": see :class:`FiniteLengthSpace`.

    Examples
    --------
    >>> QuarterSpace(material=Material(210e9, 0.3)).extent
    (0.0, inf)
    """

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.model == "single-mirror":
            hint = 'a single mirror is exact for one end: use "exact"'
            raise InvalidInputError("model", self.model, "a model of one end", hint)

    @property
    def extent(self) -> Extent:
        """Smallest and largest x inside the body, metres."""
        return (0.0, np.inf)


@dataclass(frozen=True, kw_only=True, repr=False)
class FiniteLengthSpace(BodyWithFreeEnds):
    """Elastic body ``0 <= x <= length``, ``z >= 0`` with free end faces I at ``x = 0`` and II at ``x = length``.

    Parameters
    ----------
    length : float
        Distance between the free ends (``L_f``), metres.
    material : Material
        Material of the body.
    model : str
        Model of the ends. "exact" has free ends. The other models are for comparison: "mirror" mirrors
        the load and leaves the normal stress on the ends; "mirror-factor" multiplies the mirrored loads by
        Guilbault's factor as compensation. "single-mirror" mirrors the load once in either end and removes the normal
        stress of both ends by two separate half-spaces: the scheme of Zhang, Wang and Wong, which leaves some shear on
        the ends.

    Raises
    ------
    InvalidInputError
        If the length is not a positive number, or the model is unknown.

    Examples
    --------
    >>> FiniteLengthSpace(length=16e-3, material=Material(210e9, 0.3)).extent
    (0.0, 0.016)
    """

    length: float = field(metadata=checks.number(checks.positive, "metres"))

    @property
    def extent(self) -> Extent:
        """Smallest and largest x inside the body, metres."""
        return (0.0, self.length)


ALIGNMENT_TOLERANCE = 1e-6  # Distance over a cell's width of an edge at the counterbody's end. Rounding.


@dataclass(frozen=True)
class Counterbody:
    """The second body of a contact, in coordinates from its end I.

    Parameters
    ----------
    body : Body
        A half-space, or a finite-length space.
    start : float
        Position of its end I on the first body's x axis, metres.
    """

    body: Body
    start: float = 0.0

    def __post_init__(self) -> None:
        if not isinstance(self.body, HalfSpace | FiniteLengthSpace):
            raise InvalidInputError("counterbody", self.body, "a HalfSpace or a FiniteLengthSpace")

    def grid_on_body(self, grid: Grid) -> Grid:
        """Return cells in the counterbody's coordinate, over its whole length if it has ends.

        For a uniform `grid` these cells are about as large as its cells; else they equal the cells of `grid`, with
        edges at the ends of both bodies, and a few further cells on overhanging ends.
        """
        if not isinstance(self.body, FiniteLengthSpace):
            if not grid.uniform:
                return Grid.between(grid.x_edges - self.start, grid.y_range, grid.cells_y)
            return replace(grid, x_range=(grid.x_range[0] - self.start, grid.x_range[1] - self.start))
        if grid.uniform:
            cell_count = max(4, round(self.body.length / grid.dx))
            return Grid(x_range=(0.0, self.body.length), y_range=grid.y_range, cells_x=cell_count, cells_y=grid.cells_y)
        edges, stop = grid.x_edges - self.start, self.body.length
        tolerance = ALIGNMENT_TOLERANCE * grid.widths.min()
        for end in (0.0, stop):
            if edges[0] < end < edges[-1] and np.abs(edges - end).min() > tolerance:
                allowed = "cells that meet the ends of both bodies where their widths differ"
                raise InvalidInputError("grid", f"cells without a border at x = {self.start + end:g} m", allowed)
        inner_edges, widths = edges[(edges > tolerance) & (edges < stop - tolerance)], grid.widths
        low_edges = -growing_edges(edges[0], widths[0])[::-1] + edges[0] if edges[0] > tolerance else np.zeros(1)
        high_edges = growing_edges(stop - edges[-1], widths[-1]) + edges[-1] if stop - edges[-1] > tolerance else [stop]
        body_edges = np.concatenate([low_edges, inner_edges, high_edges])
        body_edges[0], body_edges[-1] = 0.0, stop
        return Grid.between(body_edges, grid.y_range, grid.cells_y)

    def overlap(self, grid: Grid) -> FloatArray:
        """Return the overlaps (cell of the counterbody, cell of `grid`), metres.

        A uniform cell with its centre on the counterbody overlaps entirely; the counterbody's last cells include
        the overhang of such cells, which preserves the load.
        """
        body_edges, edges = self.start + self.grid_on_body(grid).x_edges, grid.x_edges
        tolerance = ALIGNMENT_TOLERANCE * grid.widths.min()
        is_inside = (grid.x > body_edges[0] - tolerance) & (grid.x < body_edges[-1] + tolerance)
        body_edges[0], body_edges[-1] = min(body_edges[0], edges[0]), max(body_edges[-1], edges[-1])
        low = np.maximum(body_edges[:-1, None], edges[None, :-1])
        high = np.minimum(body_edges[1:, None], edges[None, 1:])
        overlaps = np.maximum(high - low, 0.0)
        overlaps[overlaps < tolerance] = 0.0
        return np.asarray(overlaps * is_inside)

    def transfer_load(self, grid: Grid, load: FloatArray) -> FloatArray:
        """Transfer a load on the cells of `grid` to the counterbody's cells, with the same resultant."""
        return np.asarray(self.overlap(grid) @ load / self.grid_on_body(grid).widths[:, None])
