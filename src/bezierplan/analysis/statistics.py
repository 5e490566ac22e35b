"""Named statistics, bootstrap intervals, and the prediction interval for a published number.

Resampling uses plain numpy: `scipy.stats.bootstrap` makes the same draws, but importing it takes
longer than making a paper's tables.
"""

import math
from collections.abc import Callable
from functools import partial

import numpy as np

# Of so many draws the share beyond an end of 95 %, 2.5 %, has a standard error of 0.16 %.
DRAWS = 10_000
# Share of a distribution that lies beyond either end of its central 95 %.
TAIL = 0.025
# With fewer runs, the central 95 % is meaningless, and no published number is judged.
# Nor could a rank test decide: the least p of five pairs is 2 / 2^5, of six 2 / 2^6.
LEAST_RUNS = 6
# Above this many values, a normal approximation replaces the bootstrap.
MOST_RESAMPLED = 200
# Above this many values of an experiment, its statistics are not drawn value by value: in two
# stages, and in one.
MOST_PREDICTED, MOST_DRAWN = 1000, 10_000
# Maximum count of numbers drawn at once: blocks of this size stay in the processor's cache.
BLOCK = 1 << 15

# The functions below map values (..., n) without gaps, n at least 1, to statistics (...).


def _compute_std(values: np.ndarray) -> np.ndarray:
    """Compute the standard deviation of a sample (divisor n - 1), NaN for a single value."""
    # numpy would warn of a division by zero.
    if values.shape[-1] == 1:
        return np.full(values.shape[:-1], np.nan)
    return np.std(values, axis=-1, ddof=1)


def _compute_quantiles(values: np.ndarray, *shares: float) -> list[np.ndarray]:
    """Compute quantiles by linear interpolation.

    A full sort is used, because numpy sorts rows faster than it partitions them at two places.
    """
    ordered = np.sort(values, axis=-1)
    last = values.shape[-1] - 1
    quantiles = []
    for share in shares:
        low, weight = divmod(share * last, 1)
        low = int(low)
        quantiles.append(
            (1 - weight) * ordered[..., low] + weight * ordered[..., low + 1]
            if weight
            else ordered[..., low]
        )
    return quantiles


_SHARES = {"median": 0.5, "unstated": 0.5, "quartile1": 0.25, "quartile3": 0.75}
"""Statistics that are quantiles. `unstated`: the paper does not say; our median is printed."""

STATISTICS: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "mean": partial(np.mean, axis=-1),
    "std": _compute_std,
    # The interquartile range.
    "iqr": lambda values: np.subtract(*_compute_quantiles(values, 0.75, 0.25)),
    "range": partial(np.ptp, axis=-1),
    "min": partial(np.min, axis=-1),
    "max": partial(np.max, axis=-1),
    # Of a boolean metric (1 or 0): the number of runs that have it.
    "count": partial(np.sum, axis=-1),
    "share": partial(np.mean, axis=-1),  # likewise: the share of runs that have it
    **{
        name: lambda values, share=share: _compute_quantiles(values, share)[0]
        for name, share in _SHARES.items()
    },
}
# These grow with the number of runs, so resampling the same number does not show how far they are
# from the truth.
WITHOUT_INTERVAL = ("min", "max", "range")


def compute_statistic(name: str, values: np.ndarray) -> float:
    """Compute a named statistic of values.

    Parameters
    ----------
    name : str
        A name of `STATISTICS`.
    values : (n,) array
        Without gaps.

    Returns
    -------
    float
        Nan without values.

    Raises
    ------
    KeyError
        For an unknown name.
    """
    return float(STATISTICS[name](values)) if len(values) else math.nan


def resample(name: str, values: np.ndarray, size: int, rng: np.random.Generator) -> np.ndarray:
    """Draw `size` values, at most `MOST_DRAWN`, with replacement from values (n,), n at least 1,
    DRAWS times, and return a named statistic of each draw (DRAWS,).
    """
    size = min(size, MOST_DRAWN)
    if values.min() == values.max():
        return np.full(DRAWS, STATISTICS[name](np.full(size, values[0])))  # all draws are alike
    return _draw_in_blocks(
        name,
        size,
        # int32 draws the same numbers as int64, in half the memory.
        lambda rows: values.take(rng.integers(len(values), size=(rows, size), dtype=np.int32)),
    )


