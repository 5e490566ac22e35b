"""Rank tests: Wilcoxon's signed-rank test with Pratt's zeros, and the Mann-Whitney test."""

import numpy as np

# With more differences, the signed-rank test uses the normal approximation.
MOST_EXACT = 50


def compare_ranks(group: np.ndarray, reference: np.ndarray, paired: bool) -> tuple[float, int]:
    """Compare the ranks of two groups; return p, and the side (1: higher) on which the first
    group's lie.
    """
    from scipy import stats

    if paired:
        difference = group - reference
        # scipy's approximation gives no p if all differences are 0.
        if not difference.any():
            return 1.0, 0
        # Pratt: zeros are ranked with the others, and have no sign.
        ranks = np.sign(difference) * stats.rankdata(np.abs(difference))
        return compute_p_of_signed_ranks(difference), int(np.sign(ranks.sum()))
    # All values are equal, so nothing tells the groups apart.
    if np.ptp(np.concatenate([group, reference])) == 0:
        return 1.0, 0
    test = stats.mannwhitneyu(group, reference)
    return float(test.pvalue), int(np.sign(test.statistic - len(group) * len(reference) / 2))


def compute_p_of_signed_ranks(difference: np.ndarray) -> float:
    """Compute p of Wilcoxon's signed-rank test with Pratt's zeros, against a median of zero; exact,
    even with ties, up to `MOST_EXACT` differences.

    scipy's test is exact with ties only up to 13 differences, and takes a second for that.
    """
    from scipy import stats

    if len(difference) > MOST_EXACT:
        return float(stats.wilcoxon(difference, zero_method="pratt", method="asymptotic").pvalue)
    # Twice a rank is an integer, tied or not.
    ranks = np.rint(2 * stats.rankdata(np.abs(difference))).astype(int)
    # How many of the equally likely assignments of signs give each sum of the positive ranks.
    signs = np.ones(1)
    for rank in ranks[difference != 0]:
        signs = np.pad(signs, (0, rank)) + np.pad(signs, (rank, 0))
    positive = ranks[difference > 0].sum()
    return min(
        1.0, 2 * float(min(signs[: positive + 1].sum(), signs[positive:].sum()) / signs.sum())
    )
