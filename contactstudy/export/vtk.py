"""VTK files for ParaView: points on a rectilinear grid, or cells of an unstructured mesh."""

from __future__ import annotations

import base64
import xml.etree.ElementTree as ET
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.analysis import single_case
from contactstudy.analysis.axes import axis_dimensions, positions
from contactstudy.analysis.cuts import fields_on_same_points
from contactstudy.arrays.cells import labelled_cells
from contactstudy.arrays.variables import AXES, STRESSES, require
from contactstudy.checks import Array, FloatArray, IntArray
from contactstudy.errors import InvalidInputError
from contactstudy.export.table import output_path

TENSOR = (0, 3, 4, 3, 1, 5, 4, 5, 2)  # Indices of xx, xy, xz, yx, ... among the six components of a result
TYPES = {"f": "Float64", "i": "Int64", "u": "UInt8"}  # VTK's types of arrays
QUADRILATERAL, HEXAHEDRON = 9, 12  # VTK's numbers of kinds of cells
CORNERS = ((0, 0), (1, 0), (1, 1), (0, 1))  # Corners of a cell in VTK's order, along its first two axes


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
        The file, with the package's axes: z is the depth. Variables are point data; surfaces in an unstructured mesh,
        such as the pressure, are data of the contact's cells. All six stress components together are the tensor
        `stress` (xx, xy, xz, yx, yy, ...).

    Raises
    ------
    InvalidInputError
        If the Dataset contains several cases, the suffix is another, or variables are missing or on different points.
    StoreError
        If the file cannot be written.

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
    target = output_path(path, ".vtr", ".vtu")  # rectilinear grid, and unstructured mesh for more programs
    fields = fields_on_same_points(single_case(dataset), variables)
    first_field = next(iter(fields.values()))
    if target.suffix == ".vtr":
        axes, data = _on_points(fields)
        extent = " ".join(f"0 {axis.size - 1}" for axis in axes)
        # In the format, x varies fastest from point to point.
        points = {name: np.moveaxis(values, (0, 1, 2), (2, 1, 0)) for name, values in data.items()}
        sections = {
            "PointData": {name: values.reshape(-1, *values.shape[3:]) for name, values in points.items()},
            "Coordinates": dict(zip(AXES, axes, strict=True)),
        }
        _write(target, "RectilinearGrid", {"WholeExtent": extent}, {"Extent": extent}, sections)
    elif set(axis_dimensions(first_field).values()) == {"x", "y"}:
        # Only cells with finite values belong to the mesh: a gap is infinite beyond the roller.
        _, grid = labelled_cells("variables", xr.zeros_like(first_field, dtype=np.float64))
        edges = [grid.x_edges, np.linspace(*grid.y_range, grid.cells_y + 1), np.zeros(1)]
        values = {name: array.transpose("x", "y").values for name, array in fields.items()}
        _write_mesh(target, edges, values, in_cells=True)
    else:
        _write_mesh(target, *_on_points(fields), in_cells=False)
    return target


def _on_points(fields: dict[str, xr.DataArray]) -> tuple[list[FloatArray], dict[str, FloatArray]]:
    """Increasing positions along x, y and z, and the values at these points (x, y, z, ...)."""
    first_field = next(iter(fields.values()))
    dims = axis_dimensions(first_field)
    # The format requires increasing positions; an axis without positions is a plane at 0.
    points = {axis: positions(first_field, axis).values if axis in dims else np.zeros(1) for axis in AXES}
    order = {axis: np.argsort(values, kind="stable") for axis, values in points.items()}
    data = {}
    for name, array in fields.items():
        values = array.transpose(*dims.values()).values.astype(np.float64)
        field_values = values.reshape([points[axis].size for axis in AXES])
        data[name] = field_values[np.ix_(*order.values())]
    if all(name in data for name in STRESSES):
        components = np.stack([data[name] for name in STRESSES], axis=-1)
        data["stress"] = components[..., TENSOR].reshape(*components.shape[:-1], 3, 3)
    return [points[axis][order[axis]] for axis in AXES], data


def _write_mesh(path: Path, axes: list[FloatArray], data: Mapping[str, FloatArray], *, in_cells: bool) -> None:
    """Write the cells between points (x, y, z), with values on the points or in the cells."""
    kind, corners = _cells([axis.size for axis in axes])
    nodes = np.stack([points.ravel() for points in np.meshgrid(*axes, indexing="ij")], axis=1)
    sections: dict[str, dict[str, Array]] = {
        "CellData" if in_cells else "PointData": {
            name: values.reshape(len(corners if in_cells else nodes), -1).astype(np.float64)
            for name, values in data.items()
        },
        "Points": {"Points": nodes},
        "Cells": {
            "connectivity": corners.ravel(),
            "offsets": corners.shape[1] * np.arange(1, len(corners) + 1),
            "types": np.full(len(corners), kind, dtype="u1"),
        },
    }
    counts = {"NumberOfPoints": str(len(nodes)), "NumberOfCells": str(len(corners))}
    _write(path, "UnstructuredGrid", {}, counts, sections)


def _write(
    path: Path, kind: str, grid: dict[str, str], piece: dict[str, str], sections: Mapping[str, Mapping[str, Array]]
) -> None:
    """Write the arrays of a grid in XML, each in base64 as its number of bytes and its bytes."""
    root = ET.Element("VTKFile", type=kind, version="1.0", byte_order="LittleEndian", header_type="UInt64")
    parent = ET.SubElement(ET.SubElement(root, kind, grid), "Piece", piece)
    for section, arrays in sections.items():
        entries = ET.SubElement(parent, section)
        for name, rows in arrays.items():
            element = ET.SubElement(entries, "DataArray", type=TYPES[rows.dtype.kind], Name=name, format="binary")
            if rows.size > len(rows):
                element.set("NumberOfComponents", str(rows.size // len(rows)))
            content = rows.astype(rows.dtype.newbyteorder("<"), copy=False).tobytes()
            element.text = base64.b64encode(np.uint64(rows.nbytes).tobytes() + content).decode()
    with checks.writing(path) as temporary_path:
        ET.ElementTree(root).write(temporary_path, encoding="utf-8", xml_declaration=True)


def _cells(counts: list[int]) -> tuple[int, IntArray]:
    """VTK's kind of the cells between points, from the numbers of points along the axes, and each cell's corners."""
    points = np.arange(int(np.prod(counts)), dtype="<i8").reshape([count for count in counts if count > 1])
    if points.ndim < 2:
        allowed = "on at least two points along two of x, y and z"
        raise InvalidInputError("variables", f"{counts} points", allowed, "take .vtr or CSV")
    cell_corners = CORNERS if points.ndim == 2 else [(*corner, layer) for layer in (0, 1) for corner in CORNERS]
    sides = (slice(None, -1), slice(1, None))  # points at the lower and the upper side of the cells along an axis
    corners = [points[tuple(sides[upper] for upper in corner)].ravel() for corner in cell_corners]
    return (QUADRILATERAL if points.ndim == 2 else HEXAHEDRON), np.stack(corners, axis=1)
