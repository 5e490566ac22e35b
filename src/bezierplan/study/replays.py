"""One run again, from its name alone."""

import pandas as pd

from bezierplan.analysis import results
from bezierplan.geometry.region import region
from bezierplan.running import execution, problems, rides, worlds
from bezierplan.running.chunk import Chunk, Condition
from bezierplan.running.jobs.watchdog import PlannerFailure
from bezierplan.schema.checked import Fault, check_known
from bezierplan.study.definition import Study
from bezierplan.study.jobs import job, problems_job


def replay(name: str, studies: dict[str, Study]) -> results.Results:
    """Reproduce the run named `study/experiment/condition/method/repeat`: one row, with its problem
    and bound.

    Raises Fault, which states the unknown part of the name.
    """
    parts = name.split("/")
    if len(parts) != 5:
        raise Fault(
            f"{name}: not the name of a run; expected study/experiment/condition/method/repeat, "
            "such as song2016/routes/15_240/smooth/3"
        )
    key, experiment, condition_name, method, repeat = parts
    check_known(key, studies, f"{name}: study")
    study = studies[key]
    check_known(experiment, study.experiments, f"{name}: experiment")
    check_known(method, study.methods_of(experiment), f"{name}: method")
    # Neither the seed nor the settings of a run depend on scale or chunk.
    chunk = job(study, experiment, method, "full", 0)
    conditions = {each.name: each for each in chunk.conditions()}
    check_known(condition_name, conditions, f"{name}: condition")
    condition = conditions[condition_name]
    if not repeat.isdecimal():
        raise Fault(f"{name}: repeat: {repeat}; expected a whole number")

    again = _redriven if study.moves(experiment) else _rerun
    try:
        return again(chunk, condition, int(repeat), study)
    except PlannerFailure as error:
        raise Fault(str(error)) from None


def _rerun(chunk: Chunk, condition: Condition, repeat: int, study: Study) -> results.Results:
    """A run where nothing moves."""
    made = problems.build_all(problems_job(study, chunk.experiment, "full"), study.folder)
    problem = made[condition.problem]
    named = {condition.problem: problem}
    plan = execution.run(chunk, condition, repeat, problem)
    row = execution.row(chunk, condition, repeat, plan, problem, region(problem.workspace))
    return results.joined(pd.DataFrame([row]), named, problems.bounds_of(named).to_pandas())


def _redriven(chunk: Chunk, condition: Condition, repeat: int, study: Study) -> results.Results:
    """A run in a world that moves."""
    made, found = worlds.build_all(problems_job(study, chunk.experiment, "full"), study.folder)
    problem, world = made[condition.problem], found[condition.problem]
    named, moving = {condition.problem: problem}, {condition.problem: world}
    ((ride, *_),) = rides.run(chunk, [(condition, repeat)], named, moving)
    row, _ = rides.row(chunk, condition, repeat, ride, problem, world)
    joined = results.joined(pd.DataFrame([row]), named, rides.bounds_of(named, moving).to_pandas())
    return joined._replace(worlds=moving, jobs={chunk.method: chunk})
