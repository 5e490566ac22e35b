"""Columns of the tables of results, each declared once, as a line of columns.csv next to this file:
what its values are and its meaning. The order of columns in the files, and the tables in
results/README.md (`python docs/tables_of_keys.py`), follow.

Of claims, `Named` says which claim, under which values. `Sentence`: what it says, and what became
of it. `Compared`: what a comparison compares, and its marks. `Effect`: what it finds; in the table
of claims that of the decisive one. `Judged`: how sure a claim's verdict is, and what shows it.
`Limits`: what a comparison could find, and the printed numbers. `Notes`: what a reader should know.
"""

from bezierplan.running.columns import read_columns, read_tables

_NAMED, _SENTENCE, _COMPARED, _EFFECT, _JUDGED, _LIMITS, _NOTES, *_OTHERS = read_tables(__file__)

TABLES = {
    "claims": (_NAMED, _SENTENCE, _EFFECT, _JUDGED, _NOTES),
    "claim_checks": (_NAMED, _COMPARED, _EFFECT, _LIMITS, _NOTES),
} | {each.__name__: (each,) for each in _OTHERS}
"""Name of a table -> what declares its columns, in their order."""

COLUMNS_OF = {table: [*read_columns(*parts)] for table, parts in TABLES.items()}
"""Name of a table -> its columns; those of a comparison stand right of its keys."""
