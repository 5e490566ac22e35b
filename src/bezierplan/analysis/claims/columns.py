"""Columns of the tables of claims, each declared once, as an annotated field of a named tuple: its
type and its meaning. The order of columns in the files, and the tables in results/README.md
(`python docs/tables_of_keys.py`), follow.
"""

from typing import Annotated, NamedTuple

from bezierplan.running.columns import Column, declared


class Named(NamedTuple):
    """Which claim, under which values."""

    study: Annotated[str, Column("the key of the study")]
    id: Annotated[str, Column("the name of the claim in its study, such as C1")]
    variant: Annotated[
        str,
        Column("values used instead of the primary ones; in the primary row, the primary values"),
    ]


class Sentence(NamedTuple):
    """What a claim says, and what became of it."""

    primary: Annotated[bool, Column("is this the primary variant?")]
    finding: Annotated[bool, Column("is it our own finding rather than a sentence of the paper?")]
    own_criterion: Annotated[
        bool,
        Column(
            "does the paper give no number, so that the threshold or margin that decides is ours?"
        ),
    ]
    place: Annotated[str, Column("where the paper says it")]
    statement: Annotated[str, Column("what it says, in one plain sentence")]
    verdict: Annotated[str, Column("as above")]
    holds: Annotated[str, Column("how many comparisons of the primary checks are +, of how many")]
    where_it_holds: Annotated[
        str,
        Column(
            "which of them are + in the family, in words; if none is, where the opposite holds; "
            "empty where all or none do"
        ),
    ]
    published: Annotated[
        str,
        Column("of the comparisons with printed numbers, how many agree with these, by value"),
    ]


class Compared(NamedTuple):
    """What a comparison compares, and its marks."""

    check: Annotated[int, Column("number of the check within the claim, from 1")]
    primary: Annotated[bool, Column("false for secondary checks, which are only reported")]
    decisive: Annotated[
        bool,
        Column(
            "is it the comparison that the row of claims.csv repeats: the worst -, otherwise that "
            "with the largest p?"
        ),
    ]
    test: Annotated[str, Column("the kind of the check")]
    experiments: Annotated[
        str, Column("the experiments whose runs are judged; empty where no runs are")
    ]
    metric: Annotated[str, Column("what is compared of each run")]
    statistic: Annotated[str, Column("the statistic of it that is compared")]
    unit: Annotated[str, Column("the unit of the metric")]
    condition: Annotated[str, Column("where")]
    comparison: Annotated[str, Column("what is compared with what")]
    mark: Annotated[str, Column("by itself")]
    mark_family: Annotated[str, Column("in the family; empty for secondary checks")]


class Effect(NamedTuple):
    """What a comparison finds; in the table of claims that of the decisive one."""

    effect: Annotated[
        float, Column("a difference, a share or a change: of means, or of the statistic")
    ]
    effect_size_name: Annotated[str, Column("what is computed from both groups")]
    effect_size: Annotated[float, Column("its value")]
    low95: Annotated[float, Column("lower end of the interval of the effect")]
    high95: Annotated[float, Column("its upper end")]
    n: Annotated[int, Column("number of units: pairs, or those of the smallest group")]
    counted: Annotated[
        str,
        Column(
            "how many units of each group have a value, out of how many: means, minima and maxima "
            "leave out failed runs"
        ),
    ]
    p: Annotated[float, Column("two-sided")]
    p_family: Annotated[
        float, Column("corrected; empty for secondary checks and where no p decides")
    ]


class Judged(NamedTuple):
    """How sure a claim's verdict is, and what shows it."""

    artefact: Annotated[str, Column("the tables and figures that show it")]


class Limits(NamedTuple):
    """What a comparison could find, and the printed numbers."""

    margin: Annotated[float, Column("the smallest effect that matters, a choice of ours")]
    effect_published: Annotated[float, Column("the effect in the printed numbers")]
    published: Annotated[str, Column("does the sentence hold in them: holds, fails or not printed")]


class Notes(NamedTuple):
    """What a reader should know."""

    timed: Annotated[bool, Column("judged on CPU times, which differ from machine to machine")]
    reason: Annotated[
        str, Column("why it is untestable or undecided, and other notes for the reader")
    ]


TABLES = {
    "claims": (Named, Sentence, Effect, Judged, Notes),
    "claim_checks": (Named, Compared, Effect, Limits, Notes),
}
"""Name of a table -> what declares its columns, in their order."""

CLAIM_COLUMNS, CHECK_COLUMNS = (list(declared(*tables)) for tables in TABLES.values())
