"""Tables without runs: what a paper prints besides its results, and what a study's function
computes.
"""

from collections.abc import Callable, Mapping

import pandas as pd

from bezierplan.analysis.results import read_published_table
from bezierplan.analysis.table_kinds import FunctionTable, Transcript


def build_listing(
    spec: Transcript | FunctionTable,
    files: Mapping[str, str],
    functions: Mapping[str, Callable[..., pd.DataFrame]],
) -> pd.DataFrame:
    """Build a table without runs: a transcribed one (every cell as written), or that of a function
    (called with all published tables by file name, and with its arguments).

    files: of published numbers, by table; for a transcribed table its only file.
    """
    if isinstance(spec, Transcript):
        (file,) = files.values()
        return pd.read_csv(file, dtype=str, keep_default_na=False)
    published = {name: read_published_table(file) for name, file in files.items()}
    return functions[spec.function](published, **spec.arguments)
