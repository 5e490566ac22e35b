"""Claims under the readings of a paper, and under their own variants: what their verdicts depend
on.

The verdict on a claim is that under the default, from many runs. It `depends`

- if one of its variants (settings of rivals, rules of counting or maps that the paper does not
  print) has another one: they rest on as many runs;
- if the opposite is decided under a reading that nothing excludes and that fits (p at least
  `LEAST_P`; where none fits, under any that nothing excludes). A reading has fewer runs: each of
  its verdicts is one of many, so p counts so many times (Bonferroni) and intervals are as much
  wider; and supported and partly are one side.
"""

from collections.abc import Collection, Iterable, Mapping

import pandas as pd

from bezierplan.analysis.claims import judge
from bezierplan.analysis.claims.claim import Claim
from bezierplan.analysis.claims.material import Material
from bezierplan.analysis.readings.readings import LEAST_P

SIDES = {"supported": "holds", "partly": "holds", "contradicted": "fails", "no effect": "nothing"}
"""Decided verdict -> its side."""
MOST_NAMED = 3
"""Readings or variants that are named; of more, the number is told."""
BY_DEFAULT = "under the default"


def covered(claims: Iterable[Claim], experiments: Collection[str]) -> list[Claim]:
    """The claims whose primary checks rest on the runs of some experiments alone, and on no times;
    these checks, in the primary variant.
    """
    chosen = []
    for claim in claims:
        checks = [check for check in claim.checks if check.primary]
        if all(
            check.experiments and {*check.experiments} <= {*experiments} and not check.timed
            for check in checks
        ):
            chosen.append(claim.in_primary_variant().but(checks=checks))
    return chosen


def judged(material: Material) -> pd.DataFrame:
    """The verdicts on claims (id, verdict) for which there is data."""
    claims, checks = judge.judge(material)
    missing = {*checks.loc[checks["n"] == 0, "id"]}
    tested = ~claims["id"].isin(missing) & (claims["verdict"] != "untestable")
    return claims.loc[tested, ["id", "verdict"]]


def told(
    claims: pd.DataFrame,
    readings: pd.DataFrame,
    verdicts: pd.DataFrame,
    names: Mapping[str, str],
) -> pd.DataFrame:
    """Claims of a study with what their verdicts depend on. readings, verdicts: as from
    `readings.of_study`, empty without readings. names: variant -> its values in words.
    """
    if len(readings):
        open_ones = readings[readings["excluded_by"].fillna("").eq("") & readings["p"].notna()]
        fitting = open_ones[open_ones["p"] >= LEAST_P]
        kept = (fitting if len(fitting) else open_ones).set_index("reading")["meaning"].fillna("")
    claims = claims.assign(readings="")
    primary, decided = claims["primary"].astype(bool), claims["verdict"].isin(SIDES)
    for index, claim in claims[primary & decided].iterrows():
        words = []
        others = claims[~primary & decided & (claims["id"] == claim["id"])]
        others = others[others["verdict"] != claim["verdict"]]
        for verdict, variants in others.groupby("verdict", sort=False)["variant"]:
            words.append(f"{verdict} with {_named([names[each] for each in variants], 'variants')}")
        if len(readings):
            own = verdicts[verdicts["id"] == claim["id"]].set_index("reading")["verdict"]
            own = own[own.index.isin(kept.index)]
            claims.loc[index, "readings"] = _counted(claim["verdict"], own)
            words += _turned(claim["verdict"], own, kept)
        if words:
            told_first = f"{claim['verdict']} by default, {', '.join(words)}"
            claims.loc[index, "verdict"] = "depends"
            claims.loc[index, "reason"] = "; ".join(filter(None, [told_first, claim["reason"]]))
    return claims


def _counted(verdict: str, own: pd.Series) -> str:
    """Under how many readings a claim is on the side of a verdict."""
    if own.empty:
        return BY_DEFAULT
    same = own.map(SIDES) == SIDES[verdict]
    return f"{verdict} under {same.sum()} of {len(own)} readings"


def _turned(verdict: str, own: pd.Series, meanings: pd.Series) -> list[str]:
    """The verdicts on another side, with the readings that they hang on."""
    turned = own[own.isin(SIDES) & (own.map(SIDES) != SIDES[verdict])]
    words = []
    for other, names in turned.groupby(turned, sort=False).groups.items():
        named = [f"{each.replace('=', ' = ')} ({meanings[each]})" for each in names]
        words.append(f"{other} with {_named(named, 'readings')}")
    return words


def _named(names: list[str], what: str) -> str:
    return " or ".join(names) if len(names) <= MOST_NAMED else f"{len(names)} {what}"
