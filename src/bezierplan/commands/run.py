"""The workflow from any folder: `python -m bezierplan run STUDY ...` starts Snakemake with this
package's Snakefile and profile.
"""

import json
import os
import signal
import subprocess
import sys
from argparse import ArgumentParser, RawDescriptionHelpFormatter
from pathlib import Path

from bezierplan.commands import SNAKEMAKE
from bezierplan.places import TREE
from bezierplan.running import forks
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
    from snakemake.cli import get_argument_parser, parse_config
    from snakemake.common import get_appdirs
    from snakemake.exceptions import CliException

    started = command(words)
    theirs = get_argument_parser()
    theirs.error = parser.error  # in one line, where Snakemake prints all its options
    # What Snakemake tells in a traceback, before it reads a workflow.
    try:
        given = theirs.parse_args(started[3:])
    except CliException as fault:
        raise Fault(f"--cores: {fault}") from None
    try:
        parse_config(given.config)
    except ValueError as fault:
        raise Fault(f"--config: {fault}") from None
    _check_cache(Path(get_appdirs().user_cache_dir))
    workflow = subprocess.Popen(
        started,
        stdout=forks.stream_for(sys.stdout),
        stderr=forks.stream_for(sys.stderr),
        process_group=0,
    )
    signal.signal(signal.SIGTERM, lambda *_: workflow.terminate())
    try:
        sys.exit(workflow.wait())
    except KeyboardInterrupt:
        # As a terminal does, to the workflow and its jobs.
        os.killpg(workflow.pid, signal.SIGINT)
        workflow.wait()
        raise


def _check_cache(folder: Path) -> None:
    """Raise Fault if Snakemake cannot keep a cache in a folder."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as fault:
        raise Fault(
            f"{folder}: cannot be made ({fault.strerror}), and Snakemake keeps its cache there; "
            "expected HOME, or XDG_CACHE_HOME, to be a folder that can be written"
        ) from None


def command(words: list[str]) -> list[str]:
    """The command that runs words."""
    folders = [
        Path(word).resolve() for word in words if (Path(word) / "experiments.yaml").is_file()
    ]
    others = [word for word in words if not (Path(word) / "experiments.yaml").is_file()]
    studies = ["--config", f"studies={json.dumps(list(map(str, folders)))}"] if folders else []
    profile = ["--workflow-profile", str(TREE / "profiles" / "default")]
    return [*SNAKEMAKE, *profile, *others, *studies]
