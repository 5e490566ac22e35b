"""One file per kind of test.

Every file has `Options`, the keys that a check of this kind may have. A kind that judges runs (its
`Options` are `OfRuns`) also has

- `compute_effect(points, cells)`: the effects (...) of point values (..., k) of the cells, whether
  they are ours, printed or drawn
- `compute_gradient(ours, cells)`: how the effect changes with each value (k,), None without a
  linear approximation; of kinds with a margin alone
- `is_as_claimed(effects, margin)`: whether each effect (...) is what the claim says
- `list_cells(rows)`: the cells of each comparison, with its `effects.Terms`, among the runs of one
  place
- `find(comparison, name)`: the `effects.Finding` of a comparison; all random draws are seeded by
  the name

and any other kind `judge(claim, material)`: terms and finding of each comparison; it raises
`Untestable` if there is nothing to judge. All p are two-sided and all intervals 95 %, by bootstrap
over units within each condition; above `statistics.MOST_RESAMPLED` units by its normal
approximation.

Options are read at every start of the workflow, so these files import scipy and pandas inside the
functions that need them.
"""

import importlib
from functools import cache
from pathlib import Path

from bezierplan.analysis.claims.check import ClaimCheck


@cache
def list_kinds() -> dict[str, type[ClaimCheck]]:
    """List all kinds of test, each with the options of its checks."""
    names = sorted(file.stem for file in Path(__file__).parent.glob("[!_]*.py"))
    return {name: importlib.import_module(f"{__name__}.{name}").Options for name in names}
