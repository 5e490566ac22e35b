"""Tables as LaTeX, ready to be read by a paper that loads `booktabs` and `graphicx`."""

import itertools
from collections.abc import Mapping
from typing import NamedTuple

import pandas as pd

_SIGNS = {
    "\\": r"\textbackslash{}",
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    "<": r"\textless{}",
    ">": r"\textgreater{}",
}
_SIGNS |= {sign: f"\\{sign}" for sign in "&%$#_{}"}
_SIGNS |= {"²": r"\textsuperscript{2}", "→": r"$\to$", "ζ": r"$\zeta$"}

# Columns that fit a page; more are scaled down to its width.
_MOST_COLUMNS = 7

# Between the levels of a column's name in the csv file.
_LEVEL = ": "


class Captioned(NamedTuple):
    """A table with its caption and the label that `\\ref` takes. table: all text, as in its csv
    file.
    """

    table: pd.DataFrame
    caption: str
    label: str


def captioned(files: Mapping[str, str], captions: Mapping[str, str], study: str) -> list[Captioned]:
    """Tables in csv files, by name, with their captions; their labels begin with the name of the
    study.
    """
    return [
        Captioned(
            pd.read_csv(file, dtype=str, keep_default_na=False),
            captions[name],
            f"tab:{study}-{name}",
        )
        for name, file in files.items()
    ]


def document(tables: list[Captioned]) -> str:
    """Tables one after the other, each as an environment of its own."""
    return "\n".join(["% Needs \\usepackage{booktabs,graphicx}.", *map(environment, tables)])


def environment(captioned: Captioned) -> str:
    """A table with rules as of a book: numbers on the right, and columns whose names begin alike
    below a common head.

    >>> lengths = pd.DataFrame({"method": ["a_b"], "length: mean": ["1.5"]})
    >>> print(environment(Captioned(lengths, "Lengths in %", "tab:x")))
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
    table = captioned.table
    sides = "".join("r" if _is_number(table[column]) else "l" for column in table)
    cells = map(_row, table.itertuples(index=False))
    rows = ["\\toprule", *_heads(list(table.columns)), "\\midrule", *cells, "\\bottomrule"]
    body = [f"\\begin{{tabular}}{{{sides}}}", *(f"  {row}" for row in rows), "\\end{tabular}"]
    if len(table.columns) > _MOST_COLUMNS:
        body = ["\\resizebox{\\textwidth}{!}{%", *body, "}"]
    head = [
        "\\centering",
        f"\\caption{{{escaped(captioned.caption)}}}",
        f"\\label{{{captioned.label}}}",
    ]
    return "\n".join(
        ["\\begin{table}[htbp]", *(f"  {line}" for line in [*head, *body]), "\\end{table}", ""]
    )


def escaped(text: str) -> str:
    """Text in which no sign is a command."""
    return "".join(_SIGNS.get(sign, sign) for sign in text)


def _row(cells: tuple) -> str:
    return " & ".join(escaped(str(cell)) for cell in cells) + " \\\\"


def _heads(names: list[str]) -> list[str]:
    """The rows of heads: one, or two if neighbouring columns share the first part of their
    names.
    """
    parts = [name.split(_LEVEL, 1) for name in names]
    groups = [
        (first, len(list(group))) for first, group in itertools.groupby(part[0] for part in parts)
    ]
    if all(count == 1 for _, count in groups):
        return [_row(tuple(names))]
    above, rules, below, column = [], [], [], 1
    for first, count in groups:
        group = [
            part[-1] if count > 1 or len(part) > 1 else part[0]
            for part in parts[column - 1 : column - 1 + count]
        ]
        below += group
        shared = count > 1 or group != [first]
        above.append(f"\\multicolumn{{{count}}}{{c}}{{{escaped(first)}}}" if shared else "")
        rules += [f"\\cmidrule(lr){{{column}-{column + count - 1}}}"] if shared else []
        column += count
    return [" & ".join(above) + " \\\\", "".join(rules), _row(tuple(below))]


def _is_number(column: pd.Series) -> bool:
    """Whether a column of text holds numbers, and empty cells at most."""
    given = column[column != ""]
    return bool(len(given)) and bool(pd.to_numeric(given, errors="coerce").notna().all())
