"""Addresses of places on the page, the part of a link after #."""

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any


def build_address(*parts: Any) -> str:
    """Return a path of names, with _ for each sign that an address cannot hold, such as a space."""
    return "/".join(
        # A column with gaps is read as 20.0, and has the address of 20.
        re.sub(r"[^\w.+~-]", "_", f"{part:g}" if isinstance(part, float) else str(part))
        for part in parts
    )


def build_cell_addresses(
    table: str, cells: Sequence[Mapping[str, Any]], primary: Mapping[str, Any]
) -> list[str]:
    """Return the addresses of the cells of a table, each with its key columns, `metric` and
    `statistic`.

    A key is left out if it has its value under the default reading, or if its column has one value
    only. If two cells would then have the same address, these two name all their keys. cells: with
    these columns. primary: key -> value under the default reading.

    >>> mean = {"method": "x", "metric": "length", "statistic": "mean"}
    >>> build_cell_addresses("one/table1", [{"map": "a"} | mean, {"map": "b"} | mean], {"map": "a"})
    ['one/table1/length/mean', 'one/table1/b/length/mean']
    """
    single = {
        column
        for column in (cells[0] if cells else ())
        if len({cell[column] for cell in cells}) == 1
    } - {"metric", "statistic"}
    told = [
        [
            value
            for column, value in cell.items()
            if column not in single and primary.get(column) != value
        ]
        for cell in cells
    ]
    short = [f"{table}/{build_address(*values)}" for values in told]
    count = Counter(short)
    return [
        name if count[name] == 1 else f"{table}/{build_address(*cell.values())}"
        for name, cell in zip(short, cells, strict=True)
    ]
