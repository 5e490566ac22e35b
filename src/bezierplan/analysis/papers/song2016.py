"""song2016: the claim about its genetic operators, an audit of its Table I, and the paths whose
lengths its table prints.
"""

from typing import TYPE_CHECKING

from bezierplan.analysis.papers.drawings import marks as marks
from bezierplan.analysis.papers.rules import audit as audit
from bezierplan.planners.parts.genetic import complement_bit, swap_tails
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
