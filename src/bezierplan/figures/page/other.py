"""Content of the page from tables beside those of the paper: its methods, how they compare
with the baseline, and which interpretations explain it.
"""

import ast
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from bezierplan import planners
from bezierplan.analysis import baseline_comparison
from bezierplan.analysis.explained import DEFAULT, sentences
from bezierplan.figures.page import content
from bezierplan.figures.page.addresses import address
from bezierplan.figures.page.page_job import MethodShown

# Interpretations shown of a study, beside the default.
MOST_INTERPRETATIONS = 10


def of_method(study: str, name: str, method: MethodShown) -> content.Method:
    """A method. What its planner does stands in the planner's file, which is read and not
    imported.
    """
    planner = method.planner
    file = (
        Path(planner)
        if planners.is_file(planner)
        else Path(planners.__file__).with_name(f"{planner}.py")
    )
    told = ast.get_docstring(ast.parse(file.read_text(encoding="utf-8"))) or ""
    about = [" ".join(paragraph.replace("`", "").split()) for paragraph in told.split("\n\n")]
    settings = {setting: str(value) for setting, value in method.settings.items()}
    place = address(study, "method", name)
    return content.Method(address=place, name=name, planner=planner, about=about, settings=settings)


def of_baseline_comparison(study: str, measured: pd.DataFrame) -> dict[str, Any]:
    """Fields `baseline_comparison` and `baseline_comparison_in_words` of a study, from
    baseline_comparison.csv; none for a study without methods there.
    """
    rows_of_study = measured[measured["study"] == study]
    if rows_of_study.empty:
        return {}
    rows = [
        content.BaselineComparison(
            address=address(study, "baseline_comparison", row["method"]),
            **{
                name: row[name]
                for name in ("method", "baseline", "conditions", "feasible", "feasible_baseline")
            },
            length=_known(row["length"]),
            curvature=_known(row["curvature"]),
            cornered=bool(np.isinf(row["curvature"])),
            cpu=_known(row["cpu"]),
        )
        for row in rows_of_study.to_dict("records")
    ]
    return {
        "baseline_comparison": rows,
        "baseline_comparison_in_words": baseline_comparison.sentence(rows_of_study),
    }


def of_interpretations(
    tried: pd.DataFrame, explained: pd.DataFrame, leave_one_table_out: pd.DataFrame
) -> dict[str, Any]:
    """Fields `explanations`, `interpretations_in_words` and `explained` of a study, from the tables
    of `analysis.explained`.
    """
    named = tried["interpretation"] == DEFAULT
    shown = pd.concat(
        [tried[:MOST_INTERPRETATIONS], tried[MOST_INTERPRETATIONS:][named[MOST_INTERPRETATIONS:]]]
    )
    tables = [
        content.Explained(
            table=str(table),
            numbers=len(rows),
            default=int(rows["default"].sum()),
            best=int(rows["best"].sum()),
            never=int((rows["interpretations"] == 0).sum()),
        )
        for table, rows in explained.groupby("table", sort=False)
    ]
    columns = ["interpretation", "in_range", "numbers", "by_chance"]
    rows = [
        content.Explanation(**row | {"by_chance": _known(row["by_chance"])})
        for row in shown[columns].to_dict("records")
    ]
    return {
        "explanations": rows,
        "interpretations_in_words": sentences(tried, explained, leave_one_table_out),
        "explained": tables,
    }


def _known(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
