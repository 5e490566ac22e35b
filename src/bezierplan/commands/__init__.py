"""The commands of `python -m bezierplan`, one file each.

The function `main` of a command is the declaration of its arguments: a parameter without a default
is a word, one with a default an option, and its docstring explains them. `PASSES_ON` of a command
holds functions of the interface whose options are the command's as well.
"""

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from bezierplan.schema import checked


def count_cores() -> int:
    """How many cores this process may use, all of this machine where that is not known."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def read_config() -> dict[str, Any]:
    """The configuration in config/config.yaml: of the working folder, or of the project."""
    from bezierplan.study import reading

    return checked.read(reading.find_config_file())


def is_study(word: str) -> bool:
    """Whether a word is the folder of a study."""
    return Path(word, "experiments.yaml").is_file()


def find_study_path(word: str) -> str:
    """The path of a study's folder; any other word as it is."""
    return str(Path(word).resolve()) if is_study(word) else word


def read_studies(names: Sequence[str] = ()) -> dict[str, Any]:
    """Return the studies of some names or folders, or of the configuration. Raises Fault."""
    from bezierplan.study import reading

    config = {"studies": [*map(find_study_path, names)]} if names else read_config()
    return reading.load(reading.read_config(config))
