"""Columns of the tables of claims, each declared once, as a line of columns.csv next to this file:
what its values are and its meaning. The order of columns in the files, and the tables in
results/README.md (`python docs/tables_of_keys.py`), follow.

`Named`: which claim, under which values. `Sentence`: what it says, and what became of it.
`Compared`: what a comparison compares, and its marks. `Effect`: what it finds; in the table of
claims that of the decisive one. `Judged`: how sure a claim's verdict is, and what shows it.
`Limits`: what a comparison could find, and the printed numbers. `Notes`: what a reader should know.
"""

from bezierplan.running.columns import read_columns, read_tables

Named, Sentence, Compared, Effect, Judged, Limits, Notes = read_tables(__file__)

TABLES = {
    "claims": (Named, Sentence, Effect, Judged, Notes),
    "claim_checks": (Named, Compared, Effect, Limits, Notes),
}
"""Name of a table -> what declares its columns, in their order."""

CLAIM_COLUMNS, CHECK_COLUMNS = (list(read_columns(*names)) for names in TABLES.values())
