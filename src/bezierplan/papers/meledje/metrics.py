"""Metrics of meledje alone."""

from bezierplan.analysis.measures import extend_histories
from bezierplan.analysis.metric import Metric, build_count, register

register(
    {
        "objective_best": Metric(
            "u",
            "lowest objective of any generation",
            lambda runs, _: extend_histories(runs).min(axis=1),
        ),
        "near_optimal": build_count(
            "whether the final path is feasible but not optimal, by the planner's own test"
        ),
        "feasible_last": Metric("-", "share of feasible paths in the last population"),
        "made_infeasible": Metric(
            "-", "share of the mutated feasible paths that mutation made infeasible"
        ),
        "node_diversity": Metric(
            "-",
            "mean over generations of the chance that a path's inner node is no node of another",
        ),
        "last_plan": Metric("u", "length of the last plan", least=0.0),
        "last_optimum": Metric(
            "u",
            "least length of a last plan from cell centre to cell centre, from where the robot was",
            least=0.0,
        ),
    }
)
