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


def cores() -> int:
    """How many cores this process may use, all of this machine where that is not known."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def config_of() -> dict[str, Any]:
    """The configuration in config/config.yaml: of the working folder, or of the project."""
    from bezierplan.study import reading

    return checked.read(reading.config_file())


def is_study(word: str) -> bool:
    """Whether a word is the folder of a study."""
    return Path(word, "experiments.yaml").is_file()


def study_named(word: str) -> str:
    """The path of a study's folder; any other word as it is."""
    return str(Path(word).resolve()) if is_study(word) else word


def studies_of(names: Sequence[str] = ()) -> dict[str, Any]:
    """The studies of some names or folders, or of the configuration (`config_of`). Raises Fault."""
    from bezierplan.study import reading

    config = {"studies": [*map(study_named, names)]} if names else config_of()
    return reading.load(reading.read_config(config))
