"""What the paper measures."""

from bezierplan.analysis.metric import metric


@metric("-", "length / length of the truly shortest path", feasible_only=True, least=1.0)
def ratio(runs, problems):
    """The length of each run over the exact shortest length of its problem."""
    return runs["length"] / runs["bound"]
