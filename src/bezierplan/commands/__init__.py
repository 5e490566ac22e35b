"""The commands of `python -m bezierplan`, one file each.

The function `main` of a command is the declaration of its arguments: a parameter without a default
is a word, one with a default an option, and its docstring explains them. `PASSES_ON` of a command
holds functions of the interface whose options are the command's as well.
"""

import os
import sys

from bezierplan.places import TREE

SNAKEMAKE = [sys.executable, "-m", "snakemake", "--snakefile", str(TREE / "Snakefile")]
"""The beginning of a command that starts the workflow."""


def cores() -> int:
    """How many cores this process may use, all of this machine where that is not known."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
