"""Normal displacement of the top of a body under pressure and traction: the operator of every contact solution."""

from __future__ import annotations

from copy import copy
from functools import cached_property

import numpy as np
import xarray as xr
from scipy import fft

from contactstudy import checks
from contactstudy.arrays.cells import labelled_cells
from contactstudy.arrays.grid import Grid
from contactstudy.arrays.variables import named
from contactstudy.bodies.material import Material
from contactstudy.bodies.models import Body, Part
from contactstudy.cache import BoundedCache
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.kernels.convolution import GridTransform, even_spectrum, odd_spectrum
from contactstudy.kernels.images import FAR_LIMIT, CornerFunction, cell_kernel, mirrored_kernel
from contactstudy.kernels.patch import normal_displacement_corner, tangential_displacement_corner
from contactstudy.overlapping.displacement import EndCorrection, build_end_correction
from contactstudy.overlapping.quadrature import Resolution
from contactstudy.threads import one_blas_thread

REFERENCE_LENGTHS = 10.0
"""A finite-length body's displacement is relative to its top at ``|y|`` = this many lengths."""


class SurfaceOperator:
    """Displacement of the top from pressure and from traction along y, for one body and one grid.

    Parameters
    ----------
    body : Body
        The body.
    grid : Grid
        Cells; on a body with ends they begin at ``x = 0`` and span it.
    tangential : bool
        Whether the displacement from traction is needed.
    resolution : Resolution
        Quadrature settings of the free ends' part.

    Raises
    ------
    InvalidInputError
        If the grid does not fit the body.
    """

    def __init__(self, body: Body, grid: Grid, *, tangential: bool, resolution: Resolution) -> None:
        check_span(body, grid)
        self.parts = [
            (part.weight, PartOperator(body.material, part, grid, tangential=tangential, resolution=resolution))
            for part in body.parts
        ]

    def __call__(self, pressure: FloatArray, traction: FloatArray | None = None) -> FloatArray:
        """Displacement (m) of the cell centres under `pressure` and, if given, `traction` (Pa): array (x, y)."""
        weight, first = self.parts[0]
        displacement = weight * first(pressure, traction)
        for weight, part in self.parts[1:]:
            displacement += weight * part(pressure, traction)
        return displacement

    def precondition(self, gap: FloatArray) -> FloatArray:
        """Roughly the pressure that sinks the cells by `gap`."""
        return self.parts[0][1].precondition(gap)

    @cached_property
    def coarse(self) -> SurfaceOperator:
        """The operator on cells of twice the size, roughly: what a first guess is solved with."""
        coarse = copy(self)
        coarse.parts = [(weight, part.coarsened()) for weight, part in self.parts]
        return coarse

    @property
    def grid(self) -> Grid:
        """Cells."""
        return self.parts[0][1].grid

    @property
    def reference(self) -> float:
        """Distance along y at which the displacement is zero, metres; infinite unless the body has two ends."""
        return self.parts[0][1].reference

    @property
    def nbytes(self) -> int:
        """Memory held, bytes."""
        return sum(part.nbytes for _, part in self.parts)


class PartOperator:
    """Displacement of a half-space with the load mirrored in its ends, and perhaps of what frees them.

    Parameters are those of `SurfaceOperator`, with one `Part` of the body.
    """

    def __init__(self, material: Material, part: Part, grid: Grid, *, tangential: bool, resolution: Resolution) -> None:
        self.material, self.extent, self.grid = material, part.extent, grid
        low, high = part.extent
        mirrored = bool(np.isfinite(low) or np.isfinite(high))
        periodic = bool(np.isfinite(low) and np.isfinite(high))
        padded = grid.cells_x if periodic else 2 * grid.cells_x
        # Mirrored in its second end alone, the body is seen from there.
        self._flipped = mirrored and bool(np.isinf(low))
        self._mirrored, self._periodic = mirrored, periodic
        self._transform = GridTransform(*grid.shape, padded, mirrored=mirrored)
        x: FloatArray = grid.dx * np.arange(padded + 1.0 if mirrored else grid.cells_x + 1.0)
        y: FloatArray = grid.dy * np.arange(grid.cells_y + 1.0)
        factor = (1 - material.poisson) / (2 * np.pi * material.shear_modulus)
        self._normal = factor * self._spectrum(even_spectrum(self._kernel(normal_displacement_corner, x, y)))
        self._shear = np.zeros(0)
        if tangential:
            factor = (1 - 2 * material.poisson) / (4 * np.pi * material.shear_modulus)
            kernel = self._kernel(tangential_displacement_corner, x, y)
            self._shear = factor * self._spectrum(odd_spectrum(kernel))
        self._ends: EndCorrection | None = None
        if part.freed:
            with one_blas_thread():
                self._ends = build_end_correction(
                    part.freed.length,
                    material,
                    grid,
                    reference=self.reference,
                    tangential=tangential,
                    resolution=resolution,
                    mirrored_once=part.freed.mirrored_once,
                )

    @property
    def reference(self) -> float:
        """Distance along y at which the displacement is zero, metres; infinite unless the body has two ends."""
        low, high = self.extent
        return REFERENCE_LENGTHS * (high - low)

    def coarsened(self) -> PartOperator:
        """Return the operator on cells of twice the size, without traction."""
        mirrored = Part(1.0, self.extent)
        coarse = PartOperator(self.material, mirrored, self.grid.coarsened(), tangential=False, resolution=Resolution())
        coarse._ends = self._ends.coarsened() if self._ends is not None else None
        return coarse

    def _kernel(self, corner: CornerFunction, x: FloatArray, y: FloatArray) -> FloatArray:
        grid = self.grid
        if not self._periodic:
            return cell_kernel(corner, x, y, grid.dx, grid.dy)
        length = self.extent[1]
        kernel = mirrored_kernel(corner, x, y, grid.dx, grid.dy, length)
        if corner is normal_displacement_corner:
            # The images make a line load along x; its logarithm is set to zero at the reference.
            kernel -= grid.cell_area / length * np.log(2 * FAR_LIMIT * length / self.reference)
        return kernel

    def _spectrum(self, lateral: FloatArray) -> FloatArray:
        """Spectrum along x of a kernel even in x, given at offsets from 0 on."""
        spectrum = fft.dct(lateral, type=1, axis=0)
        if self._mirrored:
            return np.asarray(spectrum[:-1])
        return np.concatenate([spectrum, spectrum[-2:0:-1]])

    def __call__(self, pressure: FloatArray, traction: FloatArray | None = None) -> FloatArray:
        """Displacement (m) of the cell centres: array (x, y)."""
        displacement = self._apply(pressure, self._normal, tangential=False)
        if traction is not None:
            displacement += self._apply(traction, self._shear, tangential=True)
        return displacement

    def _apply(self, load: FloatArray, spectrum: FloatArray, *, tangential: bool) -> FloatArray:
        lateral = self._transform.lateral(load[::-1] if self._flipped else load)
        correction = self._ends.apply(lateral, tangential) if self._ends is not None else None
        full = self._transform.along()
        full *= spectrum
        if tangential:
            full *= 1j
        displacement = self._transform.back(correction)
        return displacement[::-1] if self._flipped else displacement

    def precondition(self, gap: FloatArray) -> FloatArray:
        """Roughly the pressure that sinks the cells by `gap`: the inverse of the mirrored half-space's spectrum."""
        self._transform.lateral(gap)
        full = self._transform.along()
        full *= self._inverse
        return self._transform.back()

    @cached_property
    def _inverse(self) -> FloatArray:
        # The constant's own entry depends on the reference only; the next one stands in for it.
        spectrum = self._normal.copy()
        spectrum[0, 0] = max(spectrum[0, 1], spectrum[1, 0])
        return np.asarray(1.0 / np.maximum(spectrum, 1e-3 * spectrum.min(where=spectrum > 0, initial=np.inf)))

    @property
    def nbytes(self) -> int:
        """Memory held, bytes."""
        held = self._normal.nbytes + self._shear.nbytes + self._transform.nbytes
        return held + (self._ends.nbytes if self._ends is not None else 0)


