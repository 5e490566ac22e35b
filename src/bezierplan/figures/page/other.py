"""Content of the page from tables beside those of the paper: its methods, and how they
compare with the baseline.
"""

import ast
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from bezierplan import planners
from bezierplan.analysis import baseline_comparison
from bezierplan.figures.page import content
from bezierplan.figures.page.addresses import address
from bezierplan.figures.page.page_job import MethodShown


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


def _known(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
