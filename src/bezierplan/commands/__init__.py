"""The commands of `python -m bezierplan`, one file each.

The function `main` of a command declares its arguments: a parameter without a default is a word,
one with a default an option, and the docstring explains them. `PASSES_ON` of a command lists
functions of the interface whose options are the command's as well.
"""

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from bezierplan.schema import checked


def count_cores() -> int:
    """Return how many cores this process may use; all of this machine where that is not known."""
    # A container or a batch system may allow fewer cores than the machine has.
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def read_config() -> dict[str, Any]:
    """Read the configuration in config/config.yaml of the working folder, otherwise of the
    project.
    """
    from bezierplan.study import loading

    return checked.read(loading.find_config_file())


def is_study(word: str) -> bool:
    """Return whether a word is the folder of a study."""
    return Path(word, "experiments.yaml").is_file()


def find_study_path(word: str) -> str:
    """Return the path of a study's folder, or any other word as it is."""
    # An absolute path, because a word without a slash names a study of the project.
    return str(Path(word).resolve()) if is_study(word) else word


def read_studies(names: Sequence[str] = ()) -> dict[str, Any]:
    """Return the studies of some names or folders, otherwise those of the configuration. Raises
    Fault.
    """
    from bezierplan.study import loading

    config = {"studies": [*map(find_study_path, names)]} if names else read_config()
    return loading.load(loading.read_config(config))
