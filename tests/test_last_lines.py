"""The last lines of a workflow: where the results are, how long it took, and the page."""

from pathlib import Path

import pytest

import snakemake_logger_plugin_bezierplan as plugin

ROUTE, PAGE = Path("results/full/song2016/runs/routes/0.parquet"), Path("results/full/index.html")


def test_the_last_line_names_the_page(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert plugin.list_last_lines({ROUTE}, 203.77) == [
        "Results: results/full/song2016",
        "Time: 0:03:24",
    ]
    PAGE.parent.mkdir(parents=True)
    PAGE.write_text('<p class="headline">Of 3 numbers 2 fit the paper&#39;s.</p>')
    assert plugin.list_last_lines({ROUTE}, 9, 481.6)[-1] == "Time: 0:00:09, CPU: 482 s"
    page = f"Open {PAGE} in a browser: file://{tmp_path / PAGE}"
    made = {PAGE, *(ROUTE.with_name(name) for name in ("a.tex", "b.tex", "c.svg", "c.png"))}
    assert plugin.list_last_lines(made, 1) == [
        "Made: 2 tables, 1 figure, 1 page",
        "Results: results/full, results/full/song2016",
        "Time: 0:00:01",
        f"Figure: {ROUTE.with_name('c.svg')}",
        "Of 3 numbers 2 fit the paper's.",
        page,
    ]


@pytest.mark.parametrize(
    ("message", "reason"),
    [
        (
            "No rule to produce song2016_figure44 (if you use input functions make sure that",
            "song2016_figure44: no target; did you mean song2016_figure4? known: all, ",
        ),
        ("something else", ""),
    ],
)
def test_a_mistyped_target_gets_the_nearest_name(message, reason, monkeypatch):
    monkeypatch.setattr(plugin, "KNOWN", {"all", "song2016_figure4"})
    answer = plugin.describe_unknown_target(message)
    assert answer.startswith(reason)
    assert bool(answer) == bool(reason)
