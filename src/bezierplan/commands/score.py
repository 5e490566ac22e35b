"""Score paths or planners on the problems of a paper, beside the paper's methods."""

from pathlib import Path

import pandas as pd

from bezierplan import api
from bezierplan.analysis import judgement
from bezierplan.analysis.numbers import benchmark
from bezierplan.commands.arguments import OutFile, Settings, check_suffix
from bezierplan.geometry.shortest_paths import shortest_path
from bezierplan.planners import Plan
from bezierplan.running.answer import check_ends
from bezierplan.workspaces.kinds import naming
from bezierplan.workspaces.problem import Problem


def main(
    experiment: str,
    *candidates: str,
    settings: Settings | None = None,
    repeats: int = 20,
    problems: OutFile | None = None,
    out: OutFile | None = None,
    plot: OutFile | None = None,
) -> None:
    """Print a row for each method: runs, share of feasible ones, excess over the exact shortest
    path, evaluations, and the mean rank on a problem. The methods of the papers are not run again.

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
    out : Path, optional
        a csv file for the rows
    plot : Path, optional
        a picture (.svg, .png, .pdf) of the best path of each candidate on each problem, at most 12
        of these

    Examples
    --------
    score song2016/routes --problems routes.csv
    score song2016/routes paths.csv
    score song2016/routes mystudy/walk.py --settings '{tries: 200}' --out scores.csv --plot best.svg
    """
    check_suffix("out", out, [".csv"])
    check_suffix("plot", plot, [".svg", ".png", ".pdf"])
    asked = api.problems(experiment)
    if problems:
        benchmark.describe_problems(asked).to_csv(problems, index=False)
    stored, made = benchmark.read_stored(experiment), {}
    for candidate in candidates:
        # A name of its own: a stored method of the paper may be called the same.
        made[f"here:{candidate}"] = (
            _read(Path(candidate), asked)
            if candidate.endswith(".csv")
            else api._answer([*asked.values()], candidate, repeats, settings or {})
        )
    compared = api.Comparison(made)
    own = benchmark.compute_summaries(compared.runs) if made else stored[:0]
    table = benchmark.rank_methods(pd.concat([stored, own])[stored.columns])
    print(table.to_string(float_format="%.4g"))
    if out:
        table.to_csv(out)
    if plot:
        compared.save(plot)


def _read(file: Path, problems: dict[str, Problem]) -> list[api.Answer]:
    """Judge the paths of a csv file. Raises ValueError for one that does not join the ends of its
    problem.
    """
    answers_read = []
    for name, path, evaluations in benchmark.read_paths(file, problems):
        problem = problems[name]
        with naming(f"{file}: {name}"):
            check_ends(path, problem)
        judged = judgement.compute_judgement(problem, shortest_path(problem), path)
        plan = Plan.of_one(path, 0.0, "read")._replace(evaluations=evaluations)
        answers_read.append(
            api.Answer(**judged, **judgement.list_planner_fields(plan), method=str(file))
        )
    return answers_read
