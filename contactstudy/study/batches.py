"""Batches: netCDF files of many finished cases, the only format of a study's results.

Numbers are columns, arrays are contiguous ragged arrays of the CF conventions, see docs/reference/results_files.md. A
batch is never changed; the CRC-32 in its name detects damage without decoding.
"""

from __future__ import annotations

import json
import zlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import pandas as pd
import xarray as xr

from contactstudy.analysis.provenance import RUN_ATTRIBUTE
from contactstudy.arrays.variables import describe, labels, package_version
from contactstudy.checks import TEMPORARY_SUFFIX, IntArray, writing
from contactstudy.errors import StoreError
from contactstudy.study.files import is_regular, netcdf_access

STATUSES = ("ok", "failed", "skipped")  # States of a case in a batch, by their code
TEXT_COLUMNS = {  # Text columns with their meanings
    "parameters": "parameters of the case as JSON, without those in contactstudy_shared",
    "message": "reason of a case that is not ok",
    "warnings": "warnings of the case as JSON",
    "time": "end of the case's solution, UTC",
}

COLUMNS = ("status", "run", *TEXT_COLUMNS)  # Columns of a batch's table that are neither numbers nor sizes
SIZE_SUFFIX = "_size"  # End of the names of columns of sizes, after the dimension
SUFFIX = ".nc"
IDENTITY_LENGTH = 64
CHUNK_SIZE = 2**15  # Values compressed together in a ragged array. Speed: more make files smaller, single cases slower
CASE_ATTRIBUTE = "contactstudy_case"  # Attribute of a case: its parameters as JSON
SHARED_ATTR, TABLES_ATTR, COORDINATES_ATTR = "contactstudy_shared", "contactstudy_tables", "contactstudy_coordinates"
"""Attributes: parameters of all cases, tables that parameters refer to by number, names of coordinates."""


class RaggedArray(NamedTuple):
    """Arrays of all cases of a batch, one after the other: dimensions of each case's array, and flat values."""

    dims: tuple[str, ...]
    values: npt.NDArray[Any]


@dataclass(frozen=True, eq=False, kw_only=True)
class Batch:
    """Cases of a batch in memory."""

    # a row per identity: status, run, texts, numbers (NaN if absent), and sizes of the arrays' dimensions
    cases: pd.DataFrame
    arrays: dict[str, RaggedArray] = field(default_factory=dict)  # arrays and their positions
    attributes: dict[str, dict[str, Any]] = field(default_factory=dict)  # of numbers and arrays
    coordinates: frozenset[str] = frozenset()  # names of arrays that are coordinates
    run_context: dict[str, Any] = field(default_factory=dict)  # versions and level, equal for all cases

    def __len__(self) -> int:
        return len(self.cases)

    @property
    def nbytes(self) -> int:
        """Size in memory, bytes."""
        return 8 * int(self.cases.size) + sum(array.values.nbytes for array in self.arrays.values())

    @property
    def numbers(self) -> list[str]:
        """Names of the numbers of the cases."""
        return [name for name in self.cases if name not in COLUMNS and not name.endswith(SIZE_SUFFIX)]

    @property
    def structure(self) -> str:
        """Context of the run; names, dimensions and types of the arrays. Batches of equal structure can be joined."""
        arrays = sorted((name, array.dims, array.values.dtype.str) for name, array in self.arrays.items())
        return json.dumps([self.run_context, arrays], sort_keys=True)

    def sizes(self, dims: Iterable[str]) -> IntArray:
        """Size (case, dimension) of each case's arrays along `dims`; 0 without arrays."""
        return np.asarray(self.cases[[f"{dim}{SIZE_SUFFIX}" for dim in dims]], dtype=np.int64)

    def offsets(self, dims: Iterable[str]) -> IntArray:
        """Start of each case's values in a ragged array along `dims`, and the end of the last case's values."""
        return np.concatenate([[0], np.cumsum(self.sizes(dims).prod(axis=1))])

    def take(self, rows: IntArray) -> Batch:
        """Return a batch with the cases of these rows."""
        selected_arrays = {}
        for name, (dims, values) in self.arrays.items():
            starts = self.offsets(dims)
            slices = [values[starts[row] : starts[row + 1]] for row in rows]
            selected_arrays[name] = RaggedArray(dims, np.concatenate(slices) if slices else values[:0])
        return replace(self, cases=self.cases.iloc[rows], arrays=selected_arrays)

    def record(self, row: int) -> xr.Dataset:
        """Numbers of a case, with versions, level, warnings and solution time as an attribute."""
        numbers, case = self.cases[self.numbers].iloc[row].dropna(), self.cases.iloc[row]
        run = {**self.run_context, "time": case["time"], "warnings": json.loads(case["warnings"] or "[]")}
        run |= {"seconds": float(case["seconds"])} if "seconds" in case else {}
        variables = {name: ((), float(value), self.attributes.get(name, {})) for name, value in numbers.items()}
        return xr.Dataset(variables, attrs={RUN_ATTRIBUTE: json.dumps(run)})


