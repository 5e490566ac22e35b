"""Text for reports: tables as markdown, and literal reStructuredText."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pandas as pd


def write_table(table: pd.DataFrame) -> str:
    """Write a table as markdown, its index first."""
    rows = [[table.index.name or "", *table.columns], ["---"] * (table.shape[1] + 1)]
    rows += [
        [name, *values] for name, values in zip(table.index, table.to_numpy().tolist(), strict=True)
    ]
    return "\n".join(
        "| " + " | ".join(str(cell).replace("|", "\\|") for cell in row) + " |" for row in rows
    )


def escape_rst(text: str) -> str:
    """Escape text as one line of literal reStructuredText: no markup, no directive, no HTML."""
    return "".join(
        f"\\{sign}" if sign.isascii() and not sign.isalnum() and sign != " " else sign
        for sign in " ".join(text.split())
    )
