"""Tables as markdown."""

import pandas as pd


def table_text(table: pd.DataFrame) -> str:
    """A table as markdown, its index first."""
    rows = [[table.index.name or "", *table.columns], ["---"] * (table.shape[1] + 1)]
    rows += [
        [name, *values] for name, values in zip(table.index, table.to_numpy().tolist(), strict=True)
    ]
    return "\n".join(
        "| " + " | ".join(str(cell).replace("|", "\\|") for cell in row) + " |" for row in rows
    )
