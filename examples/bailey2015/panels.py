"""Every field as a point."""

import matplotlib.ticker


def ratios(axes, frame, looks):
    """Ratios by method, each field a point; returns what the caption says.

    looks: by method, its colour, marker and label in all figures.
    """
    for place, (method, look) in enumerate(looks.items()):
        own = frame[frame["method"] == method]
        axes.plot([place] * len(own), own["ratio"], **look | {"linestyle": "none"})
    axes.set_xticks(range(len(looks)), [look["label"] for look in looks.values()])
    axes.yaxis.set_major_locator(matplotlib.ticker.MaxNLocator(5))
    axes.set_ylabel("ratio")
    return f"{len(frame)} paths"
