"""Columns of runs are declared once: rows, files, what is read and the tables in results/README.md
follow.
"""

import numpy as np
import pyarrow as pa
import pytest
import tables_of_keys as keys
from chunks import CHUNK, MADE

from bezierplan.analysis import columns as result_columns
from bezierplan.planners import PLACE
from bezierplan.running import columns, execution, problems, table_files

BLOCKED = {"blocked": MADE["blocked"]}


def test_tables_of_columns_are_those_of_the_declarations():
    """`python docs/tables_of_keys.py` renews them."""
    text = keys.RESULTS_README.read_text(encoding="utf-8")
    assert keys.update(text) == text
    assert all(
        f"<!-- columns of {name} -->" in text and f"<!-- columns of {name} of drives -->" in text
        for name in columns.TABLES
    )
    assert all(f"<!-- columns of {name} -->" in text for name in result_columns.TABLES)


def test_a_row_has_the_declared_columns_and_no_other():
    runs, times = execution.run_chunk(
        BLOCKED, CHUNK._replace(problems={"blocked": {"workspace": "field", "layout": 1}})
    )
    assert set(runs.column_names) == {*columns.PLANNED, *columns.RESULTS, "layout"}
    assert "layout" in PLACE
    made = {"runs": runs, "times": times, "bounds": problems.compute_bounds(BLOCKED, {})}
    for kind, table in made.items():
        assert table_files.find_fault(table.schema, *columns.TABLES[kind].every) == ""


ROW = {"id": "a", "cpu_s": 1.0, "wall_s": 2.0}


def test_a_table_has_declared_types_whatever_its_values():
    """Without a path, points are an empty list, and whole seconds are no integers."""
    table = table_files.build_table([ROW | {"cpu_s": 1, "setting": 3}, ROW], columns.Times)
    assert [str(each.type) for each in table.schema] == ["string", "double", "double", "int64"]
    empty = columns.Bound("a", 1.0, np.inf, np.inf, [], np.nan)._asdict()
    assert table_files.build_table([empty], columns.Bound).schema.field(
        "bound_path"
    ).type == pa.list_(pa.float64())


def test_a_table_without_a_declared_column_or_with_another_type_is_refused():
    with pytest.raises(KeyError, match="wall_s"):
        table_files.build_table([ROW, {"id": "b", "cpu_s": 1.0}], columns.Times)
    with pytest.raises((pa.ArrowInvalid, pa.ArrowTypeError)):
        table_files.build_table([ROW | {"cpu_s": "fast"}], columns.Times)


def test_a_digest_does_not_depend_on_the_type_of_no_values():
    """Files of version 1.0.0 hold lists of nothing where no run has a path."""
    untyped = pa.table({"path_points": [[], []]})
    assert table_files.compute_digest(untyped) == table_files.compute_digest(
        untyped.cast(pa.schema({"path_points": pa.list_(pa.float64())}))
    )


def test_every_column_says_what_it_means():
    for kind in columns.TABLES.values():
        for _, about in columns.read_columns(*kind.every, kind.drives).values():
            assert about.meaning
            assert about.unit in ("", "units", "steps", "s")
    for tables in result_columns.TABLES.values():
        assert all(about.meaning for _, about in columns.read_columns(*tables).values())