def latest_rows(cases: pd.DataFrame) -> IntArray:
    """Rows of the latest result of each case, in order; within a run a failure replaces a film written before."""
    order = np.lexsort((cases["status"] == "ok", -cases["run"].to_numpy(np.int64)))
    return np.sort(order[~cases.index[order].duplicated()])


def join_batches(batches: Sequence[Batch]) -> Batch:
    """Join batches of equal structure."""
    attributes: dict[str, dict[str, Any]] = {}
    for batch in batches:
        for name, attribute in batch.attributes.items():
            attributes[name] = common_attributes(name, attributes[name], attribute) if name in attributes else attribute
    arrays = {
        name: RaggedArray(array.dims, np.concatenate([batch.arrays[name].values for batch in batches]))
        for name, array in batches[0].arrays.items()
    }
    cases = pd.concat([batch.cases for batch in batches])
    return replace(batches[0], cases=cases, arrays=arrays, attributes=attributes)


def common_attributes(name: str, attributes: Mapping[str, Any], other_attributes: Mapping[str, Any]) -> dict[str, Any]:
    """Return the attributes that a variable has in both cases; a comment replaces different units of an intensity."""
    if attributes == other_attributes:
        return dict(attributes)
    common = {key: value for key, value in attributes.items() if other_attributes.get(key) == value}
    if "units" in attributes and "units" in other_attributes and "units" not in common:
        exponent = name.replace("intensity", "exponent").removesuffix("_error")
        common["comment"] = f"its unit is Pa m^m with m = {exponent} of the case"
    return common


def write_batch(folder: Path, name: str, batch: Batch) -> None:
    """Write a batch as a new file, whose name ends with the CRC-32 of the bytes."""
    path, rename = (folder / name, lambda temporary_path: f"{name}-{len(batch)}-{checksum(temporary_path):08x}{SUFFIX}")
    with writing(path, rename) as temporary_path, netcdf_access(path, "write"):
        _write_variables(temporary_path, batch)


def checksum(path: Path) -> int:
    """CRC-32 of a file."""
    code = 0
    with open(path, "rb") as file:
        while block := file.read(2**22):
            code = zlib.crc32(block, code)
    return code


def find_damage(path: Path) -> str:
    """Reason why a file is not an intact batch; an empty text for an intact batch."""
    if not is_regular(path):
        return "it is not a regular file"
    try:
        actual = checksum(path)
    except OSError as error:
        return error.strerror or str(error)
    expected = path.name.removesuffix(SUFFIX).rpartition("-")[2]
    return "" if expected == f"{actual:08x}" else f"its checksum is {actual:08x}, not {expected}"


def batch_paths(folder: Path) -> list[Path]:
    """Paths with the name of a batch, in a stable order."""
    return sorted(path for path in folder.glob(f"*{SUFFIX}") if TEMPORARY_SUFFIX not in path.name)


def count_cases(path: Path) -> int:
    """Return the number of cases in a batch's name; 0 for another name."""
    count = path.name.split("-")[-2:-1]
    return int(count[0]) if count and count[0].isdecimal() else 0


def _write_variables(path: Path, batch: Batch) -> None:
    """Write all variables of a batch."""
    import netCDF4

    cases = batch.cases

    with netCDF4.Dataset(path, "w", format="NETCDF4") as file:
        file.set_fill_off()
        file.createDimension("case", len(batch))
        storage = {"zlib": True, "complevel": 1, "shuffle": True, "fletcher32": True, "chunksizes": (len(batch),)}

        def create(name: str, dtype: Any, dims: tuple[str, ...], attributes: Mapping[str, Any], **options: Any) -> Any:
            variable = file.createVariable(name, dtype, dims, **{**storage, **options})
            variable.setncatts({key: value for key, value in attributes.items() if not isinstance(value, str) or value})
            return variable

        _write_text(file, "case_id", cases.index, "identity of the case, a hash of its parameters")
        flag_attrs = {"flag_values": np.arange(len(STATUSES), dtype=np.int8), "flag_meanings": " ".join(STATUSES)}
        status_attrs = {"long_name": "state of the case", "units": "1", **flag_attrs}
        create("status", "i1", ("case",), status_attrs)[:] = cases["status"].map(STATUSES.index)
        create("run", "i4", ("case",), {"long_name": "number of the run", "units": "1"})[:] = cases["run"]
        shared, tables, parameters = _factor_out_shared([json.loads(text) for text in cases["parameters"]])
        for name, meaning in TEXT_COLUMNS.items():
            _write_text(file, name, parameters if name == "parameters" else cases[name], meaning)
        for name in batch.numbers:
            create(name, "f8", ("case",), _file_attributes(name, batch.attributes))[:] = cases[name]
        for dim in sorted({dim for array in batch.arrays.values() for dim in array.dims}):
            attributes = {"long_name": f"size along {dim}", "units": "1", "sample_dimension": f"{dim}_values"}
            create(f"{dim}{SIZE_SUFFIX}", "i4", ("case",), attributes)[:] = batch.sizes([dim])[:, 0]
        for name, (dims, values) in batch.arrays.items():
            value_dim = f"{'_'.join(dims)}_values"
            if value_dim not in file.dimensions:
                file.createDimension(value_dim, values.size)
            if values.size:
                attributes = {**_file_attributes(name, batch.attributes), "array_dimensions": " ".join(dims)}
                chunks = (min(CHUNK_SIZE, values.size),)
                create(name, values.dtype, (value_dim,), attributes, chunksizes=chunks)[:] = values
        file.setncatts(
            {
                "Conventions": "CF-1.11",
                "title": f"cases of the study {batch.run_context.get('study', '')}",
                "source": f"contactstudy {package_version()}",
                "history": f"{cases['time'].iloc[-1]} written by contactstudy",
                RUN_ATTRIBUTE: json.dumps(batch.run_context),
                SHARED_ATTR: json.dumps(shared),
                TABLES_ATTR: json.dumps(tables),
                COORDINATES_ATTR: json.dumps(sorted(batch.coordinates)),
            }
        )


