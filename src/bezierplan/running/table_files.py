"""Files of runs: tables whose columns have the declared types (`columns`). Each holds a digest of
its own rows, so that a later change of any column shows.
"""

import hashlib
import json
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as parquet

from bezierplan.running import columns

_DIGEST = b"bezierplan_rows"

_TYPES = {
    columns.RunName: pa.string(),
    str: pa.string(),
    int: pa.int64(),
    float: pa.float64(),
    bool: pa.bool_(),
    list[float]: pa.list_(pa.float64()),
}


def build_table(rows: list[columns.Row], *declared: type) -> pa.Table:
    """Build a table from rows. Declared columns, as far as rows have them, have their types, others
    that of their values.

    Conditions may differ in their settings, so columns are collected over all rows. Raises KeyError
    for a row that lacks a declared column, and `pyarrow.ArrowInvalid` or `ArrowTypeError` for a
    value that does not have its type.
    """
    types = {name: _TYPES[kind] for name, (kind, _) in columns.read_columns(*declared).items()}
    names = dict.fromkeys(name for row in rows for name in row)
    return pa.table(
        {
            name: pa.array([row[name] for row in rows], types[name])
            if name in types
            else pa.array([row.get(name) for row in rows])
            for name in names
        }
    )


def find_fault(schema: pa.Schema, *declared: type) -> str:
    """Describe the first declared column that a file lacks or has in another type; empty if there
    is none.
    """
    for name, (kind, _) in columns.read_columns(*declared).items():
        if name not in schema.names:
            return f"no column {name}"
        found = schema.field(name).type
        if found != _TYPES[kind]:
            return f"column {name} is of type {found}, not {_TYPES[kind]}"
    return ""


def write(table: pa.Table, file: str) -> None:
    """Write a table with the digest of its rows."""
    digest = {_DIGEST: compute_digest(table)}
    parquet.write_table(table.replace_schema_metadata((table.schema.metadata or {}) | digest), file)


def read(file: str) -> pa.Table:
    """Read the table of a Parquet file. Raises ValueError, naming the file, unless it is there and
    whole.
    """
    if not Path(file).is_file():
        raise ValueError(f"{file}: is not there; start again: the workflow makes it")
    try:
        # By no thread of pyarrow, so that this process can still be forked.
        content = pa.BufferReader(Path(file).read_bytes())
        with parquet.ParquetFile(content, pre_buffer=False) as source:
            return source.read(use_threads=False)
    except (OSError, pa.ArrowException):
        raise describe_misplaced(file, "not a whole Parquet file") from None


def describe_misplaced(file: str, what: str) -> ValueError:
    """Return the exception for a file of results that does not belong in its place."""
    return ValueError(f"{file}: {what}; delete it and start again: the workflow reproduces it")


def read_digest(table: pa.Table) -> str:
    """Return the digest of its rows with which a table was written; empty without one."""
    return (table.schema.metadata or {}).get(_DIGEST, b"").decode()


def compute_digest(table: pa.Table) -> str:
    """Return a digest of all bits of a table, by columns in order of name, whatever the file's
    layout.
    """
    digest = hashlib.sha256()
    for name in sorted(table.column_names):
        column = table[name].combine_chunks()
        digest.update(f"{name} {len(column)} ".encode())
        for part in _yield_parts(column):
            digest.update(part)
    return digest.hexdigest()[:16]


def _yield_parts(column: pa.Array) -> list[bytes]:
    """Return the content of a column as bytes."""
    if pa.types.is_list(column.type):
        values = column.flatten()
        # Without values, any type of them is the same content.
        return [
            b"list",
            *_yield_parts(column.value_lengths()),
            *(_yield_parts(values) if len(values) else [b"[]"]),
        ]
    if pa.types.is_floating(column.type) or pa.types.is_integer(column.type):
        missing = column.is_null().to_numpy(zero_copy_only=False)
        return [
            str(column.type).encode(),
            missing.tobytes(),
            # The bytes behind a missing value are arbitrary.
            column.fill_null(0).to_numpy(zero_copy_only=False).tobytes(),
        ]
    return [json.dumps(column.to_pylist()).encode()]
