"""song2016: the claim about its genetic operators, and an audit of its Table I."""

import numpy as np
import pandas as pd

from bezierplan.analysis.results import Results
from bezierplan.planners.parts.genetic import complement_bit, swap_tails

BITS = 8  # of a cell number of 16 x 16 cells (Section III-C)
GENES = 6
TRIALS = 10_000
GENERATIONS = 100  # Section IV


def genes_in_range(
    check: dict, results: dict[str, Results], published: dict[str, pd.DataFrame]
) -> tuple[str, float, tuple[float, float] | None, int]:
    """Claim C8: genes outside 0 .. 255 after a crossover at every kind of cut and a mutation at any bit, in random chromosomes."""
    rng = np.random.default_rng(0)
    outside = 0
    for _ in range(TRIALS):
        one, other = rng.integers(0, 1 << BITS, (2, GENES))
        swap_tails(one, other, rng.integers(1, BITS * GENES), BITS)
        complement_bit(one, rng.integers(0, BITS * GENES), BITS)
        outside += int(((one < 0) | (one >= 1 << BITS)).sum() + ((other < 0) | (other >= 1 << BITS)).sum())
    return "-" if outside else "+", float(outside), None, TRIALS


def audit(published: dict[str, pd.DataFrame]) -> list[dict]:
    """Whether every minimal generation of Table I lies within the generations of Section IV."""
    table = published["table1"]
    rows = table[table["metric"] == "generation_1pct"]
    return [
        {
            "item": "table1",
            "place": f"problem={row.problem}, method={row.method}",
            "rule": "a minimal generation is at most the number of generations",
            "printed": row.value,
            "limit": GENERATIONS,
            "consistent": row.value <= GENERATIONS,
        }
        for row in rows.itertuples()
    ]