def _draw_in_blocks(name: str, size: int, draw: Callable[[int], np.ndarray]) -> np.ndarray:
    """Draw DRAWS experiments of `size` values each in blocks, and return a named statistic of each
    (DRAWS,).

    draw: gives as many experiments as asked for, (rows, size).
    """
    block = max(1, BLOCK // size)
    counts = [min(block, DRAWS - first) for first in range(0, DRAWS, block)]
    return np.concatenate([STATISTICS[name](draw(rows)) for rows in counts])


def compute_influence(name: str, values: np.ndarray) -> np.ndarray:
    """Compute how far each of values (n,), n at least 2, moves a named statistic: its empirical
    influence function (Hampel 1974), (n,).

    Its standard deviation, divided by the root of n, is the standard error of the statistic. Raises
    KeyError for `WITHOUT_INTERVAL` and for an unknown name.
    """
    if name == "iqr":
        return _compute_quantile_influence(values, 0.75) - _compute_quantile_influence(values, 0.25)
    if name in _SHARES:
        return _compute_quantile_influence(values, _SHARES[name])
    # Divisor n: the influence function is that of the empirical distribution.
    apart, std = values - values.mean(), values.std()
    if name == "std":
        return (apart**2 - std**2) / (2 * std) if std else np.zeros(len(values))
    return {"mean": 1, "share": 1, "count": len(values)}[name] * apart


def _compute_quantile_influence(values: np.ndarray, share: float) -> np.ndarray:
    """Compute the influence function of a quantile.

    The density at the quantile is taken from the order statistics at the ends of its 95 % interval
    (McKean and Schrader 1984).
    """
    # Half the 95 % interval of the rank at which the population's quantile lies, as a share.
    reach = 1.96 * math.sqrt(share * (1 - share) / len(values))
    low, quantile, high = _compute_quantiles(
        values, max(share - reach, 0.0), share, min(share + reach, 1.0)
    )
    return (share - (values <= quantile)) * (high - low) / (2 * reach)


def compute_normal_draws(centre: float, error: float) -> np.ndarray:
    """Compute the draws that resampling would give for a statistic with a standard error, without
    randomness: evenly spaced normal quantiles (DRAWS,).
    """
    from scipy.special import ndtri

    return centre + error * ndtri((np.arange(DRAWS) + 0.5) / DRAWS)


def _is_normal(name: str, values: np.ndarray) -> bool:
    """Return whether the normal approximation of a statistic can be computed from values (n,): not
    for extremes, a single value or infinite ones.
    """
    return name not in WITHOUT_INTERVAL and len(values) > 1 and bool(np.isfinite(values).all())


def _approximate_draws(name: str, values: np.ndarray, share: float) -> np.ndarray:
    """Approximate the draws (DRAWS,) of a statistic by normal ones, whose variance is a share of
    that of its influence function over values (n,).
    """
    return compute_normal_draws(
        compute_statistic(name, values),
        compute_influence(name, values).std(ddof=1) * math.sqrt(share),
    )


def compute_interval(
    name: str, values: np.ndarray, rng: np.random.Generator
) -> tuple[float, float]:
    """Compute the 95 % percentile bootstrap interval of a statistic; above `MOST_RESAMPLED` values,
    its normal approximation.

    Parameters
    ----------
    name : str
        A name of `STATISTICS`.
    values : (n,) array
        Without gaps.
    rng : Generator
        What the bootstrap draws from.

    Returns
    -------
    low, high : float
        Nan for fewer than two values, and for statistics that depend on the number of values
        (`WITHOUT_INTERVAL`).
    """
    if len(values) < 2 or name in WITHOUT_INTERVAL:
        return math.nan, math.nan
    if len(values) > MOST_RESAMPLED and _is_normal(name, values):
        draws = _approximate_draws(name, values, 1 / len(values))
    else:
        draws = resample(name, values, len(values), rng)
    low, high = np.quantile(draws, [TAIL, 1 - TAIL])
    return float(low), float(high)


def draw_predictions(
    name: str, values: np.ndarray, size: int, rng: np.random.Generator
) -> np.ndarray:
    """Draw experiments with `size` values, as predicted from our values (n,), n at least 1, and
    return a named statistic of each: (DRAWS,).

    Experiments are drawn in two stages, because our values are a sample too: first the population,
    then an experiment from it. Numbers are drawn with replacement twice; for booleans, the share is
    drawn (from Jeffreys' posterior), then the number of true values. Above `MOST_PREDICTED` values,
    the normal approximation of both stages; where that is not known, experiments of so many values.
    """
    if name in ("count", "share"):
        # Resampling says nothing about events that never happened; a posterior does.
        true = values.sum()
        counts = rng.binomial(size, rng.beta(true + 0.5, len(values) - true + 0.5, DRAWS))
        return counts / (size if name == "share" else 1)
    if size > MOST_PREDICTED and _is_normal(name, values):
        return _approximate_draws(name, values, 1 / len(values) + 1 / size)
    size = min(size, MOST_PREDICTED)

    def draw(rows: int) -> np.ndarray:
        # Only the places of the first draw that the second one uses are filled, each once.
        """Draw so many experiments in two stages."""
        places, world = rng.integers(len(values), size=(2, rows, size), dtype=np.int32)
        places.sort(axis=1)
        asked_first = np.where(np.diff(places, axis=1, prepend=-1) > 0, np.arange(size), 0)
        chosen = np.maximum.accumulate(asked_first, axis=1)
        return values[np.take_along_axis(world, chosen, axis=1)]

    return _draw_in_blocks(name, size, draw)


def draw_predictions_within(
    name: str, groups: list[np.ndarray], size: int, rng: np.random.Generator
) -> np.ndarray:
    """Draw experiments whose `size` values all belong to one group, as predicted from our groups of
    values, and return a named statistic of each: (DRAWS,).

    First a group is drawn, then an experiment from it, for example runs in one layout of the
    obstacles.
    """
    chosen, drawn = rng.integers(len(groups), size=DRAWS), np.empty(DRAWS)
    size = min(size, MOST_PREDICTED)  # more values differ less within a group than groups do
    for number, values in enumerate(groups):
        experiments = np.flatnonzero(chosen == number)
        places = rng.integers(len(values), size=(len(experiments), size))
        drawn[experiments] = STATISTICS[name](values[places])
    return drawn


def compute_prediction_interval(
    name: str,
    values: np.ndarray,
    size: int | None,
    rng: np.random.Generator,
    possible: tuple[float, float] = (-math.inf, math.inf),
    groups: list[np.ndarray] | None = None,
) -> tuple[float, float]:
    """Compute the range in which 95 % of experiments of the paper's size end, judging by our
    values.

    Parameters
    ----------
    name : str
        A name of `STATISTICS`.
    values : (n,) array
        Ours, without gaps.
    size : int or None
        Number of values behind the published statistic; if None (not stated), the range is that of
        our single values.
    rng : Generator
        What experiments are drawn from.
    possible : tuple of float
        The least and the largest possible single value; no experiment's extreme lies beyond them.
    groups : list of array, optional
        Our values by group, if all values of the paper's experiment belong to one.

    Returns
    -------
    tuple of float
        NaN below `LEAST_RUNS` values. If our values do not determine how far the least or the
        largest of others may lie, an end is the least or the largest possible value, or infinite.
    """
    if len(values) < LEAST_RUNS:
        return math.nan, math.nan
    tail = TAIL
    # The paper does not state its number of runs, so single values are compared.
    if size is None:
        least = most = values
    elif groups is not None:
        # A new group lies below the k-th of n others with probability k / (n + 1); that one stands
        # at (k - 1/2) / n among the draws.
        least = most = draw_predictions_within(name, groups, size, rng)
        tail = max(TAIL * (len(groups) + 1) - 0.5, 0.0) / len(groups)
    # No resample goes beyond our own extremes, so their ranks decide.
    elif name in ("min", "max"):
        least, most = _spread_extremes(name, values, size)
        least, most = np.maximum(least, possible[0]), np.minimum(most, possible[1])
    elif name == "std" and np.isfinite(values).all():
        least = most = _draw_stds(values, size)
    else:
        least = most = draw_predictions(name, values, size, rng)
        # Shares are drawn from a posterior: only the bootstrap is too narrow.
        if name not in ("count", "share"):
            tail = compute_expanded_tail(len(values))
    # Outwards to the next draw: beside an infinite one nothing can be interpolated.
    low = np.quantile(least, tail, method="lower")
    high = np.quantile(most, 1 - tail, method="higher")
    return float(low), float(high)


def scale_statistic(name: str, values: np.ndarray, among: int, size: int | None) -> float:
    """Scale a named statistic of our values (n,) to an experiment of `size` runs, so that it stands
    beside a published one.

    A count is taken in proportion; among: runs among which it is one. The least and the largest
    value are the medians of those of such experiments, where our values determine them; our own
    where they do not. The other statistics do not depend on the number of runs.
    """
    value = compute_statistic(name, values)
    if size is None or size == among or not len(values):
        return value
    if name == "count":
        return value * size / among
    if name not in ("min", "max"):
        return value
    # The upper of the middle two draws: one of them may be infinite.
    middle = sum(np.sort(ends)[DRAWS // 2] for ends in _spread_extremes(name, values, size)) / 2
    return float(middle) if math.isfinite(middle) else value


def _draw_stds(values: np.ndarray, size: int) -> np.ndarray:
    """Predict standard deviations of `size` values from our values (n,), n at least 2: evenly
    spaced quantiles (DRAWS,).

    The logarithm of a variance is nearly normal, with a standard error that follows from the
    population's kurtosis (Bonett 2006, Computational Statistics & Data Analysis 50, 775). Both
    samples err; Student's t replaces the normal because the kurtosis is estimated from our values.
    Resampling would give too narrow a range: a resample has fewer distinct values than its source.
    """
    from scipy.special import stdtrit

    n = len(values)
    spread = values.std(ddof=1)
    if spread == 0:
        return np.zeros(DRAWS)
    kurtosis = (
        n
        * np.sum((values - _compute_trimmed_mean(values)) ** 4)
        / np.sum((values - values.mean()) ** 2) ** 2
    )
    # Of our sample and of the paper's; a small sample can give a negative estimate.
    variances = [max(kurtosis - (k - 3) / k, 0.0) / (k - 1) for k in (n, max(size, 2))]
    logarithms = 0.5 * math.sqrt(sum(variances)) * stdtrit(n - 1, (np.arange(DRAWS) + 0.5) / DRAWS)
    with np.errstate(over="ignore"):  # of two or three values the largest are infinite
        return spread * np.exp(logarithms)


def _compute_trimmed_mean(values: np.ndarray) -> float:
    """Compute the mean without a share of 1 / (2 sqrt(n - 4)) of the values at either end, about
    which Bonett's kurtosis is taken.
    """
    n = len(values)
    # At least one value stays.
    cut = min(int(n / (2 * math.sqrt(n - 4))), (n - 1) // 2) if n > 4 else 0
    return float(np.sort(values)[cut : n - cut].mean())


def compute_expanded_tail(n: int) -> float:
    """Compute the tail at each end of bootstrap draws from n values for a central 95 % (the
    expanded percentile interval, Hesterberg 2015).

    A few values vary less than their population, and their spread is uncertain: Student's t
    quantiles replace the normal ones.
    """
    if n < 2:
        return TAIL
    from scipy.special import ndtr, stdtrit

    return float(ndtr(math.sqrt(n / (n - 1)) * stdtrit(n - 1, TAIL)))


def _spread_extremes(name: str, values: np.ndarray, size: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the gaps between our values (n,) in which the least (or largest) of `size` others lies
    at evenly spaced probabilities: lower and upper ends (DRAWS,).

    Resampling never goes beyond our own extremes, whereas half of all experiments of our size do.
    All orders of our values and the others are equally likely, which gives the probability of each
    gap; the outermost are infinite.
    """
    # The largest of values is the least of their negatives.
    if name == "max":
        least, most = _spread_extremes("min", -values, size)
        return -most, -least
    ends = np.concatenate([[-np.inf], np.sort(values), [np.inf]])
    # Probability that more than 0, 1, ... of ours lie below the least of the others.
    beyond = np.cumprod(np.arange(len(values), 0, -1) / np.arange(len(values) + size, size, -1))
    gaps = np.searchsorted(-beyond, -(np.arange(DRAWS) + 0.5) / DRAWS)
    return ends[gaps], ends[gaps + 1]
