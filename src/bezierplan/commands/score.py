"""Score paths or planners on the problems of a paper, beside the paper's methods."""

from pathlib import Path
from typing import Any

import pandas as pd

from bezierplan import api
from bezierplan.analysis.numbers import benchmark
from bezierplan.commands.arguments import Settings
from bezierplan.running import problems as problem_files
from bezierplan.running.guard import contract, interface
from bezierplan.running.guard.worker import Reply
from bezierplan.workspaces.problem import Problem


def main(
    experiment: str,
    *candidates: str,
    settings: Settings | None = None,
    repeats: int = 20,
    problems: Path | None = None,
) -> None:
    """Print a row for each method: runs, share of feasible ones, excess over the exact shortest
    path, evaluations, and the mean rank on a problem. Those of the papers are not run again.

    Parameters
    ----------
    experiment : str
        one of a study, such as song2016/routes
    *candidates : str
        csv files of paths, with the columns problem, curve, points (x y x y ...) and perhaps
        evaluations; or planners: names, files or STUDY/METHOD
    settings : dict
        settings of the planners in place of their own
    repeats : int
        runs of a planner on each problem
    problems : Path, optional
        a csv file for the problems: ends, bound, map

    Examples
    --------
    score song2016/routes --problems routes.csv
    score song2016/routes paths.csv
    score song2016/routes mystudy/walk.py --settings '{tries: 200}'
    """
    asked = api.problems(experiment)
    if problems:
        benchmark.problem_rows(asked).to_csv(problems, index=False)
    tables = [benchmark.stored(experiment)]
    for candidate in candidates:
        if candidate.endswith(".csv"):
            paths = benchmark.read_paths(Path(candidate), asked)
            runs = [benchmark.run(asked[name], *row) for name, *row in paths]
        else:
            made = _planned(candidate, asked, settings or {}, repeats)
            runs = [
                benchmark.run(asked[name], each.result.path, each.result.evaluations)
                for name, replies in made.items()
                for each in replies
            ]
        tables.append(benchmark.summaries(pd.DataFrame(runs).assign(method=f"here:{candidate}")))
    print(benchmark.scores(pd.concat(tables)).to_string(float_format="%.4g"))


def _planned(
    method: str, problems: dict[str, Problem], settings: dict[str, Any], repeats: int
) -> dict[str, list[Reply]]:
    """What a planner answers to problems, by name; one in a file is started once for all. Raises
    ValueError for a wrong setting, and PlannerFailure.
    """
    planner, preset = api.named(method)
    module, settings = interface.loaded(planner, f"method: {method}"), preset | settings
    kinds = getattr(module, "workspaces", None)
    suited = {name: problem_files.placed(each, kinds) for name, each in problems.items()}
    for each in suited.values():
        api.check_settings(method, module, settings, each)
    return contract.replies(planner, settings, suited, range(repeats))
