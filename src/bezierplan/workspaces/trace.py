"""The way that a search has found."""

import numpy as np

from bezierplan.kernels import compile_kernel


@compile_kernel
def trace_back(before, end, length):
    """Return the nodes from the first one to an end, from each one's predecessor, which is below 0
    for the first; none if the length is infinite.
    """
    nodes = [end]
    while before[nodes[-1]] >= 0:
        nodes.append(before[nodes[-1]])
    return np.array(nodes[::-1]) if length < np.inf else np.empty(0, np.int64)
