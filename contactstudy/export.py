"""Results for other programs: fields as VTK for ParaView, all variables for MATLAB, lines and tables as CSV."""

from __future__ import annotations

import base64
import re
import xml.etree.ElementTree as ET
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from contactstudy import checks
from contactstudy.analysis import along_line, single_case
from contactstudy.analysis.axes import axis_dimensions, positions
from contactstudy.analysis.cuts import describe_points, fields_on_same_points, select_arrays
from contactstudy.arrays.variables import (
    AXES,
    ERROR_KIND,
    NOT_ESTIMATED,
    STRESSES,
    UNKNOWN_ERROR,
    index_of,
    labelled_cells,
    require,
    selection_of,
    variable_of,
)
from contactstudy.checks import Array, FloatArray, IntArray
from contactstudy.errors import InvalidInputError

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["to_csv", "to_mat", "to_table", "to_vtk"]

Line = tuple[Sequence[float], Sequence[float]]


def headings(dataset: xr.Dataset, names: Sequence[str]) -> dict[str, str]:
    """Return headings of columns: names with units, and a mark on numbers whose error is not estimated."""
    texts = {}
    for name in names:
        if name in dataset.variables:
            array = dataset[name]
            unit = variable_of(name, array.attrs, coordinate=name in dataset.coords).units
            has_error_estimate = name.endswith("_error") or array.attrs.get(ERROR_KIND) != NOT_ESTIMATED
            texts[name] = f"{name} [{unit}]" if unit and unit != "1" else name
            texts[name] += "" if has_error_estimate else f" ({UNKNOWN_ERROR})"
    return texts


def output_path(path: str | Path, *suffixes: str) -> Path:
    """Return the path of a file to write, whose name must end with one of the `suffixes`."""
    checks.instance("path", path, (str, Path), "a path")
    target = Path(path)
    if suffixes and target.suffix not in suffixes:
        raise InvalidInputError("path", str(path), f"a file name that ends with {' or '.join(suffixes)}")
    return target


def to_table(
    dataset: xr.Dataset, variables: str | Sequence[str] | None = None, *, line: Line | None = None, points: int = 101
) -> pd.DataFrame:
    """Return variables at their points, or interpolated along a line, as a table.

    Parameters
    ----------
    dataset : Dataset
        One case, or a Dataset of :mod:`contactstudy.analysis`.
    variables : str or sequence of str, optional
        Variables or measures, see :func:`contactstudy.analysis.measure`; default: all, or along a line all stresses.
    line : pair of sequences, optional
        Ends of the line, (x, y, z) or (x, y), metres.
    points : int
        Number of points of the line.

    Returns
    -------
    pandas.DataFrame
        Positions first; headings such as ``von_mises [Pa]``, and ``(error not estimated)`` if this is the `error_kind`.

    Raises
    ------
    InvalidInputError
        If the Dataset contains several cases, variables are missing or on different points, or the line leaves them.

    Examples
    --------
    >>> stress = xr.DataArray([1.0, 2.0], dims="z", coords={"z": [0.0, 0.5]}, attrs={"units": "Pa"})
    >>> to_table(xr.Dataset({"von_mises": stress})).columns.tolist()
    ['z [m]', 'von_mises [Pa]']
    """
    require(dataset)
    case = single_case(dataset)
    if line is None:
        arrays = select_arrays(case, variables)
        if variables is None:
            arrays = {name: array for name, array in arrays.items() if array.ndim}
        points_of_arrays = {frozenset(array.dims) for array in arrays.values()}
        if len(points_of_arrays) != 1 or frozenset() in points_of_arrays:
            allowed = "variables on the same points"
            raise InvalidInputError("variables", variables or "all", allowed, describe_points(arrays))
        fields = xr.Dataset(arrays)
    else:
        if not isinstance(line, Sequence) or len(line) != 2:
            raise InvalidInputError("line", line, "a pair of points, each (x, y, z) or (x, y) in metres")
        fields = along_line(case, *line, points=points, variables=variables)
    dims = list(fields.sizes)
    coordinates = [str(name) for name, array in fields.coords.items() if array.ndim and name not in dims]
    table = fields.to_dataframe().reset_index()
    names = [name for name in [*dims, *coordinates, *fields.data_vars] if name in table]
    return table[names].rename(columns=headings(fields, [str(name) for name in names]))


FORMULA_CHARACTERS = ("=", "+", "-", "@", "\t", "\r")  # First characters of a formula, which a spreadsheet would run