def check_span(body: Body, grid: Grid) -> None:
    """Raise unless the grid covers the body's x from its end (or from end to end)."""
    low, high = body.extent
    start, stop = grid.x_range
    tolerance = 1e-3 * grid.dx
    if np.isfinite(low) and abs(start - low) > tolerance:
        raise InvalidInputError("x", f"cells from {start:g} m", f"cells that begin at the free end, {low:g} m")
    if np.isfinite(high) and abs(stop - high) > tolerance:
        raise InvalidInputError("x", f"cells up to {stop:g} m", f"cells that end at the free end, {high:g} m")


_OPERATORS: BoundedCache[SurfaceOperator] = BoundedCache(2**30, lambda operator: operator.nbytes)


def surface_operator(body: Body, grid: Grid, *, tangential: bool) -> SurfaceOperator:
    """Return the operator for body and grid, which all cases with the same two share."""
    resolution = Resolution()
    return _OPERATORS.get(
        (body, grid, tangential),
        lambda: SurfaceOperator(body, grid, tangential=tangential, resolution=resolution),
    )


def surface_displacement(body: Body, pressure: xr.DataArray, friction: float = 0.0) -> xr.DataArray:
    """Compute how a prescribed pressure, and the friction that goes with it, sink the top of a body.

    Parameters
    ----------
    body : Body
        The elastic body.
    pressure : DataArray (x, y)
        Pressure in Pa, uniform in each cell; coordinates are cell centres in metres. On a body with free ends the
        cells begin at ``x = 0``, and on a finite-length space they end at its length.
    friction : float
        Coefficient ``f``; the traction on the body is ``f`` times the pressure along +y.

    Returns
    -------
    DataArray (x, y)
        `displacement_z` in metres, positive into the body. A finite-length space has no absolute displacement: its
        value is relative to the top far away, at the distance along y stated in the attribute ``reference_distance``.

    Raises
    ------
    InvalidInputError
        If the pressure is not a DataArray of finite numbers on a uniform grid that fits the body.

    Examples
    --------
    >>> import numpy as np, xarray as xr
    >>> from contactstudy import HalfSpace, Material
    >>> centres = np.linspace(-0.95, 0.95, 20)
    >>> pressure = xr.DataArray(np.ones((20, 20)), coords={"x": centres, "y": centres}, dims=("x", "y"))
    >>> sunk = surface_displacement(HalfSpace(material=Material(1.0, 0.0)), pressure)
    >>> round(float(sunk.max()), 2)
    2.24
    """
    checks.instance("body", body, Body, "a HalfSpace, a QuarterSpace or a FiniteLengthSpace")
    values, grid = labelled_cells("pressure", pressure)
    friction = checks.finite("friction", friction)
    operator = surface_operator(body, grid, tangential=friction != 0)
    with one_blas_thread():
        displacement = operator(values, friction * values if friction else None)
    attributes: dict[str, str | float] = {}
    if np.isfinite(operator.reference):
        attributes["reference_distance"] = operator.reference
        attributes["reference"] = "zero at |y| = reference_distance (m) on the top"
    sunk = xr.DataArray(displacement, coords={"x": pressure["x"], "y": pressure["y"]}, dims=("x", "y"))
    return named("displacement_z", sunk).assign_attrs(attributes)
