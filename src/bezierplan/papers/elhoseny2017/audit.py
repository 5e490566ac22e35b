"""elhoseny2017: an audit of its tables and text."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from bezierplan.analysis.audit import rules
from bezierplan.analysis.audit.rows import checked, compared
from bezierplan.geometry.cell_length import DIAGONAL
from bezierplan.papers.elhoseny2017.functions import (
    counts,
    printed_lengths,
    said,
    share_blocked,
    solutions,
)
from bezierplan.planners.parts.diversity import q_statistic
from bezierplan.workspaces.seeds import generator

if TYPE_CHECKING:
    from bezierplan.analysis.claims.kinds.function import Published

# Sets of random fields, without a run, from which the scatter of printed lengths is judged.
DRAWN = 20_000


def audit(published: "Published") -> list[dict]:
    """Printed numbers that contradict the text, other tables or the rule for counting lengths.

    A straight diagonal counts 1.5 cells per cell of the side, the minimum for a path between
    opposite corners; a path that never turns back counts at most 2. Sentences of Section 4.6 are
    checked against the tables: PRM the longest, the proposed method cheaper than all others in all
    cases. Two tables print times for methods of the same name. Section 3.3.1 counts pairs of its
    example, in Section 3.3 eta decreases linearly to 0 and then accepts more, and in Section 2.2.2
    any mutation leaves the subspace of a crossover.
    """
    parts = (rules.audit, _audit_example, _audit_text, _growth, _scatter)
    return [row for part in parts for row in part(published)]


def _audit_example(published: "Published") -> Iterator[dict]:
    printed, genes = said(published), solutions(published)
    in_text = {name: int(printed[f"{name} of S1 and S2"]) for name in ("N11", "N00", "N10", "N01")}
    rule = "the text counts as it defines"
    for name, counted in counts(genes["S1"], genes["S2"]).items():
        yield compared("table1", f"S1, S2: {name}", rule, in_text[name], "==", counted)
    rule, q = "Q of the counts in the text is the printed one", q_statistic(*in_text.values())
    yield compared("table1", "S1, S2: Q", rule, printed["Q of S1 and S2"], "==", q)


def _audit_text(published: "Published") -> Iterator[dict]:
    printed = said(published)
    eta, decay, iterations = printed["eta"], printed["decay of eta"], int(printed["iterations"])
    last = eta * decay**iterations
    rule = f"eta decreases to 0 over the {iterations} iterations"
    yield checked("text", "3.3, 4.2.2", rule, 0.0, round(last, 4), last < 0.005)
    half = eta * (1 - decay ** (iterations // 2)) / (eta - last)
    rule = "eta decreases linearly: half of the way in half of the iterations"
    yield checked("text", "3.3, 4.2.2", rule, 0.5, round(half, 4), abs(half - 0.5) < 0.005)
    rule = (
        "3.3: as eta falls, more similar solutions are accepted, though theirs is a Q of at "
        "most eta: eta after an iteration"
    )
    yield compared("text", "3.3", rule, eta * decay, ">=", eta)
    # A crossover keeps the digits that both parents have.
    digits, shared = int(printed["digits of A"]), int(printed["digits of A that B has too"])
    rule = (
        "2.2.2: a change of any digit of A leaves the subspace of its crossover with B: digits "
        "of which that is true"
    )
    yield compared("text", "2.2.2", rule, digits, "==", shared)
    # A table of drives would say how fast the obstacles are.
    drives = sum(not {"speed", "moment"}.isdisjoint(table) for table in published.values())
    rule = "the title speaks of a dynamic field: some table has obstacles that move"
    yield compared("text", "title", rule, drives, ">=", 1)


def _growth(published: "Published") -> Iterator[dict]:
    """Rows of the audit: do the printed lengths of the proposed method grow with the obstacles as
    the counting rule has it?

    A path counts 1.5 cells for each of the side along a free diagonal, else 2, so a mean says how
    many diagonals were blocked.
    """
    from scipy import stats

    printed, fields = printed_lengths(published), int(published["table2"]["n"].iloc[0])
    blocked = fields * (printed["value"] / printed["side"] - DIAGONAL) / (2 - DIAGONAL)
    whole = int(np.isclose(blocked, blocked.round()).sum())
    blocked_cells, tried = (
        each.groupby(printed["obstacles"]).sum() for each in (blocked, 0 * blocked + fields)
    )
    share = share_blocked(published, blocked_cells.index.to_numpy())
    rule = (
        f"means of {fields} fields, with {DIAGONAL:g} or 2 cells for each of the side: how "
        "many of the printed can be such"
    )
    location = "table2, table3", "method=mga"
    yield compared(*location, rule, whole, "==", len(printed))
    # The radius is fitted to these lengths.
    freedom = len(blocked_cells) - 1
    chi_square, limit = (
        ((blocked_cells - tried * share) ** 2 / (tried * share * (1 - share))).sum(),
        stats.chi2.ppf(0.95, freedom),
    )
    rule = (
        f"lengths grow with the obstacles as diagonals get blocked: chi-square ({freedom} "
        "degrees of freedom) and its limit at 5 %"
    )
    yield checked(*location, rule, round(chi_square, 1), round(limit, 1), bool(chi_square <= limit))


def _scatter(published: "Published") -> Iterator[dict]:
    """A row of the audit: do the printed lengths of the proposed method scatter about straight
    lines along the obstacles as means of so many random fields do?

    In each field the diagonal is free or blocked by chance (`expected_length`), whatever the
    planner; a search that does not converge scatters more.
    """
    printed, fields = printed_lengths(published), int(published["table2"]["n"].iloc[0])
    wide = printed.pivot_table("value", ["side", "route"], "obstacles")
    obstacles = wide.columns.to_numpy(dtype=float)
    blocked = share_blocked(published, obstacles)
    rng = generator("elhoseny2017/audit/scatter")
    drawn = rng.binomial(fields, blocked, (DRAWN, *wide.shape)) / fields
    ours, *sets = scatter(
        np.concatenate([wide.to_numpy()[None], DIAGONAL + (2 - DIAGONAL) * drawn]), obstacles
    )
    p = float(np.mean(np.array(sets) <= ours))
    rule = (
        f"printed lengths scatter about straight lines as means of {fields} random fields do: "
        "standard deviation in % of the mean, and that which one set in 100 undercuts"
    )
    limit = 100 * float(np.quantile(sets, 0.01))
    told = (
        f"{100 * ours:.2g} % printed; sets of random fields {100 * np.median(sets):.2g} %, the "
        f"least of {DRAWN:,} {100 * min(sets):.2g} %; p = {p:.1g}"
    )
    yield checked("table2, table3", "method=mga", rule, 100 * ours, limit, bool(p >= 0.01), told)


def scatter(lengths: np.ndarray, along: np.ndarray) -> np.ndarray:
    """Standard deviation (sets,) of lengths (sets, rows, k) about a straight line along each row,
    as a share of the row's mean.
    """
    line = np.vander(along, 2)
    shares = lengths / lengths.mean(axis=-1, keepdims=True)
    off = shares @ (np.eye(len(along)) - line @ np.linalg.pinv(line))
    freedom = lengths.shape[1] * (len(along) - 2)
    return np.sqrt(np.sum(off**2, axis=(1, 2)) / freedom)
