"""Claims under the readings of a paper, and under their own variants: what their verdicts depend
on.

The verdict on a claim is that under the default. It `depends`

- if one of its variants (settings of rivals, rules of counting or maps that the paper does not
  print) has another one;
- if a joint reading that is declared for it decides the opposite, where supported and partly are
  one side.

Both rest on as many runs as the default. A verdict that a reading leaves open is no agreement.
"""

from collections.abc import Iterable, Mapping
from typing import NamedTuple

import pandas as pd

from bezierplan.analysis.claims import sentences, verdicts
from bezierplan.analysis.claims.claim import Claim
from bezierplan.analysis.columns import COLUMNS_OF

DEFAULT = "default"
SIDES = {"supported": "holds", "partly": "holds", "contradicted": "fails", "no effect": "nothing"}
"""Decided verdict -> its side."""
MOST_NAMED = 3
"""Variants that are named; of more, the number is told."""
AGAINST = ["-", "0", "?", "+"]
"""Marks, those first that speak against a claim."""


class ClaimTables(NamedTuple):
    """The claims and checks of a study under one reading (`judge.judge_claims`)."""

    claims: pd.DataFrame
    checks: pd.DataFrame


def read_checks(file: str) -> pd.DataFrame:
    """Read the checks in a file. Marks are read as text, because a column of them may be of 0
    alone.
    """
    return pd.read_csv(file, dtype={"mark": str, "mark_family": str})


def add_dependence(
    claims: pd.DataFrame,
    readings: Mapping[str, ClaimTables],
    meanings: Mapping[str, str],
    names: Mapping[str, str],
) -> pd.DataFrame:
    """Add to the claims of a study what their verdicts depend on.

    readings: by name. meanings: reading -> what it changes, in words. names: variant -> its values
    in words.
    """
    under = {name: each.claims.set_index("id")["verdict"] for name, each in readings.items()}
    claims = claims.assign(readings="")
    primary, decided = claims["primary"].astype(bool), claims["verdict"].isin(SIDES)
    for index, claim in claims[primary].iterrows():
        # A reading judges the claims that it names, or the main ones, not all.
        own = {name: each[claim["id"]] for name, each in under.items() if claim["id"] in each}
        claims.loc[index, "readings"] = "; ".join(
            f"{verdict} under {', '.join(name for name in own if own[name] == verdict)}"
            for verdict in dict.fromkeys(own.values())
        )
        if not decided[index]:
            continue
        others = claims[~primary & decided & (claims["id"] == claim["id"])]
        others = others[others["verdict"] != claim["verdict"]]
        words = [
            f"{verdict} with {_join_names([names[each] for each in variants])}"
            for verdict, variants in others.groupby("verdict", sort=False)["variant"]
        ]
        # A reading that only turns supported into partly is on the same side.
        side = SIDES[claim["verdict"]]
        turned = {name: each for name, each in own.items() if SIDES.get(each, side) != side}
        for verdict in dict.fromkeys(turned.values()):
            told = [f'"{name}" ({meanings[name]})' for name in turned if turned[name] == verdict]
            words.append(f"{verdict} under {' and '.join(told)}")
        if words:
            told_first = f"{claim['verdict']} by default, {', '.join(words)}"
            claims.loc[index, "verdict"] = "depends"
            claims.loc[index, "reason"] = sentences.join_notes(told_first, claim["reason"])
    return claims


def _join_names(names: list[str]) -> str:
    """Join the names of variants, or count them if they are many."""
    if len(names) > MOST_NAMED:
        return f"{len(names)} variants"
    return " or ".join(f'"{name}"' for name in names)


def list_checks(claims: Iterable[Claim], readings: Mapping[str, ClaimTables]) -> pd.DataFrame:
    """List each primary check of each claim under each reading, as a table."""
    modes, rows = {claim.id: claim.holds for claim in claims}, []
    for name, (judged, checks) in readings.items():
        first = judged.loc[judged["primary"].astype(bool), ["id", "variant", "verdict"]]
        compared = checks[checks["primary"].astype(bool)].merge(first, on=["id", "variant"])
        for (claim, _), own in compared.groupby(["id", "check"], sort=False):
            marks, in_family = own["mark"].to_list(), own["mark_family"].to_list()
            # The first of those that speak most against the claim, in the order of the checks.
            against = own.loc[own["mark"].map(AGAINST.index).idxmin()]
            verdict = verdicts.judge_marks(marks, in_family, modes[claim])
            told = {"verdict_on_check": verdict, "holds": f"{marks.count('+')} of {len(marks)}"}
            rows.append(against.to_dict() | told | {"reading": name})
    return pd.DataFrame(rows, columns=COLUMNS_OF["claims_by_reading"])
