"""Displacements of the top of a body under pressure and traction: the operator of every contact solution.

The operator of a body is the sum over its parts, each a half-space with mirrored loads and the end correction. On
uniform cells it is a convolution, observed at the centres; on columns it is a dense matrix along x per wavenumber along
y, observed as means over the widths of the columns.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import overload

import numpy as np
import xarray as xr
from scipy import fft, linalg

from contactstudy import checks
from contactstudy.arrays.grid import Grid
from contactstudy.arrays.variables import describe, name_array
from contactstudy.bodies.material import Material
from contactstudy.bodies.models import Body, BodyTerm, Extent
from contactstudy.cache import cached
from contactstudy.checks import ComplexArray, FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.fields.loads import prescribed_loads
from contactstudy.kernels.convolution import GridTransform, even_spectrum, odd_spectrum
from contactstudy.kernels.load import NORMAL_RESPONSE, Load, Response
from contactstudy.kernels.strips import ColumnsRequest, surface_kernel
from contactstudy.overlapping.quadrature import Resolution
from contactstudy.overlapping.surface import EndCorrection, EndKernel, EndRequest, end_kernel
from contactstudy.threads import one_blas_thread

REFERENCE_LENGTHS = 10.0  # Distance along y, in lengths of the body, at which its top has no displacement


class UniformOperator:
    """Displacements of the top of one part of a body."""

    def __init__(
        self, material: Material, extent: Extent, grid: Grid, responses: Sequence[Response], ends: EndKernel | None
    ) -> None:
        self.extent, self.grid = extent, grid
        self._correction = None if ends is None else EndCorrection.on_grid(grid, ends)
        self._spectra = {response: _spectrum(response, material, extent, grid) for response in responses}
        mirrored, padded_cells = _padding(extent, grid)
        # A body with only the second mirror is reversed.
        self._is_reversed = mirrored and bool(np.isinf(extent[0]))

        def make_transforms(directions: Sequence[Load]) -> dict[Load, GridTransform]:
            return {
                direction: GridTransform(*grid.shape, padded_cells, direction.sign_x if mirrored else 0)
                for direction in dict.fromkeys(directions)
            }

        self._load_transforms = make_transforms([response.load for response in responses])
        self._field_transforms = make_transforms([response.displacement for response in responses])

    def coarsen(self, material: Material) -> UniformOperator:
        """Return the operator on cells of twice the size."""
        operator = UniformOperator(material, self.extent, self.grid.coarsened(), list(self._spectra), None)
        operator._correction = self._correction and self._correction.coarsen()
        return operator

    def __call__(self, loads: Mapping[Load, FloatArray], directions: Sequence[Load]) -> dict[Load, FloatArray]:
        """Displacements (m) of the cell centres in some `directions` under `loads` (Pa): arrays (x, y)."""
        spectra, projected = {}, {}
        for load, cells in loads.items():
            transform = self._load_transforms[load]
            lateral = transform.transform_y(load.sign_x * cells[::-1] if self._is_reversed else cells)
            if self._correction is not None:
                projected[load] = self._correction.project_loads(load, lateral)
            spectra[load] = transform.transform_x()
        displacements = {}
        for direction in directions:
            transform = self._field_transforms[direction]
            self._fill(transform.spectrum, direction, spectra)
            end_displacement = None
            if self._correction is not None:
                end_displacement = self._correction.compute_displacement(direction, projected, self.grid.cells_x)
            displacement = transform.invert(end_displacement)  # eq. (5)
            displacements[direction] = direction.sign_x * displacement[::-1] if self._is_reversed else displacement
        return displacements

    def _fill(self, total: ComplexArray, direction: Load, loads: Mapping[Load, ComplexArray]) -> None:
        """Fill a buffer with the spectrum of the displacement that the mirrored half-space has under `loads`."""
        # A sine transform begins with wavenumber 1, a cosine transform with wavenumber 0.
        mirrored = bool(self._field_transforms[direction].mirror)
        for index, (load, spectrum) in enumerate(loads.items()):
            response = Response(direction, load)
            kernel, direct_part, load_spectrum = self._spectra[response], total, spectrum
            if mirrored and response.sign_x < 0:
                direct_part, load_spectrum = (
                    (total[:-1], spectrum[1:]) if direction.sign_x < 0 else (total[1:], spectrum[:-1])
                )
                if not index:
                    total[-1 if direction.sign_x < 0 else 0] = 0.0
            # Kernels lack a factor i for each odd direction, except along x between mirrors.
            powers = int(response.sign_y < 0) + int(response.sign_x < 0 and not mirrored)
            phased_kernel = (1j, -1)[powers - 1] * kernel if powers else kernel
            if index:
                direct_part += phased_kernel * load_spectrum
            else:
                np.multiply(phased_kernel, load_spectrum, out=direct_part)

    def precondition(self, gap: FloatArray) -> FloatArray:
        """Approximate pressure for a normal displacement `gap`: the inverse spectrum of the mirrored half-space."""
        transform = self._load_transforms[Load.NORMAL]
        transform.transform_y(gap)
        spectrum = transform.transform_x()
        spectrum *= self._inverse
        return transform.invert()

    @cached_property
    def _inverse(self) -> FloatArray:
        # The constant's entry depends on the reference only; the next entry replaces it.
        spectrum = self._spectra[NORMAL_RESPONSE].copy()
        spectrum[0, 0] = 0.0
        spectrum[0, 0] = spectrum[:2, :2].max()
        return np.asarray(1.0 / np.maximum(spectrum, 1e-3 * spectrum.min(where=spectrum > 0, initial=np.inf)))

    @property
    def added_nbytes(self) -> int:
        """Memory of the inverse that preconditioning adds, bytes."""
        return max(spectrum.nbytes for spectrum in self._spectra.values())


def _padding(extent: Extent, grid: Grid) -> tuple[bool, int]:
    """Whether mirror images, not zeros, continue the cells along x, and the number of cells with the continuation."""
    has_end = [bool(np.isfinite(end)) for end in extent]
    return any(has_end), grid.cells_x if all(has_end) else 2 * grid.cells_x


def end_kernel_of(
    term: BodyTerm, material: Material, grid: Grid, responses: tuple[Response, ...], resolution: Resolution
) -> EndKernel | None:
    """Kernel of a part's free ends, None without free ends; raise for tangential displacements of "single-mirror"."""
    if term.free_ends is None:
        return None
    if term.free_ends.mirrored_once and any(response.displacement is not Load.NORMAL for response in responses):
        raise InvalidInputError(
            "body.model",
            "single-mirror",
            '"exact", "mirror" or "mirror-factor" for tangential displacements',
            "residual shear on its ends breaks reciprocity",
        )
    reference = reference_distance(term.extent)
    return end_kernel(EndRequest.of(term.free_ends, material, grid, responses, reference, resolution=resolution))


