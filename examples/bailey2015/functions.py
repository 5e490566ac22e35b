"""The worst ratios in closed form, and the claim that no path exceeds one of them."""

import math

import pandas as pd

from bezierplan.analysis.results import select


def worst(neighbours: int) -> float:
    """The largest ratio in an open field: steps lie 360 / neighbours degrees apart, and a path in
    the middle between two directions is longest.
    """
    return 1 / math.cos(math.pi / neighbours)


def closed_forms(published, *, neighbours: list[int]):
    """A row for each number of neighbours."""
    rows = [{"neighbours": number, "worst ratio": round(worst(number), 4)} for number in neighbours]
    return pd.DataFrame(rows)


def never_above(check, results, published, *, neighbours: int):
    """Whether no ratio lies above the worst one; the effect is the largest over it."""
    runs = select(results[check.experiment].runs, check.where)
    largest = (runs["length"] / runs["bound"]).max() / worst(neighbours)
    return "+" if largest <= 1 + 1e-9 else "-", float(largest), None, len(runs)
