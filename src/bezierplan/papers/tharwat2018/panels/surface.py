"""The objective over two coordinates as a surface, seen from the side."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from bezierplan.figures.groups import describe_axis
from bezierplan.figures.panels import Note
from bezierplan.papers.tharwat2018.panels import landscape
from bezierplan.papers.tharwat2018.panels.landscape import data as data

if TYPE_CHECKING:
    import pandas as pd
    from mpl_toolkits.mplot3d import Axes3D


# The kind of axes that a panel needs.
PROJECTION = "3d"


class Options(landscape.Options):
    """Keys of the panel, as a landscape has them."""


def draw(axes: Axes3D, frame: pd.DataFrame, scene: Any, options: Options) -> Note:
    """Draw the nodes of `data` at a logarithmic height."""
    unit = options.find_workspace(frame, scene).unit
    x, y, values = landscape.list_nodes(frame)
    colours = landscape.build_scale(values).to_rgba(values)
    # Facets between every second node look the same when printed, and are drawn in a third of the
    # time.
    look = {"rstride": 2, "cstride": 2, "linewidth": 0, "antialiased": False, "rasterized": True}
    axes.plot_surface(*np.meshgrid(x, y), np.log10(values), facecolors=colours, **look)
    axes.view_init(elev=45, azim=-60)
    axes.set_box_aspect((1, 1, 0.7), zoom=0.85)
    axes.set_xlabel(f"x ({unit})", labelpad=-6)
    axes.set_ylabel(f"y ({unit})", labelpad=-6)
    axes.set_zlabel(describe_axis("objective", scene), labelpad=-6)
    numbers = landscape.choose_round_numbers(values)
    axes.set_zticks(np.log10(numbers), [f"{number:g}" for number in numbers])
    axes.tick_params(pad=-3)
    for axis in "xy":
        axes.locator_params(axis, nbins=5)
    return landscape.describe_minima(frame, scene.unit)