def reference_distance(extent: Extent) -> float:
    """Distance along y at which the displacement of a part is zero, metres; infinite unless it has two ends."""
    return REFERENCE_LENGTHS * (extent[1] - extent[0])


def kernel_factor(material: Material) -> float:
    """Factor on the closed-form kernels of the displacement, 1/Pa."""
    return 1 / (4 * np.pi * material.shear_modulus)


def _spectrum(response: Response, material: Material, extent: Extent, grid: Grid) -> FloatArray:
    """Spectrum (x, y), without factors i, of the kernel of the mirrored half-space."""
    mirrored, padded_cells = _padding(extent, grid)
    x: FloatArray = grid.dx * np.arange(padded_cells + 1.0 if mirrored else grid.cells_x + 1.0)
    y: FloatArray = grid.dy * np.arange(grid.cells_y + 1.0)
    length = extent[1] - extent[0]
    cell = (grid.dx, grid.dy)
    reference = reference_distance(extent)
    kernel = surface_kernel(response, material.poisson, x, y, cell, length=length, reference=reference)
    along_y = even_spectrum(kernel) if response.sign_y > 0 else odd_spectrum(kernel)
    factor = kernel_factor(material)
    if response.sign_x < 0:
        odd_part = along_y[1:-1]
        if odd_part.size:  # the sine transform needs two columns
            odd_part = factor * fft.dst(odd_part, type=1, axis=0)
        if mirrored:
            return np.asarray(odd_part if response.displacement.sign_x < 0 else -odd_part)
        zero_row = np.zeros((1, odd_part.shape[1]))
        return np.concatenate([zero_row, -odd_part, zero_row, odd_part[::-1]])
    spectrum = factor * fft.dct(along_y, type=1, axis=0)
    if mirrored:
        return np.asarray(spectrum[:-1] if response.displacement.sign_x > 0 else spectrum[1:])
    return np.concatenate([spectrum, spectrum[-2:0:-1]])


