"""Drawings of papers: marks that stand in a file of the study's folder `published`, as a panel of
kind `drawing` shows them.
"""

from typing import Any

import pandas as pd


def list_marks(*sources: Any) -> pd.DataFrame:
    """List the marks of a drawing, a row each, or a row for each point of a line or arrow.

    sources: the workspace over which they are drawn, if any, and the file of the drawing by name.
    """
    (table,) = sources[-1].values()
    if "text" in table and pd.api.types.is_numeric_dtype(table["text"]):
        # A column of digits is read as numbers, but what is drawn are words.
        return table.assign(text=table["text"].map("{:g}".format, na_action="ignore"))
    return table
