"""Repeat one run, given its name."""

from collections.abc import Mapping

import pandas as pd

from bezierplan.analysis import results
from bezierplan.running import execution, problems
from bezierplan.running.jobs.watchdog import PlannerFailure
from bezierplan.schema.checked import Fault, check_known
from bezierplan.study.experiments import Experiments, build_problems_job
from bezierplan.study.jobs import build_chunk


def replay(name: str, studies: Mapping[str, Experiments]) -> results.Results:
    """Repeat the run named `study/experiment/condition/method/repeat`; return one row with its
    problem and bound.

    Raises Fault, naming the unknown part of the name.
    """
    parts = name.split("/")
    if len(parts) != 5:
        raise Fault(
            f"{name}: not the name of a run; expected study/experiment/condition/method/repeat, "
            "such as song2016/routes/15_240/smooth/2"
        )
    key, experiment, condition_name, method, repeat = parts
    check_known(key, studies, f"{name}: study")
    study = studies[key]
    check_known(experiment, study.experiments, f"{name}: experiment")
    check_known(method, study.methods_of(experiment), f"{name}: method")
    # Neither the seed nor the settings of a run depend on scale or chunk.
    chunk = build_chunk(study, experiment, method, "full", 0)
    conditions = {each.name: each for each in chunk.conditions()}
    check_known(condition_name, conditions, f"{name}: condition")
    condition = conditions[condition_name]
    if not repeat.isdecimal():
        raise Fault(f"{name}: repeat: {repeat}; expected a whole number")

    made, moving = problems.build_all(build_problems_job(study, experiment, "full"), study.folder)
    problem = condition.problem
    # Only drives have worlds.
    named, met = ({problem: of[problem]} if of else {} for of in (made, moving))
    try:
        rows = execution.make_rows_again(chunk, [(condition, int(repeat))], named, met)
    except PlannerFailure as error:
        raise Fault(str(error)) from None
    bounds = problems.compute_bounds(named, met).to_pandas()
    joined = results.join_bounds(pd.DataFrame(rows), named, bounds)
    return joined._replace(worlds=met, jobs={method: chunk})
