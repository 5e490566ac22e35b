"""Tables of runs, from the few keys that a test is about."""

from typing import Any

from bezierplan.analysis.table_kinds import Pivot


def pivot_of(given: dict[str, Any]) -> Pivot:
    """A table with the keys that it needs beside those given; its values are named after their
    metrics, and printed with six decimals, unless they say otherwise.
    """
    values = [{"label": value["metric"], "decimals": 6} | value for value in given["values"]]
    needed = {"kind": "pivot", "title": "any", "experiment": "routes"}
    return Pivot.model_validate(needed | given | {"values": values})