def _file_attributes(name: str, attributes: Mapping[str, Mapping[str, Any]]) -> dict[str, Any]:
    """Attributes of a variable for netCDF: texts and numbers as they are, other values as JSON."""
    all_attributes = {"long_name": name.replace("_", " "), **labels(name), **attributes.get(name, {})}
    plain_types = (str, int, float, np.number)
    return {
        key: value if isinstance(value, plain_types) and not isinstance(value, bool) else json.dumps(value, default=str)
        for key, value in all_attributes.items()
    }


def _write_text(file: Any, name: str, texts: Iterable[str], meaning: str) -> None:
    """Write a column of texts as characters, padded to the longest."""
    encoded = [text.encode() for text in texts]
    length = max(1, *map(len, encoded))
    file.createDimension(f"{name}_length", length)
    dims, sizes = ("case", f"{name}_length"), (len(encoded), length)
    variable = file.createVariable(name, "S1", dims, zlib=True, complevel=1, fletcher32=True, chunksizes=sizes)
    variable.setncatts({"long_name": meaning, "_Encoding": "utf-8"})
    variable.set_auto_chartostring(False)
    variable[:] = np.array(encoded, dtype=f"S{length}").view("S1").reshape(sizes)


def _factor_out_shared(parameters: list[dict[str, Any]]) -> tuple[dict[str, Any], list[Any], list[str]]:
    """Shared parameters, tables that cases refer to by number, and the remaining parameters of each case as JSON."""
    shared = {
        name: value for name, value in parameters[0].items() if all(case.get(name) == value for case in parameters)
    }
    tables: dict[str, int] = {}
    texts = []
    for case in parameters:
        own_parameters = {name: value for name, value in case.items() if name not in shared}
        for name, value in own_parameters.items():
            if isinstance(value, (dict, list)):
                own_parameters[name] = {"table": tables.setdefault(json.dumps(value), len(tables))}
        texts.append(json.dumps(own_parameters))
    return shared, [json.loads(table) for table in tables], texts


def _restore_parameters(shared: dict[str, Any], tables: list[Any], remaining: str) -> str:
    """Parameters of a case as JSON."""
    case = json.loads(remaining)
    for name, value in case.items():
        if isinstance(value, dict):
            case[name] = tables[value["table"]]
    return json.dumps({**shared, **case})


def read_batch(path: Path, *, arrays: Iterable[str] | None = (), parameters: bool = False) -> Batch:
    """Read a batch: its cases, without or with their parameters, and the named arrays; None reads all arrays."""
    import netCDF4

    if not is_regular(path):
        raise StoreError(f"cannot read {path}: it is not a regular file")
    with netcdf_access(path, "read"), netCDF4.Dataset(path) as file:
        file.set_auto_maskandscale(False)
        selected_names = None if arrays is None else set(arrays)
        columns, ragged_arrays, attributes = {"status": np.array(STATUSES)[file["status"][:]]}, {}, {}
        for name, variable in file.variables.items():
            if name in ("case_id", "status") or (name == "parameters" and not parameters):
                continue
            attributes[name] = {key: variable.getncattr(key) for key in variable.ncattrs()}
            if dims := attributes[name].pop("array_dimensions", ""):
                is_selected = selected_names is None or name in selected_names
                values = variable[:] if is_selected else np.empty(0, dtype=variable.dtype)
                ragged_arrays[name] = RaggedArray(tuple(dims.split()), values)
            else:
                columns[name] = variable[:]
        if parameters:
            shared, tables = json.loads(file.getncattr(SHARED_ATTR)), json.loads(file.getncattr(TABLES_ATTR))
            columns["parameters"] = [_restore_parameters(shared, tables, text) for text in columns["parameters"]]
        batch = Batch(
            cases=pd.DataFrame(columns, index=file["case_id"][:]),
            arrays=ragged_arrays,
            attributes=attributes,
            coordinates=frozenset(json.loads(file.getncattr(COORDINATES_ATTR))),
            run_context=json.loads(file.getncattr(RUN_ATTRIBUTE)),
        )
        if not _is_complete(batch, {name: file[name].size for name in ragged_arrays}):
            raise ValueError("it is not a batch of cases")
        return batch


