"""The elastic bodies: where they have free end faces.

Axes are those of the whole package: x along the roller's axis, y the rolling and sliding direction, z into the
body from its loaded top ``z = 0``. No body has a boundary in y or at depth.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from contactstudy import checks
from contactstudy.arrays.engineering import quantity
from contactstudy.arrays.grid import Grid
from contactstudy.arrays.html_table import html_table
from contactstudy.bodies.material import Material
from contactstudy.bodies.words import body_words, material_rows
from contactstudy.errors import InvalidInputError

Extent = tuple[float, float]


class FreedEnds(NamedTuple):
    """Ends from which the normal stress is removed that mirroring leaves there.

    Attributes
    ----------
    length : float
        Distance between the ends, metres; infinite for one end.
    mirrored_once : bool
        Whether the loads have one pair of images only, instead of all.
    """

    length: float
    mirrored_once: bool = False


class Part(NamedTuple):
    """One of the solutions whose weighted sum is a body's: a half-space with the load mirrored in its ends.

    Attributes
    ----------
    weight : float
        Its share.
    extent : tuple of float
        Where the mirrors stand; infinite for none.
    freed : FreedEnds or None
        The ends that are freed along with this part, if any.
    """

    weight: float
    extent: Extent
    freed: FreedEnds | None = None


END_TOLERANCE = 1e-3
"""Distance, over a cell, between the grid's edge and the body's end that rounding may leave. Accuracy."""

LONGEST_CELL, WIDEST_WINDOW = 1e6, 1e4
"""Ratio of a cell's sides, and width of the window over the body's length, beyond which a unit is wrong."""

WHOLE_LINE: Extent = (-np.inf, np.inf)


@dataclass(frozen=True, kw_only=True, repr=False)
class Body:
    """An elastic body below ``z = 0``; use one of its kinds.

    Parameters
    ----------
    material : Material
        What the body is made of.
    """

    material: Material

    def __post_init__(self) -> None:
        """Check the material, and that it is one of the kinds: this one has no ends and no model."""
        if type(self) in (Body, EndedBody):
            raise InvalidInputError("body", type(self).__name__, "a HalfSpace, a QuarterSpace or a FiniteLengthSpace")
        checks.instance("material", self.material, Material, "a Material")

    def __repr__(self) -> str:
        low, high = self.extent
        said = [f"L = {quantity(high, 'm')}"] if np.isfinite(high - low) else []
        said.append(f"E = {quantity(self.material.young, 'Pa')}, nu = {self.material.poisson:g}")
        model = getattr(self, "model", "exact")
        return f"{type(self).__name__}({', '.join(said if model == 'exact' else [*said, f'model={model!r}'])})"

    def _repr_html_(self) -> str:
        return html_table([("Body", [("kind", body_words(self))]), ("Material", material_rows(self.material))])

    @property
    def extent(self) -> Extent:
        """Smallest and largest x inside the body, metres (infinite where it has no end)."""
        return WHOLE_LINE

    @property
    def parts(self) -> tuple[Part, ...]:
        """Solutions whose weighted sum is this body's."""
        return (Part(1.0, self.extent),)

    def check_span(self, grid: Grid) -> None:
        """Raise unless a grid covers the body's x from its end, or from end to end, and is in proportion."""
        low, high = self.extent
        start, stop = grid.x_range
        tolerance = END_TOLERANCE * grid.dx
        if np.isfinite(low) and abs(start - low) > tolerance:
            raise InvalidInputError("x", f"cells from {start:g} m", f"cells that begin at the free end, {low:g} m")
        if np.isfinite(high) and abs(stop - high) > tolerance:
            raise InvalidInputError("x", f"cells up to {stop:g} m", f"cells that end at the free end, {high:g} m")
        if not 1 / LONGEST_CELL <= grid.dx / grid.dy <= LONGEST_CELL:
            sides = f"{grid.dx:.3g} by {grid.dy:.3g} m"
            raise InvalidInputError("grid", f"cells of {sides}", f"with sides in a ratio of at most {LONGEST_CELL:g}")
        window = grid.y_range[1] - grid.y_range[0]
        if window > WIDEST_WINDOW * (high - low):
            allowed = f"a window along y of at most {WIDEST_WINDOW:g} times the body's length, {high - low:.3g} m"
            raise InvalidInputError("y", f"a window of {window:.3g} m", allowed)

    @property
    def unbounded_row(self) -> float:
        """Distance between the ends of a row of images without end, metres; infinite if the images are finite.

        Far from such a row the displacement grows like a logarithm, so it has no absolute value.
        """
        return min(part.extent[1] - part.extent[0] for part in self.parts)


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
class EndedBody(Body):
    """A body with free ends; use one of its kinds.

    Parameters
    ----------
    model : str
        How the ends are treated. "exact" frees them. The others are quick fixes in use, for comparison: "mirror"
        mirrors the load and leaves the normal stress on the ends; "mirror-factor" multiplies the mirrored loads by
        `guilbault_factor` to make up for it. "single-mirror", for two ends only, mirrors the load once in either end
        and takes the normal stress from both by two separate half-spaces: the scheme of Zhang, Wang and Wong, which
        leaves some shear on the ends.
    """

    model: str = "exact"

    def __post_init__(self) -> None:
        """Check material and model."""
        super().__post_init__()
        checks.instance("model", self.model, str, "a name")
        checks.known_name("model", self.model, MODELS)

    @property
    def parts(self) -> tuple[Part, ...]:
        """Solutions whose weighted sum is this body's."""
        if self.model == "mirror-factor":
            factor = guilbault_factor(self.material.poisson)
            return (Part(factor, self.extent), Part(1 - factor, WHOLE_LINE))
        low, high = self.extent
        if self.model == "single-mirror":
            # A load and one image in either end: each end's own pair, and the load that both have counted.
            freed = FreedEnds(high, mirrored_once=True)
            return (Part(1.0, (low, np.inf), freed), Part(1.0, (-np.inf, high)), Part(-1.0, WHOLE_LINE))
        return (Part(1.0, self.extent, FreedEnds(high) if self.model == "exact" else None),)


