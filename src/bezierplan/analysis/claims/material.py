"""What the claims of a study are judged on."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    import pandas as pd

    from bezierplan.analysis.results import Results


class Material(NamedTuple):
    """What the claims of a study are judged on, everything by name.

    results: of each experiment that was run. published: files of published numbers, named without `.csv`. artefacts: descriptions of tables
    and figures as in artefacts.yaml. functions: of the study's file in `papers/`. variant_of: method -> the method whose published numbers
    count. paired: of each experiment, do runs of equal repeats share a start or a drawn workspace? repeats: how many repeats the paper has
    of each, which counts where the printed numbers do not say. labels: name -> how readers see it.
    """

    results: dict[str, Results]
    published: dict[str, pd.DataFrame]
    artefacts: dict[str, dict]
    functions: dict[str, Any]
    variant_of: dict[str, str]
    paired: dict[str, bool]
    repeats: dict[str, int]
    labels: dict[str, str]


class Untestable(Exception):
    """Why a check cannot be judged."""
