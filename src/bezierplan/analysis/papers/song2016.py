"""song2016: the claim about its genetic operators, an audit of its Table I, and the paths whose
lengths its table prints.
"""

from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
import shapely

from bezierplan.analysis import identified
from bezierplan.analysis.audit_rows import compared
from bezierplan.analysis.papers.marks import along, mark, text
from bezierplan.planners.parts.genetic import complement_bit, swap_tails
from bezierplan.workspaces.grid import Grid
from bezierplan.workspaces.problem import Problem
from bezierplan.workspaces.seeds import generator

if TYPE_CHECKING:
    from bezierplan.analysis.claims.kinds.function import Experiments, Judged, Published
    from bezierplan.analysis.claims.kinds.function import Options as Check

TRIALS = 10_000


def genes_in_range(
    check: "Check", results: "Experiments", published: "Published", *, bits: int, genes: int
) -> "Judged":
    """Claim C8: genes outside 0 .. 2^bits - 1 after a crossover at every kind of cut and a mutation
    at any bit, in random chromosomes.
    """
    rng = generator("song2016/C8")
    outside = 0
    for _ in range(TRIALS):
        one, other = rng.integers(0, 1 << bits, (2, genes))
        swap_tails(one, other, rng.integers(1, bits * genes), bits)
        complement_bit(one, rng.integers(0, bits * genes), bits)
        outside += int(
            ((one < 0) | (one >= 1 << bits)).sum() + ((other < 0) | (other >= 1 << bits)).sum()
        )
    return "-" if outside else "+", float(outside), None, TRIALS


def audit(published: "Published") -> list[dict]:
    """Whether every minimal generation of Table I lies within the generations of Section IV."""
    table = published["table1"]
    most = published["text_values"].set_index("quantity")["value"]["generations"]
    rule = "a minimal generation is at most the number of generations"
    return [
        compared(
            "table1", f"problem={cell.problem}, method={cell.method}", rule, cell.value, "<=", most
        )
        for cell in table[table["metric"] == "generation_1pct"].itertuples()
    ]


def identified_paths(
    workspace: Grid,
    published: "Published",
    *,
    start: int,
    target: int,
    method: str,
    decimals: int,
    edges: int,
) -> pd.DataFrame:
    """Marks of the free polylines of fewest edges between two cells whose length is the objective
    that Table I prints of a method.

    decimals: of the printed number. edges: the most of a polyline. Raises ValueError if the table
    prints no such number.
    """
    table = published["table1"]
    printed = table[
        (table["problem"] == f"{start}_{target}")
        & (table["method"] == method)
        & (table["metric"] == "objective")
    ]
    if len(printed) != 1:
        raise ValueError(
            f"identified_paths: {len(printed)} printed numbers of {method} from {start} to "
            f"{target}; expected one"
        )
    problem = Problem("", workspace, workspace.centre(start), workspace.centre(target))
    identification = identified.in_problem(
        problem, float(printed["value"].iloc[0]), decimals, edges
    )
    marks = []
    for number, path in reversed(list(enumerate(identification.paths))):
        role = ("accent", "first", "third")[min(number, 2)]
        name = f"{' '.join(map(str, path))}: length {identification.length * workspace.cell:.6f}"
        places = map(workspace.centre, path)
        marks += along("line", role, places, group=f"path {number}", label=name)
    lines = shapely.MultiLineString(
        [[workspace.centre(cell) for cell in path] for path in identification.paths]
    )
    away = 0.85 * workspace.cell
    marks += [
        text(*_beside(workspace.centre(cell), lines, away), cell)
        for path in identification.paths[:1]
        for cell in path[1:-1]
    ]
    for role, cell in (("start", start), ("target", target)):
        marks.append(mark("dots", role, *workspace.centre(cell), label=role))
    return pd.DataFrame(marks)


def _beside(
    point: tuple[float, float], lines: shapely.Geometry, away: float
) -> tuple[float, float]:
    """Of the places around a point, a distance away, the one that is farthest from lines; the first
    from the top of equal ones.
    """
    around = [
        (point[0] + away * np.sin(angle), point[1] + away * np.cos(angle))
        for angle in np.linspace(0, 2 * np.pi, 8, endpoint=False)
    ]
    return max(around, key=lambda place: round(lines.distance(shapely.Point(place)), 6))
