"""The workflow from any folder: `python -m bezierplan run STUDY ...` starts Snakemake with this
package's Snakefile and profile.
"""

import json
import subprocess
import sys
from argparse import ArgumentParser, RawDescriptionHelpFormatter
from pathlib import Path

from bezierplan.commands import SNAKEMAKE
from bezierplan.places import TREE
from bezierplan.schema.checked import Fault

MANUAL = """
Runs targets of the workflow; results are written below the working folder, into results/. A word
that is the folder of a study takes the place of the project's studies. Other words go to Snakemake:
targets such as song2016_figure4, and options such as --cores 2 or -n. Without a target it makes
everything at scale full.

examples:
    python -m bezierplan run mystudy
    python -m bezierplan run song2016_figure4 --cores 2
"""


def main(parser: ArgumentParser, words: list[str]) -> None:
    """Start Snakemake and end with its status. Raises Fault if no word is given."""
    parser.formatter_class, parser.description = RawDescriptionHelpFormatter, MANUAL.strip()
    parser.add_argument(
        "words",
        nargs="*",
        metavar="WORD",
        help="a folder of a study, a target, or an option of Snakemake",
    )
    words = parser.parse_known_args(words)[0] and words
    if not words:
        raise Fault(
            "expected at least one word, such as the folder of a study; bezierplan run --help "
            "shows examples"
        )
    # Here its absence is told as that of the extra.
    from snakemake.cli import get_argument_parser, parse_cores
    from snakemake.exceptions import CliException

    started = command(words)
    theirs = get_argument_parser()
    theirs.error = parser.error  # in one line, where Snakemake prints all its options
    try:
        parse_cores(theirs.parse_args(started[3:]).cores)
    except CliException as fault:
        raise Fault(f"--cores: {fault}") from None
    ended = subprocess.run(started, check=False)
    sys.exit(ended.returncode)


def command(words: list[str]) -> list[str]:
    """The command that runs words."""
    folders = [
        Path(word).resolve() for word in words if (Path(word) / "experiments.yaml").is_file()
    ]
    others = [word for word in words if not (Path(word) / "experiments.yaml").is_file()]
    studies = ["--config", f"studies={json.dumps(list(map(str, folders)))}"] if folders else []
    profile = ["--workflow-profile", str(TREE / "profiles" / "default")]
    return [*SNAKEMAKE, *profile, *others, *studies]
