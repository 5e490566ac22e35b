"""An edit of a study runs again what shows it, and nothing else: any other job stays
the same.
"""

import pytest
from studies import study

from bezierplan.study import jobs


def artefacts(own):
    """The jobs of a study's tables of runs and figures."""
    return {name: jobs.build_figure(own, "full", name) for name in own.figures} | {
        name: jobs.build_table_of_runs(own, "full", name) for name in own.find_tables_of_runs()
    }


@pytest.mark.parametrize(
    ("key", "method", "never", "always"),
    [
        ("ma2020", "bca_q", ("figure1", "figure2", "figure3"), ("figure4", "table1_variants")),
        (
            "tharwat2018",
            "cpso1_gauss",
            [*(f"figure{n}" for n in (2, 3, 4, 5, 9, 10, 11, 12, 14, 15)), "table4", "table5"],
            ("feasibility",),
        ),
    ],
)
def test_a_label_changes_what_shows_it(key, method, never, always):
    own = study(key)
    edited = own.model_copy(update={"labels": own.labels | {method: "another name"}})
    before, after = artefacts(own), artefacts(edited)
    changed = {name for name in before if before[name] != after[name]}
    assert changed.isdisjoint(never)
    assert changed >= {*always}


def test_a_printed_number_changes_what_draws_its_table():
    own = study("elhoseny2017")
    drawn = {
        name
        for name in own.figures
        if any(
            file.endswith("/table6.csv") for file in jobs.build_figure(own, "full", name).sources
        )
    }
    assert drawn == {"figure11", "figure11_fields"}


@pytest.mark.parametrize(
    ("key", "name"),
    [
        *(("elhoseny2017", f"figure{n}") for n in (2, 7, 8, 9)),
        ("ma2020", "figure3"),
        *(("meledje", f"figure{n}") for n in (5, 6)),
    ],
)
def test_a_map_is_drawn_without_a_planner(key, name):
    job = jobs.build_figure(study(key), "full", name)
    assert job.shows == {}
    assert not any("planners" in module for module in job.list_modules())
