"""Every field as a point."""

import matplotlib.ticker


def ratios(axes, frame):
    """Ratios by method, each field a point; returns what the caption says."""
    for place, (method, own) in enumerate(frame.groupby("method")):
        axes.plot([place] * len(own), own["ratio"], ".", label=method)
    axes.set_xticks(range(frame["method"].nunique()), sorted(frame["method"].unique()))
    axes.yaxis.set_major_locator(matplotlib.ticker.MaxNLocator(5))
    axes.set_ylabel("ratio")
    return f"{len(frame)} paths"
