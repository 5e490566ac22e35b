"""Tables that show no runs: what a paper prints beside its results, and what a study's function computes."""

from collections.abc import Callable, Mapping
from pathlib import Path

import pandas as pd


def table(spec: dict, published: list[str], functions: Mapping[str, Callable[[dict[str, pd.DataFrame]], pd.DataFrame]]) -> pd.DataFrame:
    """A table of kind `transcribed`, every cell as it is written, or of kind `function`, called with all published tables by file name.

    published: the files, of a transcribed table its one.
    """
    if spec["kind"] == "transcribed":
        (file,) = published
        return pd.read_csv(file, dtype=str, keep_default_na=False)
    return functions[spec["function"]]({Path(file).stem: pd.read_csv(file) for file in published})
