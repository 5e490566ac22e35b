"""The commands of `python -m bezierplan`, one file each: `main` adds its arguments to a parser,
parses the words, and runs.
"""

import sys
from argparse import ArgumentParser

from bezierplan.places import TREE

SNAKEMAKE = [sys.executable, "-m", "snakemake", "--snakefile", str(TREE / "Snakefile")]
"""The beginning of a command that starts the workflow."""


def add_studies(parser: ArgumentParser) -> None:
    """Let a command use studies other than those in config/config.yaml."""
    text = (
        "studies instead of those of config/config.yaml: "
        "names of folders in config/studies, or paths"
    )
    parser.add_argument("--studies", nargs="+", metavar="STUDY", help=text)
