"""Files of runs: tables that hold a digest of their own rows, so that a later change of any column shows."""

import hashlib
import json

import pyarrow as pa
import pyarrow.parquet as parquet

_DIGEST = b"bezierplan_rows"


def write(table: pa.Table, file: str) -> None:
    """Write a table of runs with the digest of its rows."""
    metadata = {**(table.schema.metadata or {}), _DIGEST: rows_digest(table).encode()}
    parquet.write_table(table.replace_schema_metadata(metadata), file)


def kept_digest(table: pa.Table) -> str | None:
    """The digest with which a table was written; None for a file without one."""
    kept = (table.schema.metadata or {}).get(_DIGEST)
    return kept and kept.decode()


def edited(table: pa.Table) -> bool:
    """Whether a table that was read has other rows than when it was written."""
    return kept_digest(table) not in (None, rows_digest(table))


def rows_digest(table: pa.Table) -> str:
    """A hash over the content of a table, column by column in order of name: to the last bit, whatever the layout of the file."""
    found = hashlib.sha256()
    for name in sorted(table.column_names):
        column = table[name].combine_chunks()
        found.update(f"{name} {len(column)} ".encode())
        for part in _parts(column):
            found.update(part)
    return found.hexdigest()[:16]


def _parts(column: pa.Array) -> list[bytes]:
    """The content of a column as bytes."""
    if pa.types.is_list(column.type):
        return [b"list", *_parts(column.value_lengths()), *_parts(column.flatten())]
    if pa.types.is_floating(column.type) or pa.types.is_integer(column.type):
        missing = column.is_null().to_numpy(zero_copy_only=False)
        return [str(column.type).encode(), missing.tobytes(), column.fill_null(0).to_numpy(zero_copy_only=False).tobytes()]
    return [json.dumps(column.to_pylist()).encode()]