def _escape_formula(entry: object) -> object:
    """Return the entry of a table with an apostrophe before a formula."""
    return f"'{entry}" if isinstance(entry, str) and entry.startswith(FORMULA_CHARACTERS) else entry


def csv_text(table: pd.DataFrame) -> str:
    """Return a table as CSV, with an apostrophe before texts that a spreadsheet would run as formulas."""
    texts = {name: column.map(_escape_formula) for name, column in table.items() if column.dtype.kind not in "fiub"}
    return str(table.assign(**texts).rename(columns=_escape_formula).to_csv(index=False))


def to_csv(
    dataset: xr.Dataset,
    path: str | Path,
    variables: str | Sequence[str] | None = None,
    *,
    line: Line | None = None,
    points: int = 101,
) -> Path:
    """Write variables at their points, or interpolated along a line, as CSV.

    Parameters
    ----------
    dataset, variables, line, points
        As for :func:`to_table`.
    path : str or Path
        File to write.

    Raises
    ------
    InvalidInputError
        As :func:`to_table`.
    StoreError
        If the file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> stress = xr.DataArray([1.0, 2.0], dims="z", coords={"z": [0.0, 0.5]}, attrs={"units": "Pa"})
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     print(to_csv(xr.Dataset({"von_mises": stress}), Path(folder) / "depth.csv").read_text().splitlines()[1])
    0.0,1.0
    """
    target = output_path(path)
    return _write_csv(to_table(dataset, variables, line=line, points=points), target)


def _write_csv(table: pd.DataFrame, path: Path) -> Path:
    """Write a table as CSV."""
    with checks.writing(path) as temporary_path:
        temporary_path.write_text(csv_text(table), encoding="utf-8")
    return path


MATLAB_NAME = re.compile(r"[A-Za-z]\w{0,62}", re.ASCII)  # Valid name in MATLAB
STRUCTS = ("units", "meaning", "dims", "about")  # Names of the structs
MATLAB_MAX_BYTES = 2**31 - 1  # Bytes of an array in the format's version 5


def to_mat(dataset: xr.Dataset, path: str | Path, variables: str | Sequence[str] | None = None) -> Path:
    """Write a result, or the cases of a study, for MATLAB (version 5, which Octave and others read too).

    Parameters
    ----------
    dataset : Dataset
        A result, an opened study, whose variables are read one at a time, or a Dataset of `contactstudy.analysis`.
    path : str or Path
        File to write, ending with ``.mat``.
    variables : str or sequence of str, optional
        Variables or measures, see :func:`contactstudy.analysis.measure`; default: all. Coordinates are added.

    Returns
    -------
    Path
        Every variable and coordinate is an array: numbers unchanged, a single dimension as a column, texts as cells.
        The structs ``units``, ``meaning`` and ``dims`` have a field for each name; ``dims.pressure`` is
        ``{'x', 'y'}``. ``about`` contains the attributes of the Dataset, such as versions and inputs.

    Raises
    ------
    InvalidInputError
        If the path has another suffix, or a variable is missing, has an invalid name in MATLAB or more than 2 GB.
    StoreError
        If the file cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> from scipy.io import loadmat
    >>> pressure = xr.DataArray([1.0, 2.0], dims="x", coords={"x": [0.0, 1e-3]}, attrs={"units": "Pa"})
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     read = loadmat(to_mat(xr.Dataset({"pressure": pressure}), Path(folder) / "line.mat"))
    >>> read["pressure"].tolist(), read["units"]["pressure"].item().item()
    ([[1.0], [2.0]], 'Pa')
    """
    from scipy.io import savemat

    require(dataset)
    target = output_path(path, ".mat")
    content: dict[str, Any] = {name: {} for name in STRUCTS}
    arrays = select_arrays(dataset, variables)
    for array in list(arrays.values()):
        arrays |= {str(name): coordinate for name, coordinate in array.coords.items()}
    for name, array in arrays.items():
        if not MATLAB_NAME.fullmatch(name) or name in STRUCTS:
            allowed = f"a name of up to 63 letters, digits and _ that begins with a letter, not {', '.join(STRUCTS)}"
            raise InvalidInputError("variables", name, allowed, "rename it")
        if array.nbytes > MATLAB_MAX_BYTES:
            hint = "select a part of it, or read the netCDF file, which MATLAB can"
            raise InvalidInputError("variables", f"{name} of {array.nbytes / 1e9:.1f} GB", "at most 2 GB each", hint)
        values = array.values
        specification = variable_of(name, array.attrs, coordinate=name in dataset.coords)
        content[name] = values if values.dtype.kind in "biuf" else values.astype(str).astype(object)
        content["units"][name] = specification.units
        content["meaning"][name] = specification.long_name
        content["dims"][name] = np.array([str(dim) for dim in array.dims], dtype=object)
    content["about"] = {
        str(name): str(value) for name, value in dataset.attrs.items() if MATLAB_NAME.fullmatch(str(name))
    } or {"source": ""}
    with checks.writing(target) as temporary_path, temporary_path.open("wb") as file:
        savemat(file, content, long_field_names=True, do_compression=True, oned_as="column")
    return target


