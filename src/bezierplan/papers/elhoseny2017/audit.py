"""elhoseny2017: an audit of its tables and text."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

from bezierplan.analysis.audit import rules
from bezierplan.analysis.audit.rows import build_audit_row, compare_with_limit
from bezierplan.papers.elhoseny2017.functions import count_pairs, read_solutions, read_text_values
from bezierplan.planners.parts.diversity import compute_q_statistic

if TYPE_CHECKING:
    from bezierplan.analysis.claims.kinds.function import Published


def audit(published: "Published") -> list[dict]:
    """List printed numbers that contradict the text, other tables or the rule for counting lengths.

    A straight diagonal counts 1.5 cells per cell of the side, the minimum for a path between
    opposite corners; a path that never turns back counts at most 2. Sentences of Section 4.6 are
    checked against the tables: PRM the longest, the proposed method cheaper than all others in all
    cases. Two tables print times for methods of the same name. Section 3.3.1 counts pairs of its
    example, in Section 3.3 eta decreases linearly to 0 and then accepts more, and in Section 2.2.2
    any mutation leaves the subspace of a crossover.
    """
    parts = (rules.check_rules, _audit_example, _audit_text)
    return [row for part in parts for row in part(published)]


def _audit_example(published: "Published") -> Iterator[dict]:
    """List rows about the worked example of Q (Section 3.3.1)."""
    printed, genes = read_text_values(published), read_solutions(published)
    in_text = {name: int(printed[f"{name} of S1 and S2"]) for name in ("N11", "N00", "N10", "N01")}
    rule = "the text counts as it defines"
    for name, counted in count_pairs(genes["S1"], genes["S2"]).items():
        yield compare_with_limit("table1", f"S1, S2: {name}", rule, in_text[name], "==", counted)
    rule, q = (
        "Q of the counts in the text is the printed one",
        compute_q_statistic(*in_text.values()),
    )
    yield compare_with_limit("table1", "S1, S2: Q", rule, printed["Q of S1 and S2"], "==", q)


def _audit_text(published: "Published") -> Iterator[dict]:
    """List rows about sentences on eta, on crossovers and on obstacles that move."""
    printed = read_text_values(published)
    eta, decay, iterations = printed["eta"], printed["decay of eta"], int(printed["iterations"])
    # Eta decays by a factor, which the text calls linear.
    last = eta * decay**iterations
    rule = f"eta decreases to 0 over the {iterations} iterations"
    yield build_audit_row("text", "3.3, 4.2.2", rule, 0.0, round(last, 4), last < 0.005)
    half = eta * (1 - decay ** (iterations // 2)) / (eta - last)
    rule = "eta decreases linearly: half of the way in half of the iterations"
    yield build_audit_row("text", "3.3, 4.2.2", rule, 0.5, round(half, 4), abs(half - 0.5) < 0.005)
    rule = (
        "3.3: as eta falls, more similar solutions are accepted, though theirs is a Q of at "
        "most eta: eta after an iteration"
    )
    yield compare_with_limit("text", "3.3", rule, eta * decay, ">=", eta)
    # A crossover keeps the digits that both parents have.
    digits, shared = int(printed["digits of A"]), int(printed["digits of A that B has too"])
    rule = (
        "2.2.2: a change of any digit of A leaves the subspace of its crossover with B: digits "
        "of which that is true"
    )
    yield compare_with_limit("text", "2.2.2", rule, digits, "==", shared)
    # A table of drives would say how fast the obstacles are.
    drives = sum(not {"speed", "moment"}.isdisjoint(table) for table in published.values())
    rule = "the title speaks of a dynamic field: some table has obstacles that move"
    yield compare_with_limit("text", "title", rule, drives, ">=", 1)
