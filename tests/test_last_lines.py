"""The last lines of a workflow: where the results are, how long it took, what came out, and the
page.
"""

import io
import time

from rich.console import Console

from snakemake_logger_plugin_bezierplan import LogHandler, headline, unknown_target

SUMMARY = (
    "# Outcome at scale full\n\n**Of 3 published numbers, 1 agrees. Of 2 claims, 2 are "
    "supported.**\n\n**Other** words\n"
)


def last_lines(folders, pages):
    handler = LogHandler.__new__(LogHandler)
    handler.console, handler.started = (
        Console(file=io.StringIO(), width=200),
        time.monotonic() - 203.77,
    )
    handler.folders, handler.pages = set(folders), set(pages)
    handler.show_end()
    return handler.console.file.getvalue().splitlines()


def test_the_last_line_names_the_page_after_what_came_out(tmp_path):
    (tmp_path / "summary.md").write_text(SUMMARY, encoding="utf-8")
    page = tmp_path / "index.html"
    assert last_lines(["results/full"], [page]) == [
        "Results: results/full",
        "Time: 0:03:24",
        "Of 3 published numbers, 1 agrees.",
        "Of 2 claims, 2 are supported.",
        f"Open {page} in a browser: file://{page}",
    ]


def test_without_a_page_or_a_summary_nothing_is_said_of_them(tmp_path):
    assert last_lines(["results/full/song2016"], []) == [
        "Results: results/full/song2016",
        "Time: 0:03:24",
    ]
    assert headline(tmp_path) == []


def test_mistyped_target_is_told_with_the_nearest_name(monkeypatch):
    monkeypatch.setattr("snakemake_logger_plugin_bezierplan.KNOWN", {"all", "song2016_figure4"})
    told = unknown_target(
        "No rule to produce song2016_figure44 (if you use input functions make sure that they "
        "don't raise exceptions)."
    )
    assert told.startswith(
        "song2016_figure44: no target; did you mean song2016_figure4? known: all, "
    )
    assert unknown_target("No rule to produce results/full/x.csv (if").startswith(
        "results/full/x.csv: no rule makes this file; "
    )
    assert unknown_target("something else") == ""
