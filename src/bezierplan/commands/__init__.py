"""The commands of `python -m bezierplan`, one file each: `main` adds its arguments to a parser,
parses the words, and runs.
"""

import os
import sys
from argparse import ArgumentParser
from typing import Any

from bezierplan.places import TREE
from bezierplan.schema import checked

SNAKEMAKE = [sys.executable, "-m", "snakemake", "--snakefile", str(TREE / "Snakefile")]
"""The beginning of a command that starts the workflow."""


def cores() -> int:
    """How many cores this process may use, all of this machine where that is not known."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def add_studies(parser: ArgumentParser) -> None:
    """Let a command use studies other than those in config/config.yaml."""
    text = (
        "studies instead of those of config/config.yaml: "
        "names of folders in config/studies, or paths"
    )
    parser.add_argument("--studies", nargs="+", metavar="STUDY", help=text)


def settings_in(text: str) -> dict[str, Any]:
    """Parse the settings that a command is given as YAML text. Raises Fault."""
    settings = checked.parse(text, "--settings")
    if not isinstance(settings, dict):
        raise checked.Fault(f"--settings: {text}: expected '{{name: value, ...}}'")
    return settings


def of_study(name: str, method: str, location: str) -> tuple[str, dict[str, Any]]:
    """The planner and settings of a study's method. Raises Fault, beginning with a location for one
    that the study does not have.
    """
    from bezierplan.study import reading

    (study,) = reading.load(reading.read_config({"studies": [name]})).values()
    checked.check_known(method, study.methods, location)
    return study.planner(method), study.resolved(method)