def _is_complete(batch: Batch, array_sizes: Mapping[str, int]) -> bool:
    """Whether a batch from a file has the types and sizes of a written batch; a missing column raises."""
    cases, is_text = batch.cases, pd.api.types.is_string_dtype
    others = cases.drop(columns=["status", *TEXT_COLUMNS], errors="ignore").dtypes
    return (
        all(is_text(cases[name]) for name in ("message", "warnings", "time"))
        and all(dtype.kind in "iuf" for dtype in (cases["run"].dtype, *others))
        and all(isinstance(json.loads(text or "[]"), list) for text in {*cases["warnings"]})
        and all(isinstance(value, str) for value in batch.run_context.values())
        and cases.index.str.len().isin([IDENTITY_LENGTH]).all()
        and batch.coordinates <= {*batch.arrays}
        and all(batch.offsets(array.dims)[-1] == array_sizes[name] for name, array in batch.arrays.items())
    )


def read_slices(path: Path, bounds: Mapping[str, Sequence[tuple[int, int]]]) -> dict[str, list[npt.NDArray[Any]]]:
    """Read slices of the named ragged arrays, between pairs of first and last value."""
    import netCDF4

    with netcdf_access(path, "read"), netCDF4.Dataset(path) as file:
        file.set_auto_maskandscale(False)
        return {
            name: [np.asarray(file[name][start:stop]) if stop > start else np.zeros(0) for start, stop in pairs]
            for name, pairs in bounds.items()
        }


def read_case(path: Path, row: int, names: Iterable[str] | None = None) -> xr.Dataset:
    """Read one case of a batch on its cells, with its numbers, parameters, the context of its run, and named arrays."""
    batch = read_batch(path, parameters=True)
    selected_names = set(batch.arrays if names is None else names) & set(batch.arrays)
    selected_dims = {dim for name in selected_names for dim in batch.arrays[name].dims}
    coordinates = [name for name in batch.coordinates if set(batch.arrays[name].dims) <= selected_dims]
    offsets = {name: batch.offsets(batch.arrays[name].dims) for name in {*selected_names, *coordinates}}
    bounds = {name: [(starts[row], starts[row + 1])] for name, starts in offsets.items()}
    variables = {}
    for name, (values,) in read_slices(path, bounds).items():
        dims = batch.arrays[name].dims
        variables[name] = (dims, values.reshape(batch.sizes(dims)[row]), batch.attributes[name])
    attributes = {"case_id": batch.cases.index[row], CASE_ATTRIBUTE: batch.cases["parameters"].iloc[row]}
    dataset = batch.record(row).assign(variables).set_coords(coordinates)
    return describe(dataset, f"case of the study {batch.run_context.get('study', '')}").assign_attrs(attributes)


def add_arrays(batch: Batch, dataset: xr.Dataset, level: str) -> Batch:
    """Add the arrays of a solved case that a level above the summary retains; fields in single precision."""
    fields = [name for name, array in dataset.data_vars.items() if any(str(dim).startswith("z") for dim in array.dims)]
    retained = dataset if level == "fields" else dataset.drop_vars(fields)
    dims = {str(dim) for array in retained.data_vars.values() for dim in array.dims}
    arrays = {}
    for name, variable in retained.variables.items():
        if variable.ndim and dims.issuperset(variable.dims):
            values = variable.values
            if values.dtype == bool:
                values = values.astype(np.int8)
            elif name in fields and values.ndim >= 2:
                values = values.astype(np.float32)
            arrays[str(name)] = RaggedArray(tuple(map(str, variable.dims)), np.ascontiguousarray(values).ravel())
    return replace(
        batch,
        cases=batch.cases.assign(**{f"{dim}{SIZE_SUFFIX}": dataset.sizes[dim] for dim in sorted(dims)}),
        arrays=arrays,
        attributes=batch.attributes | {name: dict(retained[name].attrs) for name in arrays},
        coordinates=frozenset(arrays) & {str(name) for name in retained.coords},
    )
