"""Addresses of places on the page: what follows # in a link."""

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any


def build_address(*parts: Any) -> str:
    """A path of names; what an address cannot hold, such as a space, becomes _."""
    return "/".join(
        re.sub(r"[^\w.+~-]", "_", f"{part:g}" if isinstance(part, float) else str(part))
        for part in parts
    )


def build_cell_addresses(
    table: str, cells: Sequence[Mapping[str, Any]], primary: Mapping[str, Any]
) -> list[str]:
    """Addresses of the cells of a table, each with its key columns, then `metric` and `statistic`.

    A key is left out where it has its value under the default reading, and for a column with
    one value only, unless two cells would then have the same address: these name all their keys.

    >>> mean = {"method": "x", "metric": "length", "statistic": "mean"}
    >>> of_cells("one/table1", [{"map": "a"} | mean, {"map": "b"} | mean], {"map": "a"})
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
