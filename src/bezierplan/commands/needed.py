"""How many runs scale extended has and needs: those that decide claims and published numbers.

A claim needs what decides its comparisons with a power of 0.8, were our effects the true ones
(`units_needed` in claim_checks.csv): one that is decided, its decisive comparison; an undecided
one, all that are not. A published mean needs an interval of ours that is narrow beside the interval
in which an experiment of the paper's size falls; an extreme needs enough of such experiments. No
experiment needs fewer runs than the paper made. Claims about seconds ask for nothing: more runs do
not make another machine.
"""

import math
from argparse import ArgumentParser
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd

from bezierplan.analysis.claims import effects
from bezierplan.analysis.markdown import table_text
from bezierplan.schema.checked import Fault
from bezierplan.study import jobs, reading
from bezierplan.study.definition import Study

RESULTS, KEPT = Path("results/extended"), "runs_needed.csv"
REACH = 10_000
"""Runs of a condition beyond which a claim counts as out of reach."""
PRECISION = 0.5
"""Width of our interval over that of the paper's, at most, for a number that has runs enough."""
EXTREMES = ("min", "max")
EXPERIMENTS = 2 / effects.ALPHA - 1
"""Experiments of the paper's size, at least, whose extremes have a 95 % interval with two ends."""
MOST = 10
"""How many times as many runs as it needs an experiment may have."""


class Wish(NamedTuple):
    """What asks an experiment for runs. factor: runs needed over runs that there are."""

    study: str
    experiment: str
    name: str
    factor: float
    undecided: bool


def main(parser: ArgumentParser, words: list[str]) -> None:
    """Print runs needed beside runs given. Raises Fault without results of scale extended."""
    parser.parse_args(words)
    try:
        needed = table(reading.load(reading.read_config({})), RESULTS)
    except FileNotFoundError as error:
        raise Fault(f"{error.filename}: not there yet; `snakemake extended` makes it") from None
    print(table_text(needed.fillna("")))


def table(studies: dict[str, Study], results: Path) -> pd.DataFrame:
    """A row per experiment with a wish: runs of a condition that scale extended gives and needs.

    Columns: study, experiment, paper (runs at scale full), given, needed, asked_by (the claim or
    number that needs most, empty if that is the paper's own size), out_of_reach (undecided claims
    that need more than `REACH` runs). Raises FileNotFoundError without results.
    """
    numbers = pd.read_csv(results / "numbers.csv")
    wishes = [
        wish
        for key, study in studies.items()
        for wish in (
            *_of_claims(key, results / key),
            *_of_numbers(key, study, numbers[(numbers["study"] == key) & numbers["counted"]]),
        )
    ]
    rows = []
    for (key, name), asked in pd.DataFrame(wishes, columns=Wish._fields).groupby(
        ["study", "experiment"], sort=False
    ):
        made, paper = (runs(studies[key], name, scale) for scale in ("extended", "full"))
        asked = asked.assign(needed=np.ceil(asked["factor"] * made))
        beyond = asked["undecided"] & ~(asked["needed"] <= REACH)
        most = asked[~beyond & asked["needed"].notna()].nlargest(1, "needed")
        least = int(most["needed"].iloc[0]) if len(most) else 0
        rows.append(
            {
                "study": key,
                "experiment": name,
                "paper": paper,
                "given": made,
                "needed": max(least, min(paper, made)),
                "asked_by": most["name"].iloc[0] if least > paper else "",
                "out_of_reach": ", ".join(dict.fromkeys(asked.loc[beyond, "name"])),
            }
        )
    return pd.DataFrame(rows)


def runs(study: Study, experiment: str, scale: str) -> int:
    """Runs of the conditions with the most: repeats on each layout, and layouts. Published numbers
    that count and claims in their primary variant are of these; others may have fewer.
    """
    described = study.experiments[experiment]
    layouts = [study.problems[name].layouts for name in described.problems]
    return described.repeats[scale] * max((drawn[scale] for drawn in layouts if drawn), default=1)


def _of_claims(key: str, folder: Path) -> Iterator[Wish]:
    claims, checks = (
        pd.read_csv(folder / name, dtype={"variant": str}).fillna({"variant": ""})
        for name in ("claims.csv", "claim_checks.csv")
    )
    for claim in claims[claims["primary"] & ~claims["timed"]].itertuples():
        of_claim = (checks["id"] == claim.id) & (checks["variant"] == claim.variant)
        yield from _of_claim(key, claim, checks[of_claim])


def _of_claim(key: str, claim, checks: pd.DataFrame) -> Iterator[Wish]:
    """What the comparisons ask for that a verdict rests on, or that prevent one."""
    undecided = claim.verdict == "undecided"
    checks = checks[checks["experiments"].notna()]
    deciding = checks[checks["mark_family"] == "?"] if undecided else checks[checks["decisive"]]
    for check in deciding.itertuples():
        factor = check.units_needed / check.n if check.n else math.inf
        if not undecided:
            factor = min(factor, 1.0)  # it is decided as it is
        elif math.isnan(factor):
            factor = math.inf
        for experiment in check.experiments.split(", "):
            yield Wish(key, experiment, claim.id, factor, undecided)


def _of_numbers(key: str, study: Study, numbers: pd.DataFrame) -> Iterator[Wish]:
    """By which factor runs would have to grow for every number of a table to have enough; means
    that are decided ask for no more than there is.
    """
    size = np.where(
        numbers["statistic"] == "count", numbers["n_published"] / numbers["n_ours"], 1.0
    )
    ours = (numbers["high95_ours"] - numbers["low95_ours"]) * size
    predicted = numbers["high95_predicted"] - numbers["low95_predicted"]
    factors = (ours / (PRECISION * predicted.where(predicted > 0))) ** 2
    factors = factors.where(numbers["verdict"] == "inconclusive", factors.clip(upper=1.0))
    extremes = numbers["statistic"].isin(EXTREMES)
    factors = factors.mask(extremes, EXPERIMENTS * numbers["n_published"] / numbers["n_ours"])
    for name, of_table in factors.groupby(numbers["table"], sort=False):
        if of_table.notna().any():
            for experiment in jobs.experiments_of(study, name):
                yield Wish(key, experiment, name, of_table.max(), False)
