"""song2016: the claim about its genetic operators, and an audit of its Table I."""

import numpy as np
import pandas as pd

from bezierplan.analysis.results import Results
from bezierplan.planners.parts.genetic import complement_bit, swap_tails

TRIALS = 10_000


def genes_in_range(
    check: dict, results: dict[str, Results], published: dict[str, pd.DataFrame], *, bits: int, genes: int
) -> tuple[str, float, tuple[float, float] | None, int]:
    """Claim C8: genes outside 0 .. 2^bits - 1 after a crossover at every kind of cut and a mutation at any bit, in random chromosomes."""
    rng = np.random.default_rng(0)
    outside = 0
    for _ in range(TRIALS):
        one, other = rng.integers(0, 1 << bits, (2, genes))
        swap_tails(one, other, rng.integers(1, bits * genes), bits)
        complement_bit(one, rng.integers(0, bits * genes), bits)
        outside += int(((one < 0) | (one >= 1 << bits)).sum() + ((other < 0) | (other >= 1 << bits)).sum())
    return "-" if outside else "+", float(outside), None, TRIALS


def audit(published: dict[str, pd.DataFrame]) -> list[dict]:
    """Whether every minimal generation of Table I lies within the generations of Section IV."""
    table = published["table1"]
    rows = table[table["metric"] == "generation_1pct"]
    said = published["text_values"].set_index("quantity")["value"]
    return [
        {
            "item": "table1",
            "place": f"problem={row.problem}, method={row.method}",
            "rule": "a minimal generation is at most the number of generations",
            "printed": row.value,
            "limit": said["generations"],
            "consistent": row.value <= said["generations"],
        }
        for row in rows.itertuples()
    ]
