"""Linear operators of the method: equivalent loads, surface displacements and stresses from loads on cells.

Every operator is a `scipy.sparse.linalg.LinearOperator` of real vectors with its transpose, `operator.T`. Arrays enter
and leave raveled: a load on the cells of a grid as ``cells.ravel()`` of an array (x, y). ``operator @ numpy.eye(n)`` is
the dense matrix. docs/explanation/overlapping.md uses these operators.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from scipy.sparse.linalg import LinearOperator, aslinearoperator

from contactstudy import checks
from contactstudy.arrays.grid import Grid
from contactstudy.bodies.models import Body
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.fields.equivalent_loads import overlapping_operators
from contactstudy.fields.positions import Positions, field_positions
from contactstudy.fields.stress import StressOperator
from contactstudy.fields.surface import DIRECTIONS, surface_operator
from contactstudy.kernels.load import Load
from contactstudy.overlapping.operators import OverlappingOperators
from contactstudy.threads import one_blas_thread

__all__ = ["Overlapping", "stress", "surface_displacement"]

LOADS = {"pressure": Load.NORMAL, "traction_x": Load.ALONG_X, "traction_y": Load.ALONG_Y}


@dataclass(frozen=True, kw_only=True, eq=False)
class Overlapping:
    """Operators of the two auxiliary bodies of a body with free ends: the half-space H and the slab V.

    Parameters
    ----------
    body : Body
        QuarterSpace or FiniteLengthSpace.
    grid : Grid
        Cells of the load; on a body with ends they begin at ``x = 0`` and span it. Uniform, or columns of any width.
    z : sequence of float
        Depths of the equivalent loads on the faces, metres, not negative. The least depth and the distance of the
        first cell's centre from the end determine the largest wavenumbers.
    load : {"pressure", "traction_y", "traction_x"}
        Direction of the load. Pressure and traction along y share their modes and faces; mirror images
        reverse a traction along x, so its modes and faces differ.

    Raises
    ------
    InvalidInputError
        If the body lacks a free end, or a value is out of range.

    Notes
    -----
    `equivalent_loads` and the stresses use the same objects. *Modes* are the weighted spectra of a load on H
    on the ends, *faces* the normal stress that V removes from each end, at the depth wavenumbers of the solver;
    both for each node of the wavenumber along y, each set of axial modes, and all y of the grid.

    Examples
    --------
    >>> import numpy as np
    >>> from contactstudy import Grid, Material, QuarterSpace
    >>> grid = Grid(x_range=(0.0, 2.0), y_range=(-1.0, 1.0), cells_x=8, cells_y=8)
    >>> method = Overlapping(body=QuarterSpace(material=Material(1.0, 0.3)), grid=grid, z=[0.5])
    >>> pressure = np.ones(64)
    >>> bool((method.P_h1 @ pressure > pressure).all()), bool((method.P_v1 @ pressure < 0).all())
    (True, True)
    """

    body: Body
    grid: Grid
    z: Positions = (0.0,)
    load: str = "pressure"
    _operators: OverlappingOperators = field(init=False, repr=False)
    _load: Load = field(init=False, repr=False)

    def __post_init__(self) -> None:
        """Build the equation sets."""
        checks.instance("body", self.body, Body, "a QuarterSpace or a FiniteLengthSpace")
        checks.instance("grid", self.grid, Grid, "a Grid")
        load = LOADS[checks.known_name("load", self.load, LOADS)]
        operators = overlapping_operators(self.body, self.grid, checks.coordinates("z", self.z), load)
        if operators is None:
            raise InvalidInputError("body", self.body, "a body with a free end and an overlapping model")
        checks.store(self, _operators=operators, _load=load)

    @cached_property
    def modes(self) -> LinearOperator:
        """Operator from the load on the cells to its modes on H, eqs. (6) and (7)."""
        return self._operators.modes(self._load)

    @cached_property
    def load_to_faces(self) -> LinearOperator:
        """Operator from the modes of the load to the normal stress that V must remove, eqs. (16), (18), (29a)."""
        return self._operators.to_faces(self._load)

    @cached_property
    def top_to_faces(self) -> LinearOperator:
        """Operator from modes of a pressure on H to the normal stress that V must remove: M_i-j from H to V."""
        return self._operators.to_faces(Load.NORMAL)

    @property
    def faces_to_top(self) -> LinearOperator:
        """Operator from faces to the modes of the stress of V on the top: M_i-j from V to H, eq. (23)."""
        return self._operators.to_top

    @property
    def solution(self) -> LinearOperator:
        """Operator from the stress under the load alone to the faces, by the factorised equation set, eq. (27)."""
        return self._operators.solution

    @property
    def top_values(self) -> LinearOperator:
        """Operator from faces to the stress of V on the top at the centres of the cells, (x, y)."""
        return self._operators.top_values

    @cached_property
    def P_h1(self) -> LinearOperator:  # noqa: N802
        """Operator from the load to the equivalent pressure on H, (x, y): the matrix MA."""
        top_load = self._operators.equivalent(self._load).top_load
        return top_load + aslinearoperator(np.eye(top_load.shape[0])) if self._load is Load.NORMAL else top_load

    @cached_property
    def P_v1(self) -> LinearOperator:  # noqa: N802
        """Operator from the load to the equivalent pressure on the face at end I, (y, z): the matrix MB."""
        return self._operators.equivalent(self._load).faces[0]

    @cached_property
    def P_v2(self) -> LinearOperator:  # noqa: N802
        """Operator from the load to the equivalent pressure on the face at end II, (y, z): the matrix MC.

        A QuarterSpace lacks end II.
        """
        faces = self._operators.equivalent(self._load).faces
        if len(faces) < 2:
            raise InvalidInputError("body", self.body, "a FiniteLengthSpace, which has an end II")
        return faces[1]


def surface_displacement(body: Body, grid: Grid, load: str = "pressure", component: str = "z") -> LinearOperator:
    """Return the operator of every contact solution: from a load on the cells to a displacement of the top.

    Parameters
    ----------
    body : Body
        The elastic body.
    grid : Grid
        Cells: uniform, or columns of any width.
    load : {"pressure", "traction_x", "traction_y"}
        Direction of the load, Pa.
    component : {"z", "x", "y"}
        Direction of the displacement, metres; z points into the body.

    Returns
    -------
    LinearOperator
        Square, one row per cell; matrix-free on uniform cells, one matrix along x per wavenumber on columns. The
        transpose follows from reciprocity.

    Raises
    ------
    InvalidInputError
        If a name is unknown, the grid does not fit the body, or the model is "single-mirror", which violates
        reciprocity because its ends keep some shear.

    Examples
    --------
    >>> import numpy as np
    >>> from contactstudy import Grid, HalfSpace, Material
    >>> grid = Grid(x_range=(0, 1), y_range=(0, 1), cells_x=4, cells_y=4)
    >>> operator = surface_displacement(HalfSpace(material=Material(1.0, 0.3)), grid)
    >>> dense = operator @ np.eye(16)
    >>> bool(np.allclose(dense, dense.T))
    True
    """
    checks.instance("body", body, Body, "a HalfSpace, a QuarterSpace or a FiniteLengthSpace")
    checks.instance("grid", grid, Grid, "a Grid")
    if any(term.free_ends is not None and term.free_ends.mirrored_once for term in body.terms):
        raise InvalidInputError("body.model", "single-mirror", "a model with reciprocity", "its ends keep some shear")
    direction = DIRECTIONS[checks.known_name("component", component, DIRECTIONS)]
    load_direction = LOADS[checks.known_name("load", load, LOADS)]
    operator = surface_operator(body, grid, (load_direction,), directions=(direction,))
    reciprocal_operator = surface_operator(body, grid, (direction,), directions=(load_direction,))
    # On columns the displacement is a mean: forces on the cells and means are conjugate.
    weights = grid.weights if grid.observes_means else np.ones((1, 1))

    def apply(vector: FloatArray) -> FloatArray:
        with one_blas_thread():
            loads = {load_direction: vector.reshape(grid.shape)}
            return np.array(operator.compute_displacements(loads, (direction,))[direction]).ravel()

    def apply_transposed(vector: FloatArray) -> FloatArray:
        with one_blas_thread():
            cell_loads = vector.reshape(grid.shape) / weights
            displacements = reciprocal_operator.compute_displacements({direction: cell_loads}, (load_direction,))
            return (weights * np.array(displacements[load_direction])).ravel()

    return LinearOperator((grid.x.size * grid.y.size,) * 2, matvec=apply, rmatvec=apply_transposed, dtype=np.float64)


def stress(
    body: Body,
    grid: Grid,
    x: Positions | None = None,
    y: Positions | None = None,
    z: Positions = (0.0,),
    *,
    load: str = "pressure",
) -> LinearOperator:
    """Return the operator from a load on the cells, uniform in each cell, to the stresses on a plane.

    Parameters
    ----------
    body, grid, load
        As in `surface_displacement`.
    x, y, z : sequence of float
        Positions, as a tensor product, metres; a plane has one position along one axis. Default: the centres of cells.

    Returns
    -------
    LinearOperator
        To the stresses (component, x, y, z) of `stress_field` in Pa, components xx, yy, zz, xy, xz, yz. The operator
        holds, for each cell along x, the stress at each distance along y, and the amplitudes of the end correction.

    Raises
    ------
    InvalidInputError
        If a name is unknown, a position lies outside the body, or the grid does not fit it.

    Examples
    --------
    >>> import numpy as np
    >>> from contactstudy import Grid, HalfSpace, Material
    >>> grid = Grid(x_range=(0, 1), y_range=(0, 1), cells_x=4, cells_y=4)
    >>> operator = stress(HalfSpace(material=Material(1.0, 0.3)), grid, y=[0.5], z=[0.1])
    >>> operator.shape
    (24, 16)
    """
    checks.instance("body", body, Body, "a HalfSpace, a QuarterSpace or a FiniteLengthSpace")
    checks.instance("grid", grid, Grid, "a Grid")
    body.check_span(grid)
    direction = LOADS[checks.known_name("load", load, LOADS)]
    positions = field_positions(body, grid, x, y, z)
    with one_blas_thread():
        return StressOperator(body, grid, positions.points, direction)
