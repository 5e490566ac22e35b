"""Could our runs have printed a paper's numbers? One p.

An experiment of the paper's size is drawn from ours: n units (repeats, layouts, fields) without
replacement, the same ones for all methods. Its numbers are scored by the units that were not drawn,
those of the paper by all; p is the share of experiments that score as low as the paper. Drawn from
the units that score it, an experiment would look too good (84 of 100 true ones were rejected at .05
where n = 100 of 100 stored); so five to ten times n units are stored.

The score is the mean logarithm of the density of a number under our runs:

- A mean or median: its relative error has a Student t of `FREEDOM` degrees of freedom, whose scale
  holds the standard error of the printed number, that of ours, and `DISCREPANCY`, for no model of
  an experiment is exact. Each number of a drawn experiment has such an error too.
- A count or share: beta-binomial, as if ours came from `WORTH` runs, however many there are; with
  the probability `ANY`, it can be any.

Numbers of different problems are independent: each group has a p, and Fisher joins them.
"""

from typing import NamedTuple

import numpy as np

EXPERIMENTS = 2000
DISCREPANCY, FREEDOM = 0.03, 4
WORTH, ANY = 50, 0.05


class Numbers(NamedTuple):
    """k printed numbers that rest on the same units.

    values: of our runs (units, k), NaN where one has none. printed, step: the numbers and their
    last digit (k,). counts, medians: which of them are such, the others being means (k,). size:
    units of the paper.
    """

    values: np.ndarray
    printed: np.ndarray
    step: np.ndarray
    counts: np.ndarray
    medians: np.ndarray
    size: int


class Moments(NamedTuple):
    """Of some units, each (..., k): the mean, median or share; how many units have a value, and
    what share of them; and the variance of one unit.
    """

    centre: np.ndarray
    counted: np.ndarray
    share: np.ndarray
    variance: np.ndarray


def p_of_fit(groups: list[Numbers], rng: np.random.Generator) -> float:
    """The chance that experiments under our model fit it as badly as the paper's numbers do; none
    below one in `EXPERIMENTS` can be told.
    """
    from scipy import stats

    chances = [_p_of_group(each, rng) for each in groups]
    joined = float(stats.combine_pvalues(chances, method="fisher").pvalue)
    return max(joined, 1 / (1 + EXPERIMENTS))


def _p_of_group(numbers: Numbers, rng: np.random.Generator) -> float:
    values, size = numbers.values, numbers.size
    units = np.tile(np.arange(len(values)), (EXPERIMENTS, 1))
    drawn = rng.permuted(units, axis=1) < size
    errors = DISCREPANCY * rng.standard_t(FREEDOM, (EXPERIMENTS, len(numbers.printed)))
    printed = moments(numbers, drawn).centre * np.where(numbers.counts, size, 1 + errors)
    printed = np.round(printed / numbers.step) * numbers.step
    null = scored(numbers, printed, moments(numbers, ~drawn))
    paper = scored(numbers, numbers.printed, moments(numbers, np.ones_like(drawn[:1])))
    return float((1 + np.sum(null <= paper)) / (1 + EXPERIMENTS))


def moments(numbers: Numbers, choices: np.ndarray) -> Moments:
    """Moments of each choice of units (choices, units)."""
    known = ~np.isnan(numbers.values)
    values = np.where(known, numbers.values, 0.0)
    with np.errstate(invalid="ignore", divide="ignore"):
        counted, total = choices @ known.astype(float), choices @ values
        centre = total / counted
        variance = np.maximum(choices @ values**2 - total * centre, 0) / (counted - 1)
    units = choices.sum(axis=1, keepdims=True)
    variance = np.where(counted > 1, variance, np.nan)
    centre = np.where(numbers.counts, total / units, centre)
    if numbers.medians.any():
        own = numbers.values[:, numbers.medians]
        several = np.ma.masked_invalid(np.where(choices[:, :, None], own, np.nan))
        centre[:, numbers.medians] = np.ma.median(several, axis=1).filled(np.nan)
    return Moments(centre, counted, counted / units, variance)


def scored(numbers: Numbers, printed: np.ndarray, ours: Moments) -> np.ndarray:
    """The score (...) of printed numbers (..., k); those that are NaN have no say."""
    density = np.where(
        numbers.counts, _of_counts(numbers, printed, ours), _of_means(numbers, printed, ours)
    )
    return np.nanmean(np.where(np.isnan(printed), np.nan, density), axis=-1)


def _of_means(numbers: Numbers, printed: np.ndarray, ours: Moments) -> np.ndarray:
    """Log densities of relative errors; without two units that have a value, the error is 1."""
    from scipy import stats

    unit = np.maximum(np.abs(printed), numbers.step)
    with np.errstate(invalid="ignore", divide="ignore"):
        behind = np.maximum(numbers.size * ours.share, 1)
        variance = ours.variance * (1 / behind + 1 / ours.counted)
        relative = np.where(np.isnan(variance), 1.0, (printed - ours.centre) / unit)
    noise = np.nan_to_num(variance) + numbers.step**2 / 12
    scale = np.sqrt(DISCREPANCY**2 + noise / unit**2)
    return stats.t.logpdf(relative / scale, FREEDOM) - np.log(scale)


def _of_counts(numbers: Numbers, printed: np.ndarray, ours: Moments) -> np.ndarray:
    """Log densities of counts among `size` runs."""
    from scipy import stats

    true = np.where(numbers.counts, ours.centre, 0.5) * WORTH + 0.5
    density = stats.betabinom.pmf(np.round(printed), numbers.size, true, WORTH + 1 - true)
    return np.log((1 - ANY) * density + ANY / (numbers.size + 1))
