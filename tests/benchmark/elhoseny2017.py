"""Planners in random fields, small and large."""

import itertools

import numpy as np
from timing import cpu_seconds

from bezierplan.planners import planner_module
from bezierplan.study import reading
from bezierplan.workspaces import random_field
from bezierplan.workspaces.problem import Problem


def benchmark_fields() -> None:
    """Methods of elhoseny2017 from corner to corner of its fields with 15 obstacles, small and
    large ones.
    """
    study = reading.load(reading.read_config({"studies": ["elhoseny2017"]}))["elhoseny2017"]
    runs = 10
    print(f"\n{'random fields':16}{'evaluations/s':>16}{'ms a run':>12}{'side':>8}  obstacles")
    for side, home in itertools.product((100, 200), ("published_like", "dense")):
        described = {"side": side, "start": (0, 0), "target": (side, side), "obstacles": 15}
        fields = [
            random_field.field(study.workspaces[home].plain(), described | {"layout": i}, home)
            for i in range(runs)
        ]
        problems = [Problem(home, grid, (0.0, 0.0), (float(side), float(side))) for grid in fields]
        for method in study.experiments["fields100"].methods:
            planner, settings = planner_module(study.planner(method)), study.resolved(method)
            plans = [planner.plan(each, np.random.default_rng(0), **settings) for each in problems]
            seconds = cpu_seconds(
                lambda: [
                    planner.plan(each, np.random.default_rng(0), **settings)  # noqa: B023
                    for each in problems  # noqa: B023
                ]
            )
            rate = f"{sum(each.evaluations for each in plans) / seconds:16,.0f}"
            print(f"  {method:14}{rate}{1000 * seconds / runs:12.2f}{side:8}  {home}")