TENSOR_INDICES = (0, 3, 4, 3, 1, 5, 4, 5, 2)  # Indices of xx, xy, xz, yx, ... among the six components of a result
VTK_TYPES = {"f": "Float64", "i": "Int64", "u": "UInt8"}  # VTK's types of arrays
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
        Variables or measures, see :func:`contactstudy.analysis.measure`; default: all in the body, else all surfaces.

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
        axes, point_fields = _sort_by_position(fields)
        extent = " ".join(f"0 {axis.size - 1}" for axis in axes)
        # In the format, x varies fastest from point to point.
        points = {name: np.moveaxis(values, (0, 1, 2), (2, 1, 0)) for name, values in point_fields.items()}
        sections = {
            "PointData": {name: values.reshape(-1, *values.shape[3:]) for name, values in points.items()},
            "Coordinates": dict(zip(AXES, axes, strict=True)),
        }
        _write_xml(target, "RectilinearGrid", {"WholeExtent": extent}, {"Extent": extent}, sections)
    elif set(axis_dimensions(first_field).values()) == {"x", "y"}:
        # Only cells with finite values belong to the mesh: a gap is infinite beyond the roller.
        _, grid = labelled_cells("variables", xr.zeros_like(first_field, dtype=np.float64))
        edges = [grid.x_edges, np.linspace(*grid.y_range, grid.cells_y + 1), np.zeros(1)]
        values = {name: array.transpose("x", "y").values for name, array in fields.items()}
        _write_mesh(target, edges, values, in_cells=True)
    else:
        _write_mesh(target, *_sort_by_position(fields), in_cells=False)
    return target


def _sort_by_position(fields: dict[str, xr.DataArray]) -> tuple[list[FloatArray], dict[str, FloatArray]]:
    """Increasing positions along x, y and z, and the values at these points (x, y, z, ...)."""
    first_field = next(iter(fields.values()))
    dims = axis_dimensions(first_field)
    # The format requires increasing positions; an axis without positions is a plane at 0.
    points = {axis: positions(first_field, axis).values if axis in dims else np.zeros(1) for axis in AXES}
    sort_indices = {axis: np.argsort(values, kind="stable") for axis, values in points.items()}
    sorted_fields = {}
    for name, array in fields.items():
        values = array.transpose(*dims.values()).values.astype(np.float64)
        field_values = values.reshape([points[axis].size for axis in AXES])
        sorted_fields[name] = field_values[np.ix_(*sort_indices.values())]
    if all(name in sorted_fields for name in STRESSES):
        components = np.stack([sorted_fields[name] for name in STRESSES], axis=-1)
        sorted_fields["stress"] = components[..., TENSOR_INDICES].reshape(*components.shape[:-1], 3, 3)
    return [points[axis][sort_indices[axis]] for axis in AXES], sorted_fields


def _write_mesh(path: Path, axes: list[FloatArray], fields: Mapping[str, FloatArray], *, in_cells: bool) -> None:
    """Write the cells between points (x, y, z), with values on the points or in the cells."""
    kind, corners = _create_mesh_cells([axis.size for axis in axes])
    nodes = np.stack([axis_positions.ravel() for axis_positions in np.meshgrid(*axes, indexing="ij")], axis=1)
    sections: dict[str, dict[str, Array]] = {
        "CellData" if in_cells else "PointData": {
            name: values.reshape(len(corners if in_cells else nodes), -1).astype(np.float64)
            for name, values in fields.items()
        },
        "Points": {"Points": nodes},
        "Cells": {
            "connectivity": corners.ravel(),
            "offsets": corners.shape[1] * np.arange(1, len(corners) + 1),
            "types": np.full(len(corners), kind, dtype="u1"),
        },
    }
    counts = {"NumberOfPoints": str(len(nodes)), "NumberOfCells": str(len(corners))}
    _write_xml(path, "UnstructuredGrid", {}, counts, sections)


