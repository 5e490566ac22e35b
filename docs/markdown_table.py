"""Tables in Markdown, as README and site have them."""

from collections.abc import Iterable
from typing import Any


def write_table(heads: Iterable[Any], rows: Iterable[Iterable[Any]]) -> str:
    """Return a table in Markdown from its heads and rows.

    >>> print(write_table(["key", "means"], [["a|b", 1]]))
    | key | means |
    | --- | --- |
    | a\\|b | 1 |
    """
    heads = [*heads]
    lines = [heads, ["---"] * len(heads), *rows]
    # A bar would end a cell.
    texts = ([str(cell).replace("|", "\\|") for cell in line] for line in lines)
    return "\n".join(f"| {' | '.join(text)} |" for text in texts)
