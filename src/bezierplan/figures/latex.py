"""Tables as LaTeX, ready to be read by a paper that loads `booktabs` and `graphicx`."""

import itertools
from collections.abc import Iterable, Sequence

import numpy as np
import pandas as pd

from bezierplan.analysis.numbers.comparison import describe_range

_SIGNS = {
    "\\": r"\textbackslash{}",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    "<": r"\textless{}",
    ">": r"\textgreater{}",
    "²": r"\textsuperscript{2}",
    "→": r"$\to$",
    "●": r"$\bullet$",
    "▲": r"$\uparrow$",
    "▼": r"$\downarrow$",
    "ζ": r"$\zeta$",
}
_SIGNS |= {sign: f"\\{sign}" for sign in "&%$#_{}"}

# Columns that fit a page; more are scaled down to its width.
_MOST_COLUMNS = 7

# Between the levels of a column's name in the csv file.
_LEVEL = ": "


def stack_numbers(ours: pd.DataFrame, numbers: pd.DataFrame, heads: int) -> pd.DataFrame:
    """Return a table with the printed number above our range in each cell.

    Where there is no range, our number stands below. numbers: the table's comparison, all text.
    heads: how many columns name the rows.
    """
    cells = ours.iloc[:, heads:].to_numpy()
    over = np.where(cells == "", "-\n", "-\n" + cells)
    for number in numbers[numbers["table_row"] != ""].to_dict("records"):
        place = int(number["table_row"]), int(number["table_column"])
        over[place] = f"{number['as_printed']}\n{describe_range(number) or cells[place]}"
    return ours.iloc[:, :heads].join(pd.DataFrame(over, ours.index, ours.columns[heads:]))


def format_table(table: pd.DataFrame, caption: str, label: str, notes: Sequence[str] = ()) -> str:
    """Return a table as LaTeX, with numbers on the right, and a common head above columns whose
    names begin alike.

    table: all text, as in its csv file. label: for `\\ref`. notes: sentences below the table.

    >>> lengths = pd.DataFrame({"method": ["a_b"], "length: mean": ["1.5"]})
    >>> print(format_table(lengths, "Lengths in %", "tab:x"))
    % Needs \\usepackage{booktabs,graphicx}.
    \\begin{table}[htbp]
      \\centering
      \\caption{Lengths in \\%}
      \\label{tab:x}
      \\begin{tabular}{lr}
        \\toprule
        method & length: mean \\\\
        \\midrule
        a\\_b & 1.5 \\\\
        \\bottomrule
      \\end{tabular}
    \\end{table}
    <BLANKLINE>
    """
    sides = "".join(
        "r" if _is_number(table[column].str.split("\n").str[0]) else "l" for column in table
    )
    cells = map(_format_row, table.itertuples(index=False))
    rows = ["\\toprule", *_format_heads(list(table.columns)), "\\midrule", *cells, "\\bottomrule"]
    body = [f"\\begin{{tabular}}{{{sides}}}", *(f"  {row}" for row in rows), "\\end{tabular}"]
    if len(table.columns) > _MOST_COLUMNS:
        body = ["\\resizebox{\\textwidth}{!}{%", *body, "}"]
    lines = [
        "\\centering",
        f"\\caption{{{escape_signs(caption)}}}",
        f"\\label{{{label}}}",
        *body,
        *(f"\\par\\footnotesize {escape_signs(note)}." for note in notes),
    ]
    head = ["% Needs \\usepackage{booktabs,graphicx}.", "\\begin{table}[htbp]"]
    return "\n".join([*head, *(f"  {line}" for line in lines), "\\end{table}", ""])


def escape_signs(text: str) -> str:
    """Return text in which LaTeX reads no sign as a command."""
    # All signs at once: one after the other would escape the backslashes of the replacements.
    return text.translate(str.maketrans(_SIGNS))


def _format_row(cells: Iterable[str]) -> str:
    """Return a row of LaTeX from texts, in which a text of two lines becomes a stack."""
    texts = map(escape_signs, cells)
    stacks = [
        "\\shortstack[r]{" + text.replace("\n", " \\\\ ") + "}" if "\n" in text else text
        for text in texts
    ]
    return " & ".join(stacks) + " \\\\"


def _format_heads(names: list[str]) -> list[str]:
    """Return the rows of heads: one, or two if neighbouring columns share the first part of their
    names.
    """
    parts = [name.split(_LEVEL, 1) for name in names]
    if all(part[0] != after[0] for part, after in itertools.pairwise(parts)):
        return [_format_row(names)]
    above, rules, below = [], "", []
    for first, group in itertools.groupby(parts, key=lambda part: part[0]):
        shown = [part[-1] for part in group]
        if shown == [first]:
            above.append("")
        else:
            above.append(f"\\multicolumn{{{len(shown)}}}{{c}}{{{escape_signs(first)}}}")
            rules += f"\\cmidrule(lr){{{len(below) + 1}-{len(below) + len(shown)}}}"
        below += shown
    return [" & ".join(above) + " \\\\", rules, _format_row(below)]


def _is_number(column: pd.Series) -> bool:
    """Tell whether a column of text holds numbers, and empty cells or dashes at most."""
    given = column[~column.isin(["", "-"])]
    return len(given) > 0 and pd.to_numeric(given, errors="coerce").notna().all()
