"""The paper's own numbers checked against each other."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Field, model_validator

from bezierplan.analysis.claims.effects import Finding
from bezierplan.analysis.claims.kinds import SECONDARY, Check
from bezierplan.analysis.claims.material import Material, Untestable
from bezierplan.schema.model import Number, Values, mapping_or, one_or_list, wrong

if TYPE_CHECKING:
    import pandas as pd

    from bezierplan.analysis.claims.claim import Claim

Selected = dict[str, Values]

# Columns of published files that do not distinguish cells.
_NOT_KEYS = ("value", "n", "unit")


class Options(Check):
    of_printed: ClassVar[bool] = True

    secondary: Literal[True] = Field(None, description=SECONDARY)
    form: Literal["difference", "increase_percent", "equal"] = Field(
        description="difference (second less first), increase_percent (of the second over the "
        "first) or equal (first alone)"
    )
    of: list[Selected] = Field(
        description="a list of one or two {table: file, column: value, ...}: published cells",
        min_length=1,
        max_length=2,
    )
    equals: Annotated[Any, mapping_or(Selected, Number)] = Field(
        description="a number, or {table: file, column: value, ...}"
    )

    @model_validator(mode="after")
    def _check_tables(self) -> Options:
        wanted = 1 if self.form == "equal" else 2
        if len(self.of) != wanted:
            raise wrong(f"of: {len(self.of)} cells; {self.form} needs {wanted}")
        for selector in (*self.of, *([self.equals] if isinstance(self.equals, dict) else [])):
            if "table" not in selector:
                raise wrong(
                    "of: table: missing key; "
                    "a file of the folder published, or a list of them, without .csv"
                )
        return self


def findings(check: Options, claim: Claim, material: Material) -> list[tuple[str, str, Finding]]:
    """One finding per cell. Raises Untestable if a printed cell is empty."""
    computed = arithmetic(check, material.published)
    if empty := [finding.reason for _, finding in computed if finding.mark == "?"]:
        raise Untestable(empty[0])
    return [(condition, check.form, finding) for condition, finding in computed]


def arithmetic(check: Options, published: dict[str, pd.DataFrame]) -> list[tuple[str, Finding]]:
    """Test whether printed numbers agree. One finding for each cell of the first selector, with the
    cell's name.

    `difference`: the second minus the first; `increase_percent`: of the second over the first;
    `equal`: the first alone. Cells of several selectors are matched by equal values of the columns
    that no selector names; a lone cell matches every other. The computed number may differ from the
    printed one by half a unit of the last printed digit. NaN where a cell is empty or missing.
    """
    import pandas as pd

    selectors = [*check.of, *([check.equals] if isinstance(check.equals, dict) else [])]
    named = {column for selector in selectors for column in selector}
    cells = _selected(published, selectors[0])
    columns = ["value"]
    for number, selector in enumerate(selectors[1:], start=1):
        others = _selected(published, selector)
        columns.append(f"value{number}")
        common = [
            column
            for column in cells.columns.intersection(others.columns)
            if column not in {*named, *_NOT_KEYS}
        ]
        others = others.rename(columns={"value": columns[-1]})
        if len(cells) == len(others) == 1:
            cells = cells.assign(**{columns[-1]: others[columns[-1]].iloc[0]})
        else:
            cells = cells.merge(others[[*common, columns[-1]]], how="left", on=common)
    keys = [column for column in cells.columns if column not in {*named, *_NOT_KEYS, *columns}]
    names = [
        ", ".join(f"{key}={row[key]}" for key in keys if not pd.isna(row[key]))
        for _, row in cells.iterrows()
    ]
    return [
        (name, _computed(check, row))
        for name, row in zip(names, cells[columns].to_numpy(dtype=float).tolist())
    ]


def _selected(published: dict[str, pd.DataFrame], selector: dict) -> pd.DataFrame:
    """The rows of one or several published files that a selector names."""
    import pandas as pd

    rows = pd.concat(
        [published[name] for name in one_or_list(selector["table"])], ignore_index=True
    )
    for column, wanted in selector.items():
        if column != "table":
            rows = rows[rows[column].isin(one_or_list(wanted))]
    return rows


def _computed(check: Options, numbers: list[float]) -> Finding:
    """One comparison of printed numbers: those of `of`, and that of `equals` if it is one."""
    if any(map(math.isnan, numbers)):
        return Finding(mark="?", reason="a printed cell is empty")
    wanted = numbers.pop() if isinstance(check.equals, dict) else float(check.equals)
    match check.form:
        case "difference":
            computed = numbers[1] - numbers[0]
        case "increase_percent":
            computed = 100 * (numbers[1] / numbers[0] - 1) if numbers[0] else math.nan
        case "equal":
            computed = numbers[0]
    # The larger number of digits of two printed numbers, because a trailing zero is lost on
    # reading.
    digits = max(map(_decimals, [wanted, computed] if check.form == "equal" else [wanted]))
    fits = abs(computed - wanted) <= 0.5 * 10.0**-digits * (1 + 1e-9)
    return Finding(computed, "printed", wanted, mark="+" if fits else "-")


def _decimals(number: float) -> int:
    """Decimal places of the shortest decimal equal to this number."""
    text = np.format_float_positional(number, trim="-")
    return len(text.partition(".")[2])
