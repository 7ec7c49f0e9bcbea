"""VTK files for ParaView and its like: points on a rectilinear grid, or cells of an unstructured mesh."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.analysis import single_case
from contactstudy.analysis.axes import axis_dimensions, positions
from contactstudy.analysis.fields import fields_on_one_grid
from contactstudy.arrays.cells import labelled_cells
from contactstudy.arrays.required import require
from contactstudy.arrays.variables import AXES, STRESSES
from contactstudy.checks import FloatArray
from contactstudy.errors import InvalidInputError
from contactstudy.export.mesh import write_mesh

SUFFIXES = (".vtr", ".vtu")
"""Rectilinear grid, and unstructured mesh, which more programs read."""

TENSOR = (0, 3, 4, 3, 1, 5, 4, 5, 2)
"""Place of xx, xy, xz, yx, ... among the six components of a result."""


def to_vtk(dataset: xr.Dataset, path: str | Path, variables: str | Sequence[str] | None = None) -> Path:
    """Write fields in VTK's XML format: as a rectilinear grid (``.vtr``) or as an unstructured mesh (``.vtu``).

    Parameters
    ----------
    dataset : Dataset
        One case; :func:`contactstudy.analysis.normalized` beforehand gives lengths over a and stresses over p0.
    path : str or Path
        File to write, ending with ``.vtr`` or ``.vtu``.
    variables : str or sequence of str, optional
        Variables or measures, see :func:`contactstudy.analysis.measure`, on the same points; default: all fields in
        the body, or all surfaces if there are none.

    Returns
    -------
    Path
        The file. Its axes are those of the package: z is the depth, so the body lies on the side of larger z.
        Variables are point data, but for surfaces in an unstructured mesh, such as the pressure: there they are data of
        the contact's cells, each of its own width. Where all six stress components are among them they are also
        written together as the tensor `stress` (xx, xy, xz, yx, yy, ...).

    Raises
    ------
    InvalidInputError
        If there is more than one case, the path ends otherwise, or the variables are missing or lie on different
        points, or the file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> cells = {"x": [0.0, 1.0], "y": [0.0, 1.0]}
    >>> pressure = xr.DataArray([[1.0, 2.0], [3.0, 4.0]], dims=("x", "y"), coords=cells)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     to_vtk(xr.Dataset({"pressure": pressure}), Path(folder) / "surface.vtr").name
    'surface.vtr'
    """
    require(dataset)
    checks.instance("path", path, (str, Path), "a path")
    target = Path(path)
    if target.suffix not in SUFFIXES:
        raise InvalidInputError("path", str(path), f"a file name that ends with {' or '.join(SUFFIXES)}")
    fields = fields_on_one_grid(single_case(dataset), variables)
    if target.suffix == ".vtr":
        _write_rectilinear(target, *_on_points(fields))
    elif set(axis_dimensions(next(iter(fields.values()))).values()) == {"x", "y"}:
        _write_cells(target, fields)
    else:
        axes, data = _on_points(fields)
        write_mesh(target, axes, on_points=data)
    return target


def _on_points(fields: dict[str, xr.DataArray]) -> tuple[list[FloatArray], dict[str, FloatArray]]:
    """Increasing positions along x, y and z, and the values there (x, y, z, ...)."""
    first = next(iter(fields.values()))
    along = axis_dimensions(first)
    # The format asks for increasing positions; an axis that the fields do not have is a plane at 0.
    place = {axis: positions(first, axis).values if axis in along else np.zeros(1) for axis in AXES}
    order = {axis: np.argsort(values, kind="stable") for axis, values in place.items()}
    data = {}
    for name, array in fields.items():
        values = array.transpose(*along.values()).values.astype(np.float64)
        shaped = values.reshape([place[axis].size for axis in AXES])
        data[name] = shaped[np.ix_(*order.values())]
    if all(name in data for name in STRESSES):
        components = np.stack([data[name] for name in STRESSES], axis=-1)
        data["stress"] = components[..., TENSOR].reshape(*components.shape[:-1], 3, 3)
    return [place[axis][order[axis]] for axis in AXES], data


def _write_rectilinear(target: Path, axes: list[FloatArray], data: dict[str, FloatArray]) -> None:
    """Write point data on a rectilinear grid."""
    from uvw import DataArray, RectilinearGrid

    # Not compressed: uvw 0.7 spoils compressed arrays of a multiple of 32 KiB, and stresses hardly get smaller.
    with checks.writing(target), RectilinearGrid(str(target), tuple(axes)) as grid:
        for name, values in data.items():
            grid.addPointData(DataArray(values, range(3), name))


def _write_cells(target: Path, fields: dict[str, xr.DataArray]) -> None:
    """Write data of the contact's cells, each as wide as it is."""
    first = next(iter(fields.values()))
    # Only where the cells are: a gap is infinite beyond the roller.
    _, grid = labelled_cells("variables", xr.zeros_like(first, dtype=np.float64))
    edges = [grid.x_edges, np.linspace(*grid.y_range, grid.cells_y + 1), np.zeros(1)]
    write_mesh(target, edges, in_cells={name: array.transpose("x", "y").values for name, array in fields.items()})
