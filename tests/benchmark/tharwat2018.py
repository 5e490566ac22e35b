"""The chaotic swarm: evaluations a second, and what a run costs around its compiled call."""

import numpy as np
from timing import cpu_seconds

from bezierplan.planners import chaotic_pso
from bezierplan.study import reading
from bezierplan.workspaces import files
from bezierplan.workspaces.problem import Problem


def benchmark_chaotic_pso() -> None:
    """Methods of tharwat2018 among its three circles, without the early stop; runs of one
    evaluation show what lies around the search.
    """
    study = reading.load(reading.read_config({"studies": ["tharwat2018"]}))["tharwat2018"]
    circles = files.load(study.workspaces["equal"].plain(), study.folder)
    problem = Problem("equal", circles, (0.0, 0.0), (4.0, 6.0))
    runs = 200

    def seconds_of_runs(settings: dict) -> float:
        return cpu_seconds(
            lambda: [
                chaotic_pso.plan(problem, np.random.default_rng(seed), **settings)
                for seed in range(runs)
            ]
        )

    print(
        f"\n{'chaotic_pso':18}{'evaluations/s':>16}{'ms a run':>12}{'of it around the search':>26}"
    )
    for method in ("pso", "cpso1_singer", "cpso2_singer"):
        settings = study.resolved(method) | {"stall_limit": 0}
        evaluations = runs * settings["particles"] * (settings["iterations"] + 1)
        seconds, least = (
            seconds_of_runs(settings),
            seconds_of_runs(settings | {"particles": 1, "iterations": 0}),
        )
        print(
            f"  {method:16}{evaluations / seconds:16,.0f}{1000 * seconds / runs:12.2f}"
            f"{1000 * least / runs:26.2f}"
        )