def _write_xml(
    path: Path, kind: str, grid: dict[str, str], piece: dict[str, str], sections: Mapping[str, Mapping[str, Array]]
) -> None:
    """Write arrays in XML as base64 of their number of bytes and bytes; `grid` and `piece` are elements' attributes."""
    root = ET.Element("VTKFile", type=kind, version="1.0", byte_order="LittleEndian", header_type="UInt64")
    piece_element = ET.SubElement(ET.SubElement(root, kind, grid), "Piece", piece)
    for section, arrays in sections.items():
        section_element = ET.SubElement(piece_element, section)
        for name, array in arrays.items():
            array_type = VTK_TYPES[array.dtype.kind]
            element = ET.SubElement(section_element, "DataArray", type=array_type, Name=name, format="binary")
            if array.size > len(array):
                element.set("NumberOfComponents", str(array.size // len(array)))
            content = array.astype(array.dtype.newbyteorder("<"), copy=False).tobytes()
            element.text = base64.b64encode(np.uint64(array.nbytes).tobytes() + content).decode()
    with checks.writing(path) as temporary_path:
        ET.ElementTree(root).write(temporary_path, encoding="utf-8", xml_declaration=True)


def _create_mesh_cells(counts: list[int]) -> tuple[int, IntArray]:
    """VTK's kind of the cells between points, from the numbers of points along the axes, and each cell's corners."""
    points = np.arange(int(np.prod(counts)), dtype="<i8").reshape([count for count in counts if count > 1])
    if points.ndim < 2:
        allowed = "on at least two points along two of x, y and z"
        raise InvalidInputError("variables", f"{counts} points", allowed, "take .vtr or CSV")
    cell_corners = CORNERS if points.ndim == 2 else [(*corner, layer) for layer in (0, 1) for corner in CORNERS]
    neighbour_slices = (slice(None, -1), slice(1, None))  # points at the lower and the upper faces of the cells
    corners = [points[tuple(neighbour_slices[is_upper] for is_upper in corner)].ravel() for corner in cell_corners]
    return (QUADRILATERAL if points.ndim == 2 else HEXAHEDRON), np.stack(corners, axis=1)


SUFFIXES = {"csv": ".csv", "vtk": ".vtr", "mat": ".mat"}  # of the command's formats


def parse_line(text: str) -> Line:
    """Return the ends of a line from ``X,Y,Z:X,Y,Z`` in metres."""
    try:
        start, end = ([float(coordinate) for coordinate in point.split(",")] for point in text.split(":"))
    except ValueError:
        raise InvalidInputError("line", text, "X,Y,Z:X,Y,Z in metres, for example 0,0,0:0,0,2e-4") from None
    return start, end


def export_results(
    path: Path,
    *,
    kind: str | None = None,
    variables: Sequence[str] | None = None,
    line: str | None = None,
    points: int = 101,
    select: Sequence[str] = (),
    out: Path | None = None,
) -> Path | None:
    """Write CSV (summaries of a study, field or line of a case), VTK or MATLAB; None if ``-`` prints the table."""
    from contactstudy.study import collect, open_study
    from contactstudy.study.files import load_result

    if path.is_dir() and not (kind or variables or line or select):
        dataset, target = collect(path), out or path / "summary.csv"
        table = dataset.to_dataframe().reset_index()
        table = table.rename(columns=headings(dataset, [str(name) for name in table.columns]))
    else:
        kind = kind or "csv"
        dataset = open_study(path) if path.is_dir() else load_result(path, "path")
        for name, value in selection_of(select).items():
            dataset = dataset.isel({name: index_of(dataset, name, value, "select")})
        dims = dataset["status"].dims if "status" in dataset else ()
        swept_names = [str(dim) for dim in dims if dataset.sizes[dim] > 1]
        if line is not None and kind != "csv":
            raise InvalidInputError("line", line, f"left out for {kind.upper()}", "write the line as CSV")
        if swept_names and kind != "mat":
            allowed, example = f"with a value of {', '.join(swept_names)} too", dataset[swept_names[0]].values[0]
            raise InvalidInputError("select", list(select), allowed, f"such as --select {swept_names[0]}={example}")
        target = out or (path / f"export{SUFFIXES[kind]}" if path.is_dir() else path.with_suffix(SUFFIXES[kind]))
        if kind == "vtk":
            return to_vtk(dataset, target, variables)
        if kind == "mat":
            if swept_names and variables is None:
                dataset = dataset.drop_dims([dim for dim in dataset.dims if dim not in dataset["status"].dims])
            return to_mat(dataset, target, variables)
        table = to_table(dataset, variables, line=None if line is None else parse_line(line), points=points)
    if str(target) != "-":
        return _write_csv(table, target)
    print(csv_text(table), end="")
    return None
