"""A reader of VTK's XML format, independent of the writer: Python's XML and base64."""

from __future__ import annotations

import base64
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np

TYPES = {"Float64": np.dtype("<f8"), "Float32": np.dtype("<f4"), "Int64": np.dtype("<i8")}


def read_rectilinear(path: Path) -> tuple[tuple[np.ndarray, ...], dict[str, np.ndarray]]:
    """Coordinates, and point data (x, y, z, components)."""
    root = ET.parse(path).getroot()
    assert root.attrib["type"] == "RectilinearGrid"
    assert root.attrib["byte_order"] == "LittleEndian"
    assert root.attrib["header_type"] == "UInt64"
    grid = root.find("RectilinearGrid")
    piece_node = grid.find("Piece")
    extent = [int(bound) for bound in grid.attrib["WholeExtent"].split()]
    shape = tuple(last - first + 1 for first, last in zip(extent[::2], extent[1::2], strict=True))

    def read_array(node: ET.Element) -> np.ndarray:
        content = base64.b64decode(node.text)
        assert int(np.frombuffer(content[:8], "<u8")[0]) == len(content) - 8
        return np.frombuffer(content[8:], TYPES[node.attrib["type"]])

    coordinates = tuple(read_array(node) for node in piece_node.find("Coordinates"))
    data = {}
    for node in piece_node.find("PointData"):
        components = int(node.attrib.get("NumberOfComponents", 1))
        # Points lie in the order x, y, z with x fastest; the components of a point follow each other.
        data[node.attrib["Name"]] = read_array(node).reshape(*shape[::-1], components).transpose(2, 1, 0, 3)
    return coordinates, data
