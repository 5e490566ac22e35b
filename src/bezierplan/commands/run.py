"""Run targets of the workflow, from any folder: starts Snakemake with this package's Snakefile and
profile.
"""

import importlib
import json
import os
import signal
import subprocess
import sys
from collections.abc import Sequence
from itertools import pairwise

from bezierplan.commands import find_study_path, is_study
from bezierplan.places import TREE
from bezierplan.running.jobs import forks
from bezierplan.running.jobs.watchdog import end_with_parent
from bezierplan.schema import checked
from bezierplan.schema.checked import Fault
from bezierplan.schema.model import convert_to_list


def main(*words: str) -> None:
    """Run targets of the workflow; results are written below the working folder, into results/.

    If no target is given, it makes the tables and figures of papers, or all of a study without
    numbered ones, at scale full, with claims and the page; STUDY_beyond makes the rest. Ends with
    Snakemake's status.

    Parameters
    ----------
    *words : str
        a folder of a study, which takes the place of the project's studies; other words go to
        Snakemake: targets such as song2016_figure4, and options such as -n

    Examples
    --------
    run mystudy
    run song2016_figure4 --cores 2
    """
    if not words:
        raise Fault("expected a word, such as the folder of a study; run --help shows examples")
    importlib.import_module("snakemake")  # or else it is told what to install
    out, err = map(forks.choose_stream, (sys.stdout, sys.stderr))
    workflow = subprocess.Popen(
        build_command(words), stdout=out, stderr=err, process_group=0, preexec_fn=end_with_parent
    )
    # So Snakemake can end its jobs itself: it would be killed with this process.
    signal.signal(signal.SIGTERM, lambda *_: workflow.terminate())
    try:
        sys.exit(workflow.wait())
    except KeyboardInterrupt:
        # The workflow and its jobs are a group of their own, which a terminal's Ctrl-C does not
        # reach.
        os.killpg(workflow.pid, signal.SIGINT)
        workflow.wait()
        raise


def build_command(words: Sequence[str]) -> list[str]:
    """Return the command line of Snakemake for the words of this command."""
    if any(word.startswith("--scale") for word in words):
        raise Fault("--scale: expected a target in its place: smoke, all (scale full) or extended")
    snakemake = [sys.executable, "-m", "snakemake"]
    if not any(word.startswith("--workflow-profile") for word in words):
        # Snakemake would print a line about a profile each time.
        profile = checked.read(TREE / "profiles" / "default" / "profile.yaml")
        snakemake += ["--workflow-profile", "none"]
        for name, value in profile.items():
            snakemake += [f"--{name}", *([] if value is True else convert_to_list(value))]
    # A word that stands there again is a target: a folder may have the name of one.
    folders = {word: find_study_path(word) for word in words if is_study(word)}
    for before, word in pairwise(["", *words]):
        # Neither an option, nor perhaps its value, nor a file of the results.
        is_target = not before.startswith("-") and not word.startswith(("-", "results/"))
        if is_target and "/" in word and word not in folders:
            raise Fault(f"{word}: expected the folder of a study, with a file experiments.yaml")
    others = [*words]
    for word in folders:
        others.remove(word)
    config = ["--config", f"studies={json.dumps([*folders.values()])}"] if folders else []
    # Other options before this one could take targets for their values.
    return [*snakemake, "--snakefile", str(TREE / "Snakefile"), *others, *config]