def guilbault_factor(poisson: float) -> float:
    """Guilbault's factor on mirrored loads, ``1.29 - (0.08 - 0.5 nu) / (1 - nu)``.

    Quoted second-hand from R. Guilbault, A fast correction for elastic quarter-space applied to 3D modeling of edge
    contact problems, J. Tribology 133 (2011) 031402; compare with the exact ends before relying on it.

    Examples
    --------
    >>> round(guilbault_factor(0.3), 3)
    1.39
    """
    return 1.29 - (0.08 - 0.5 * poisson) / (1 - poisson)


@dataclass(frozen=True, kw_only=True, repr=False)
class QuarterSpace(EndedBody):
    """Elastic body ``x >= 0``, ``z >= 0`` with one free end face at ``x = 0``.

    Parameters
    ----------
    material : Material
        What the body is made of.
    model : str
        How the end is treated, see `EndedBody`; "exact" unless a comparison is wanted.

    Examples
    --------
    >>> QuarterSpace(material=Material(210e9, 0.3)).extent
    (0.0, inf)
    """

    def __post_init__(self) -> None:
        """Check material and model."""
        super().__post_init__()
        if self.model == "single-mirror":
            raise InvalidInputError(
                "model", self.model, "a model of one end", 'a single mirror is exact for one end: use "exact"'
            )

    @property
    def extent(self) -> Extent:
        """Smallest and largest x inside the body, metres."""
        return (0.0, np.inf)


@dataclass(frozen=True, kw_only=True, repr=False)
class FiniteLengthSpace(EndedBody):
    """Elastic body ``0 <= x <= length``, ``z >= 0`` with free end faces I at ``x = 0`` and II at ``x = length``.

    Parameters
    ----------
    length : float
        Distance between the free ends (``L_f``), metres.
    material : Material
        What the body is made of.
    model : str
        How the ends are treated, see `EndedBody`; "exact" unless a comparison is wanted.

    Raises
    ------
    InvalidInputError
        If the length is not a positive number, or the model is unknown.

    Examples
    --------
    >>> FiniteLengthSpace(length=16e-3, material=Material(210e9, 0.3)).extent
    (0.0, 0.016)
    """

    length: float

    def __post_init__(self) -> None:
        """Check length and material."""
        super().__post_init__()
        checks.store(self, length=checks.positive("length", self.length, "metres"))

    @property
    def extent(self) -> Extent:
        """Smallest and largest x inside the body, metres."""
        return (0.0, self.length)
