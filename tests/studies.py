"""The studies of the project, read once per process. `test_studies.py` checks that each of them is
free of faults.
"""

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from bezierplan.analysis import drawings, results
from bezierplan.planners import Plan, load_planner
from bezierplan.running import problems
from bezierplan.study import loading
from bezierplan.study.definition import Study
from bezierplan.study.jobs import build_problems_job
from bezierplan.workspaces import files
from bezierplan.workspaces.problem import Problem

FOLDER = Path(__file__).parents[1] / "config" / "studies"
KEYS = ("song2016", "elhoseny2017", "tharwat2018", "ma2020", "meledje")


@cache
def study(key: str) -> Study:
    """A study, without the checks across its files, which take seconds. Tests share it, so none may
    change it.
    """
    loading._load_code(FOLDER / key)
    own, faults, _ = loading._read(FOLDER / key, {})
    assert not faults
    return own


def studies() -> dict[str, Study]:
    """All of them, by name."""
    return {key: study(key) for key in KEYS}


def arguments(key: str, function: str) -> dict[str, Any]:
    """The arguments that a study gives a function of its module, in the first place that names
    it.
    """
    own = study(key)
    panels = [panel for figure in own.figures.values() for panel in figure.panels]
    checks = [check for claim in own.claims for check in claim.checks]
    for each in (*own.tables.values(), *panels, *checks):
        if function in (getattr(each, key, None) for key in ("function", "data", "name")):
            return each.arguments
    raise KeyError(function)


@cache
def published(key: str) -> dict[str, pd.DataFrame]:
    """The published numbers of a study, by table. Tests share them, so none may change them."""
    files = sorted((FOLDER / key / "published").glob("*.csv"))
    return {file.stem: pd.read_csv(file) for file in files}


def drawing(key: str, name: str) -> pd.DataFrame:
    """The marks of a drawing of a study, from its file."""
    file = FOLDER / key / "published" / f"{name}.csv"
    return drawings.list_marks({name: results.read_published_table(file)})


def built(study: Study, experiment: str, name: str) -> Problem:
    """A problem of an experiment, without the others."""
    every = build_problems_job(study, experiment, "smoke")
    alone = every.problems[name]
    home = alone["workspace"]
    described = every._replace(problems={name: alone}, workspaces={home: every.workspaces[home]})
    return problems.build_all(described, study.folder)[0][name]


def problem_of(key: str, name: str) -> Problem:
    """A problem of a study in a workspace that is neither drawn nor moves."""
    own, described = study(key), study(key).problems[name]
    home = files.load(own.workspaces[described.workspace].plain(), own.folder)
    return problems.build(name, described.plain(), home)


def planned(key: str, method: str, problem: Problem, seed: int = 0, **changes: Any) -> Plan:
    """The plan of a method of a study, with its settings but for some changes."""
    own = study(key)
    settings = own.resolve_settings(method) | changes
    return load_planner(own.planner(method)).plan(problem, np.random.default_rng(seed), **settings)
