"""ma2020: an audit of its tables and text."""

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from bezierplan.analysis.audit import rules
from bezierplan.analysis.audit.rows import build_audit_row, compare_with_limit
from bezierplan.geometry import curves
from bezierplan.papers.ma2020.functions import read_side_of_maps

if TYPE_CHECKING:
    from bezierplan.analysis.claims.kinds.function import Published


def audit(published: "Published") -> list[dict]:
    """List printed numbers that are impossible, or contradict others.

    No path is shorter than the straight line. Shares of occupied cells are whole numbers of cells.
    Statements in the text about lengths and times are checked against the tables, the one about the
    parameter of a curve and equation (11) by computing.
    """
    return [*rules.check_rules(published), *_audit_text(published)]


def _audit_text(published: "Published") -> Iterator[dict]:
    """List rows about shares of cells, equations (11) to (15), and parameters of curves."""
    side = read_side_of_maps(published)
    parameters = published["parameters"].set_index(["workspace", "parameter"])["value"]
    rule = "a share of the cells is a whole number of cells"
    for workspace in ("environment1", "environment2"):
        share = parameters[workspace, "obstacle_coverage"] / 100
        cells = share * parameters[workspace, "grid_size"] ** 2
        whole = round(cells)
        location = f"workspace={workspace}"
        yield build_audit_row(
            "parameters", location, rule, cells, whole, bool(abs(cells - whole) < 1e-9)
        )
    # Equation (11) as printed: M + ceil(num, M) + 0.5, where ceil rounds down.
    heights = side + np.arange(1, side * side + 1) // side + 0.5
    rule = (
        "equation (11) gives the heights of the cells' centres: cells whose height lies on the map"
    )
    inside = int((heights < side).sum())
    yield compare_with_limit("text", "3.2, equation (11)", rule, inside, "==", side * side)
    # By equation (13) the fitness of a free path is its length, and by equation (15) its chance of
    # being selected grows with that.
    rule = (
        "the shorter of two free paths is selected more often: fitness of the straight path, and "
        "of one along two sides of the map"
    )
    shorter, longer = side * math.sqrt(2), 2.0 * side
    yield compare_with_limit("text", "3.3, equations (12) and (15)", rule, shorter, ">", longer)
    # One curve refutes a sentence about all: its points lie on a line, two of them at the start.
    text = published["text_values"].set_index("quantity")["value"]
    quarter = float(text["t of a quarter of the path"])
    share = float(curves.bernstein(2, np.array([quarter]))[0] @ np.array([0.0, 0.0, 1.0]))
    rule = (
        f"a curve is a quarter of the way along at t = {quarter:g}: share of the way of the curve "
        "with control points at 0, 0 and 1"
    )
    location = "2, equation (1)"
    yield build_audit_row("text", location, rule, quarter, share, abs(share - quarter) < 1e-9)
    listed = int((published["parameters"]["parameter"] == "control_points").sum())
    rule = (
        "Data Availability: all required parameters are listed, here: the number of control points"
    )
    yield compare_with_limit("text", "Data Availability", rule, listed, ">=", 1)
