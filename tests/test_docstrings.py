"""Docstrings of public names describe each parameter and attribute."""

import inspect

import pytest
from numpydoc.docscrape import NumpyDocString

from bezierplan import api, planners
from bezierplan.analysis import metrics, statistics
from bezierplan.geometry import checker, region, shortest_paths
from bezierplan.geometry.shortest_paths import graph
from bezierplan.workspaces import problem

# What users and other programs see: sections of its docstrings name all that there is, in its
# order.
TUPLES = [
    *(
        planners.Plan,
        problem.Path,
        problem.Problem,
        checker.Check,
        graph.Bound,
        metrics.Metric,
    ),
    *(region.GridRegion, region.CircleRegion, region.PolygonRegion),
]
FUNCTIONS = [
    *(api.read_map, api.plan, api.check, api.shortest_path, api.results, api.replay),
    *(
        checker.check,
        shortest_paths.shortest_path,
        shortest_paths.least_length,
        region.build_region,
        region.is_blocked,
    ),
    *(
        metrics.compute_values,
        metrics.find_unit,
        statistics.compute_statistic,
        statistics.compute_interval,
        statistics.compute_prediction_interval,
    ),
]


def section(documented, name):
    """The names in a section of a docstring, without stars."""
    listed = NumpyDocString(inspect.getdoc(documented))[name]
    return [each.strip().lstrip("*") for entry in listed for each in entry.name.split(",")]


@pytest.mark.parametrize("documented", TUPLES, ids=lambda each: each.__name__)
def test_every_attribute_is_described(documented):
    assert section(documented, "Attributes") == list(documented._fields)


@pytest.mark.parametrize(
    "documented", FUNCTIONS, ids=lambda each: f"{each.__module__}.{each.__name__}"
)
def test_every_parameter_is_described(documented):
    assert section(documented, "Parameters") == list(inspect.signature(documented).parameters)
    assert section(documented, "Returns")
