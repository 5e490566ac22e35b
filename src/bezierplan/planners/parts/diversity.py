"""Agreement of two binary chromosomes: the Q statistic (elhoseny2017, equation 10)."""

import numpy as np

from bezierplan.kernels import allocation_free


@allocation_free
def compute_q_statistic(both: int, neither: int, only_one: int, only_other: int) -> float:
    """Return Q, from -1 (the chromosomes share no gene) to 1.

    The arguments are numbers of genes: set in both chromosomes, in neither, and in only one of
    them.

    The paper does not define Q when its denominator is 0: here it is 1 for equal chromosomes,
    otherwise 0.
    """
    agree, differ = float(both * neither), float(only_one * only_other)
    if agree + differ == 0.0:
        return 1.0 if only_one == 0 and only_other == 0 else 0.0
    return (agree - differ) / (agree + differ)


@allocation_free
def count_shared(first: np.ndarray, second: np.ndarray) -> int:
    """Count the elements that two ascending lists share."""
    i = j = common = 0
    while i < len(first) and j < len(second):
        if first[i] == second[j]:
            common += 1
            i += 1
            j += 1
        elif first[i] < second[j]:
            i += 1
        else:
            j += 1
    return common
