"""Unstructured meshes in VTK's XML format, ``.vtu``, which most programs for fields on meshes read."""

from __future__ import annotations

import base64
import xml.etree.ElementTree as ET
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from contactstudy import checks
from contactstudy.checks import Array, FloatArray, IntArray
from contactstudy.errors import InvalidInputError

QUADRILATERAL, HEXAHEDRON = 9, 12
"""VTK's numbers of kinds of cells."""

ROUND = ((0, 0), (1, 0), (1, 1), (0, 1))
"""Corners of a cell in VTK's order, along its first two axes."""


def write_mesh(
    path: Path,
    axes: list[FloatArray],
    *,
    on_points: Mapping[str, FloatArray] | None = None,
    in_cells: Mapping[str, FloatArray] | None = None,
) -> None:
    """Write the cells between points on three axes, with values on the points or in the cells.

    Parameters
    ----------
    path : Path
        File to write.
    axes : list of array
        Increasing positions along x, y and z; one of them may be a single position.
    on_points, in_cells : mapping of str to array
        Values (x, y, z, ...) on the points; values in the cells, in the same order.

    Raises
    ------
    InvalidInputError
        If there is no cell between the points, or the file cannot be written.
    """
    kind, corners = _cells([each.size for each in axes])
    nodes = np.stack([each.ravel() for each in np.meshgrid(*axes, indexing="ij")], axis=1)
    root = ET.Element(
        "VTKFile", type="UnstructuredGrid", version="1.0", byte_order="LittleEndian", header_type="UInt64"
    )
    piece = ET.SubElement(
        ET.SubElement(root, "UnstructuredGrid"),
        "Piece",
        NumberOfPoints=str(len(nodes)),
        NumberOfCells=str(len(corners)),
    )
    for section, fields, count in (
        ("PointData", on_points or {}, len(nodes)),
        ("CellData", in_cells or {}, len(corners)),
        ("Points", {"Points": nodes}, len(nodes)),
    ):
        data = ET.SubElement(piece, section)
        for name, values in fields.items():
            _array(data, name, np.asarray(values, dtype="<f8").reshape(count, -1))
    cells = ET.SubElement(piece, "Cells")
    _array(cells, "connectivity", corners.reshape(-1, 1))
    _array(cells, "offsets", corners.shape[1] * np.arange(1, len(corners) + 1).reshape(-1, 1))
    _array(cells, "types", np.full((len(corners), 1), kind, dtype="u1"))
    with checks.writing(path):
        ET.ElementTree(root).write(path, encoding="utf-8", xml_declaration=True)


def _array(parent: ET.Element, name: str, rows: Array) -> None:
    """Add an array: its bytes behind their number, in base64."""
    kinds = {"f": "Float64", "i": "Int64", "u": "UInt8"}
    element = ET.SubElement(parent, "DataArray", type=kinds[rows.dtype.kind], Name=name, format="binary")
    if rows.shape[1] > 1:
        element.set("NumberOfComponents", str(rows.shape[1]))
    element.text = base64.b64encode(np.uint64(rows.nbytes).tobytes() + np.ascontiguousarray(rows).tobytes()).decode()


def _cells(counts: list[int]) -> tuple[int, IntArray]:
    """Kind of the cells between so many points along each axis, and the numbers of their corners."""
    wide = [axis for axis, count in enumerate(counts) if count > 1]
    if len(wide) < 2:
        raise InvalidInputError(
            "variables", f"{counts} points", "on at least two points along two of x, y and z", "take .vtr or CSV"
        )
    numbers = np.arange(int(np.prod(counts)), dtype="<i8").reshape(counts)
    rounds = ROUND if len(wide) == 2 else [(*corner, level) for level in (0, 1) for corner in ROUND]
    corners = []
    for corner in rounds:
        at = [slice(None)] * len(counts)
        for axis, end in zip(wide, corner, strict=True):
            at[axis] = slice(1, None) if end else slice(None, -1)
        corners.append(numbers[tuple(at)].ravel())
    return (QUADRILATERAL if len(wide) == 2 else HEXAHEDRON), np.stack(corners, axis=1)
