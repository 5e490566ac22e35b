"""Tables as LaTeX: every sign as text, heads in two rows, and a caption that needs no other
file.
"""

import re

import pandas as pd
import pytest

from bezierplan.analysis.numbers.comparison import SIGNS_MEAN
from bezierplan.figures import latex


def written(**columns: list[str]) -> str:
    return latex.format_table(pd.DataFrame(columns), "Shares & lengths", "tab:s-table1")


@pytest.mark.parametrize("sign", list("&%$#_{}~^\\<>"))
def test_no_sign_is_a_command(sign):
    text = latex.escape_signs(f"a{sign}b")
    assert text != f"a{sign}b"
    assert not re.search(r"(?<!\\)[&%$#_~^]", text)


def test_columns_that_begin_alike_share_a_head():
    columns = {"method": ["GA"], "length: mean": ["1.5"], "length: max": ["2"], "n": ["30"]}
    lines = [line.strip() for line in written(**columns).splitlines()]
    assert r"\begin{tabular}{lrrr}" in lines
    assert r"& \multicolumn{2}{c}{length} &  \\" in lines
    assert r"\cmidrule(lr){2-3}" in lines
    assert r"method & mean & max & n \\" in lines
    assert r"GA & 1.5 & 2 & 30 \\" in lines


def test_a_wide_table_is_scaled_to_the_page():
    text = written(**{f"c{number}": ["1"] for number in range(9)})
    assert r"\resizebox{\textwidth}{!}{%" in text
    assert text.count("{") == text.count("}")


def test_printed_number_stands_above_ours_with_its_mark():
    times = ["0.01", "0.02"]
    ours = pd.DataFrame({"method": ["GA", "PRM"], "length": ["1.52", "2.10"], "time": times})
    numbers = pd.DataFrame(
        {
            "table_row": ["0", "1", "0"],
            "table_column": ["0", "0", "1"],
            "as_printed": ["1.5", "3", "4"],
            "position": ["inside", "above", "no range"],
            "wide": ["True", "False", ""],
            "low95_predicted": ["1.4", "", ""],
            "high95_predicted": ["2", "2.2", ""],
        }
    )
    over = latex.stack_numbers(ours, numbers, 1)
    text = latex.format_table(over, "", "", [SIGNS_MEAN])
    assert r"\begin{tabular}{lrr}" in text
    assert (
        r"GA & \shortstack[r]{1.5 \\ ($\bullet$) ours 1.4 to 2} & \shortstack[r]{4 \\ 0.01} \\"
        in text
    )
    assert (
        r"PRM & \shortstack[r]{3 \\ $\uparrow$ ours at most 2.2} & \shortstack[r]{- \\ 0.02} \\"
        in text
    )
    assert r"\footnotesize First the printed number, then the range of ours" in text
