"""ma2020: quantities computed from its printed numbers alone, and the claim about curvature."""

import math
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from bezierplan.analysis.claims.material import Untestable
from bezierplan.analysis.results import path_of, pick, select
from bezierplan.geometry import curves
from bezierplan.papers.ma2020.metrics import obstacle_clearance

if TYPE_CHECKING:
    from bezierplan.analysis.claims.kinds.function import Experiments, Judgement, Published
    from bezierplan.analysis.claims.kinds.function import Options as Check

# Number of parameters at which the speed of a curve is sampled, and the share of its maximum below
# which it counts as zero.
SPEED_SAMPLES = 20_001
STILL = 1e-6


def drawn_farther(
    check: "Check", results: "Experiments", published: "Published", *, method: str, other: str
) -> "Judgement":
    """Claim C6: whether the path drawn of one method, its shortest, stays farther from obstacles
    than that drawn of another, on every map.

    The effect is the least excess in clearance, the units are the paths. Raises Untestable if a
    method has no feasible run on a map.
    """
    experiment = results[check.experiment]
    excess = []
    for _, runs in experiment.runs.groupby("problem"):
        drawn = [
            pick(runs[runs["method"] == name], {"lowest": "length"}) for name in (method, other)
        ]
        if any(run is None for run in drawn):
            raise Untestable("a method has no feasible run on a map")
        own, beside = obstacle_clearance(pd.DataFrame(drawn), experiment.problems)
        excess.append(own - beside)
    return "+" if min(excess) > 0 else "-", float(min(excess)), None, 2 * len(excess)


def printed_rise(
    check: "Check", results: "Experiments", published: "Published", *, parameter: str, rise: float
) -> "Judgement":
    """Claim C16: whether a printed parameter rises from environment 1 to environment 2 by as much
    as the text says. The effect is the rise.
    """
    parameters = published["parameters"].set_index("parameter").loc[parameter]
    first, second = parameters.sort_values("workspace")["value"]
    return "+" if math.isclose(second - first, rise) else "-", float(second - first), None, 0


def printed_minima(check: "Check", results: "Experiments", published: "Published") -> "Judgement":
    """Claim C18: whether every shortest length in the text is that in Table 1 or 2. The effect is
    the largest difference, the units are the lengths.
    """
    quoted, *tables = (
        published[name]
        .query("metric == 'length' and statistic == 'min'")
        .set_index(["workspace", "method"])["value"]
        for name in ("text_numbers", "table1", "table2")
    )
    apart = (quoted - pd.concat(tables).reindex(quoted.index)).abs()
    return "+" if (apart == 0).all() else "-", float(apart.max()), None, len(quoted)


def continuous_curvature(
    check: "Check", results: "Experiments", published: "Published"
) -> "Judgement":
    """Claim C20: whether every feasible path is one polynomial piece with non-zero speed
    everywhere, so that its curvature is continuous.

    The effect is the largest jump of curvature at the joints of pieces; a path of one piece has no
    joints.
    """
    runs = select(results[check.experiment].runs, check.where)
    paths = [path_of(run) for _, run in runs[runs["feasible"].astype(bool)].iterrows()]
    jump = max((curves.curvature_jump(path) for path in paths), default=math.nan)
    moving = all(_least_speed(curves.bezier_pieces(path)) > STILL for path in paths)
    return "+" if paths and jump == 0 and moving else "-" if paths else "?", jump, None, len(paths)


def _least_speed(pieces: np.ndarray) -> float:
    """Least speed of Bézier pieces (n, degree + 1, 2) as a share of the greatest."""
    weights = curves.bernstein(pieces.shape[1] - 2, np.linspace(0, 1, SPEED_SAMPLES))
    speed = np.hypot(*np.moveaxis(weights @ np.diff(pieces, axis=1), -1, 0))
    return float(speed.min() / speed.max())


def side_of_maps(published: "Published") -> int:
    """Cells of both maps along x and along y, as printed: those from start to target."""
    parameters = published["parameters"]
    (side,) = parameters.loc[parameters["parameter"] == "grid_size", "value"].unique()
    return int(side)