MIN_EIGENVALUE = 1e-3  # least eigenvalue of an indefinite preconditioner over the mean magnitude. Speed.


class ColumnsOperator:
    """Displacements of the top of one part of a body, averaged over the width of each cell."""

    def __init__(self, extent: Extent, grid: Grid, kernels: Mapping[Response, FloatArray]) -> None:
        self.extent, self.grid, self._kernels = extent, grid, kernels
        self._widths = grid.widths[:, None]

    @classmethod
    def of(
        cls, material: Material, extent: Extent, grid: Grid, responses: Sequence[Response], ends: EndKernel | None
    ) -> ColumnsOperator:
        """Operator of a part of a body made of `material`, for pairs of displacement and load."""
        edges, reference = grid.x_edges, reference_distance(extent)
        columns = ColumnsRequest(edges=edges, dy=grid.dy, cells_y=grid.cells_y, extent=extent, reference=reference)
        kernels = {response: columns.kernel(response, material.poisson) for response in responses}
        for response, kernel in kernels.items():
            kernel *= kernel_factor(material)
            if ends is not None:
                ends.add_to(kernel, response, edges)
        return cls(extent, grid, kernels)

    def coarsen(self, material: Material) -> ColumnsOperator:
        """Return the operator on pairs of cells, for an initial guess."""
        grid = self.grid.coarsened()
        fine_columns, widths = np.arange(self.grid.cells_x), self.grid.widths
        averaging = np.zeros((grid.cells_x, widths.size))
        averaging[np.minimum(fine_columns // 2, grid.cells_x - 1), fine_columns] = widths
        averaging /= grid.widths[:, None]
        coarse_kernels = {
            response: averaging @ kernel[: grid.cells_y + 1] @ averaging.T for response, kernel in self._kernels.items()
        }
        return ColumnsOperator(self.extent, grid, coarse_kernels)

    def __call__(self, loads: Mapping[Load, FloatArray], directions: Sequence[Load]) -> dict[Load, FloatArray]:
        """Displacements (m) of the cells in some `directions` under `loads` (Pa): arrays (x, y)."""
        spectra = {load: self._transform_y(self._widths * cells) for load, cells in loads.items()}
        displacements = {}
        for direction in directions:
            total = np.zeros(1, np.complex128)
            for load, spectrum in spectra.items():
                response = Response(direction, load)
                product = _multiply_matrices(self._kernels[response], spectrum)
                total = total + (product if response.sign_y > 0 else 1j * product)
            displacements[direction] = self._invert_y(total)
        return displacements

    def precondition(self, gap: FloatArray) -> FloatArray:
        """Approximate pressure for a normal displacement `gap`."""
        return self._invert_y(_multiply_matrices(self._inverse, self._transform_y(gap))) / self._widths

    def _transform_y(self, cells: FloatArray) -> ComplexArray:
        """Transform along y: array (wavenumber, cell)."""
        return np.ascontiguousarray(fft.rfft(cells, n=2 * self.grid.cells_y, axis=1).T)

    def _invert_y(self, spectrum: ComplexArray) -> FloatArray:
        """Values on the cells from their transform along y (wavenumber, cell)."""
        cells_y = self.grid.cells_y
        return np.asarray(fft.irfft(spectrum.T, n=2 * cells_y, axis=1)[:, :cells_y])

    @cached_property
    def _inverse(self) -> FloatArray:
        """Inverse of the pressure's matrix, per wavenumber."""
        kernel = self._kernels[NORMAL_RESPONSE]
        inverse = np.empty_like(kernel)
        with one_blas_thread():
            for matrix, matrix_inverse in zip(kernel, inverse, strict=True):
                matrix_inverse[:] = _invert_matrix(matrix)
        return inverse

    @property
    def added_nbytes(self) -> int:
        """Memory of the inverse that preconditioning adds, bytes."""
        return max(kernel.nbytes for kernel in self._kernels.values())


def _multiply_matrices(matrices: FloatArray, spectrum: ComplexArray) -> ComplexArray:
    """Real matrices (wavenumber, cell, cell) times a contiguous spectrum (wavenumber, cell)."""
    # One product for real and imaginary parts reads the matrices once.
    parts = spectrum.view(np.float64).reshape(*spectrum.shape, 2)
    return (matrices @ parts).view(np.complex128)[..., 0]


def _invert_matrix(matrix: FloatArray) -> FloatArray:
    """Inverse of a symmetric matrix with positive eigenvalues; the displacement's reference may make one negative."""
    cholesky_factor, status = linalg.lapack.dpotrf(matrix)
    if not status:
        upper, _ = linalg.lapack.dpotri(cholesky_factor)  # zeros below
        inverse = upper + upper.T
        inverse.flat[:: inverse.shape[0] + 1] *= 0.5
        return np.asarray(inverse)
    eigenvalues, eigenvectors = np.linalg.eigh(0.5 * (matrix + matrix.T))
    eigenvalues = np.maximum(np.abs(eigenvalues), MIN_EIGENVALUE * np.abs(eigenvalues).max() / eigenvalues.size)
    return np.asarray((eigenvectors / eigenvalues) @ eigenvectors.T)


DIRECTIONS = {"x": Load.ALONG_X, "y": Load.ALONG_Y, "z": Load.NORMAL}  # of a displacement, by axis
NORMAL = (Load.NORMAL,)  # directions of a contact without friction
RESOLUTION = Resolution()  # quadrature settings of the free ends' part


class SurfaceOperator:
    """Displacements of the top from pressure and traction, for one body and one grid."""

    def __init__(self, body: Body, operators: Sequence[tuple[float, UniformOperator | ColumnsOperator]]) -> None:
        self.body, self._operators = body, operators

    @classmethod
    def of(
        cls,
        body: Body,
        grid: Grid,
        loads: tuple[Load, ...] = NORMAL,
        directions: tuple[Load, ...] = NORMAL,
        resolution: Resolution = RESOLUTION,
    ) -> SurfaceOperator:
        """Build the operator from loads, the pressure first, to displacements in some directions."""
        # Between ends the cells begin at ``x = 0`` and span the body.
        body.check_span(grid)
        part_operator = ColumnsOperator.of if grid.observes_means else UniformOperator
        responses = tuple(Response(direction, load) for direction in directions for load in loads)
        operators = []
        with one_blas_thread():
            for term in body.terms:
                ends = end_kernel_of(term, body.material, grid, responses, resolution)
                operators.append((term.weight, part_operator(body.material, term.extent, grid, responses, ends)))
        return cls(body, operators)

    def __call__(self, loads: Mapping[Load, FloatArray]) -> FloatArray:
        """Displacement (m) of the cells along z under `loads` (Pa): array (x, y)."""
        return self.compute_displacements(loads, (Load.NORMAL,))[Load.NORMAL]

    def compute_displacements(
        self, loads: Mapping[Load, FloatArray], directions: Sequence[Load]
    ) -> dict[Load, FloatArray]:
        """Displacements (m) of the cells in some `directions` under `loads` (Pa): arrays (x, y)."""
        weight, first_operator = self._operators[0]
        displacements = first_operator(loads, directions)
        if weight != 1:
            displacements = {direction: weight * displacement for direction, displacement in displacements.items()}
        for weight, operator in self._operators[1:]:
            for direction, displacement in operator(loads, directions).items():
                displacements[direction] += weight * displacement
        return displacements

    def precondition(self, gap: FloatArray) -> FloatArray:
        """Approximate pressure for a normal displacement `gap`."""
        return self._operators[0][1].precondition(gap)

    @cached_property
    def coarse(self) -> SurfaceOperator:
        """Approximate operator on cells of twice the size, for an initial guess."""
        operators = [(weight, operator.coarsen(self.body.material)) for weight, operator in self._operators]
        return SurfaceOperator(self.body, operators)

    @property
    def grid(self) -> Grid:
        """Grid of the cells."""
        return self._operators[0][1].grid


def surface_operator(
    body: Body, grid: Grid, loads: tuple[Load, ...] = NORMAL, directions: tuple[Load, ...] = NORMAL
) -> SurfaceOperator:
    """Return the operator of a body, shared by all cases of the body at any reference depth."""
    return _cached_operator(replace(body, reference_depth=None), grid, loads, directions)


_cached_operator = cached("surface operators")(SurfaceOperator.of)


@overload
def surface_displacement(
    body: Body,
    pressure: xr.DataArray,
    friction: float = ...,
    *,
    traction_x: xr.DataArray | None = ...,
    traction_y: xr.DataArray | None = ...,
    components: None = ...,
) -> xr.DataArray: ...


@overload
def surface_displacement(
    body: Body,
    pressure: xr.DataArray,
    friction: float = ...,
    *,
    traction_x: xr.DataArray | None = ...,
    traction_y: xr.DataArray | None = ...,
    components: Sequence[str],
) -> xr.Dataset: ...


def surface_displacement(
    body: Body,
    pressure: xr.DataArray,
    friction: float = 0.0,
    *,
    traction_x: xr.DataArray | None = None,
    traction_y: xr.DataArray | None = None,
    components: Sequence[str] | None = None,
) -> xr.DataArray | xr.Dataset:
    """Compute the displacement of the top of a body under a prescribed pressure and tractions.

    Parameters
    ----------
    body, pressure, friction, traction_x, traction_y
        As for :func:`contactstudy.stress_field`; the loads are uniform in each cell.
    components : sequence of str, optional
        Some of "x", "y" and "z"; default: the normal displacement alone, as a DataArray.

    Returns
    -------
    DataArray (x, y) or Dataset
        `displacement_z`, positive into the body, in metres; of several components a Dataset of `displacement_x`,
        `displacement_y` and `displacement_z`. The displacement of a finite-length space is relative
        to the top far away, at the distance along y stated in the attribute ``reference_distance``. A net force along
        x bends it, by an amount that depends on the distance: its curvature along y is zero far away, too.

    Raises
    ------
    InvalidInputError
        If a load is not a DataArray of finite numbers on a grid that fits the body, the loads' cells differ, or
        `friction` and `traction_y` are both given.

    Examples
    --------
    >>> import numpy as np, xarray as xr
    >>> from contactstudy import HalfSpace, Material
    >>> centres = np.linspace(-0.95, 0.95, 20)
    >>> pressure = xr.DataArray(np.ones((20, 20)), coords={"x": centres, "y": centres}, dims=("x", "y"))
    >>> body = HalfSpace(material=Material(1.0, 0.0))
    >>> round(float(surface_displacement(body, pressure).max()), 2)
    2.24
    """
    prescribed = prescribed_loads(body, pressure, friction, traction_x, traction_y)
    selected = "z" if components is None else components
    axes = [checks.known_name("components", axis, DIRECTIONS) for axis in selected]
    directions = tuple(dict.fromkeys(DIRECTIONS[axis] for axis in axes))
    if not directions:
        raise InvalidInputError("components", components, "at least one of x, y and z, or None")
    grid, loads = prescribed.grid, prescribed.loads
    operator = surface_operator(body, grid, tuple(loads), directions=directions)
    with one_blas_thread():
        displacements = operator.compute_displacements({load: top.values for load, top in loads.items()}, directions)
    attributes: dict[str, str | float] = {}
    distance = reference_distance(body.terms[0].extent)
    if np.isfinite(distance):
        reference = "zero at |y| = reference_distance (m) on the top"
        attributes = {"reference_distance": distance, "reference": reference}
    coords = {"x": pressure["x"], "y": pressure["y"]}
    arrays = {
        f"displacement_{axis}": xr.DataArray(displacements[direction], coords, dims=("x", "y"))
        for axis, direction in DIRECTIONS.items()
        if direction in displacements
    }
    fields = {name: name_array(name, array).assign_attrs(attributes) for name, array in arrays.items()}
    if components is None:
        return fields["displacement_z"]
    return describe(xr.Dataset(fields), "displacements of the top under a prescribed load")
