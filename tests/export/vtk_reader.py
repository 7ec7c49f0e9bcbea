"""A reader of VTK's XML format that shares nothing with the writer: Python's XML, base64 and zlib."""

from __future__ import annotations

import base64
import xml.etree.ElementTree as ET
import zlib
from pathlib import Path

import numpy as np

TYPES = {"Float64": np.dtype("<f8"), "Float32": np.dtype("<f4"), "Int64": np.dtype("<i8")}


def _decode(text: str) -> bytes:
    """Blocks compressed one by one, behind a header of their number, sizes and compressed sizes."""
    text = text.strip()
    (blocks,) = np.frombuffer(base64.b64decode(text[:8])[:4], "<u4")
    characters = 4 * -(-4 * (3 + int(blocks)) // 3)
    header = np.frombuffer(base64.b64decode(text[:characters])[: 4 * (3 + int(blocks))], "<u4")
    raw, content, start = base64.b64decode(text[characters:]), b"", 0
    for size in header[3:]:
        content += zlib.decompress(raw[start : start + int(size)])
        start += int(size)
    return content


def read(path: Path) -> tuple[tuple[np.ndarray, ...], dict[str, np.ndarray]]:
    """Coordinates, and point data (x, y, z, components)."""
    root = ET.parse(path).getroot()
    assert root.attrib["type"] == "RectilinearGrid"
    assert root.attrib["byte_order"] == "LittleEndian"
    grid = root.find("RectilinearGrid")
    piece = grid.find("Piece")
    extent = [int(number) for number in grid.attrib["WholeExtent"].split()]
    shape = tuple(last - first + 1 for first, last in zip(extent[::2], extent[1::2], strict=True))

    def array(node: ET.Element) -> np.ndarray:
        return np.frombuffer(_decode(node.text), TYPES[node.attrib["type"]])

    coordinates = tuple(array(node) for node in piece.find("Coordinates"))
    data = {}
    for node in piece.find("PointData"):
        components = int(node.attrib["NumberOfComponents"])
        # Points in the order x, y, z, x fastest; the components of a point together.
        data[node.attrib["Name"]] = array(node).reshape(*shape[::-1], components).transpose(2, 1, 0, 3)
    return coordinates, data
