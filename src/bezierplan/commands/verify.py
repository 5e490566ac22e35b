"""Check all results of a scale again, from runs to page."""

import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any, NoReturn

from bezierplan.analysis.outcome import proof
from bezierplan.commands import config_of, cores, studies_of, study_named
from bezierplan.running import recheck
from bezierplan.study import stored


def main(
    folder: Path,
    *,
    studies: Sequence[str] = (),
    cores: int = cores(),
    all_: bool = False,
) -> None:
    """Print a line for each stored value or file that differs from what is made again, and what was
    checked: runs are judged again; the first run of each file and one in a hundred, bounds and all
    files that follow from runs are made again, by the code that made the runs.

    Ends with status 1 if anything differs. Raises ValueError or FileNotFoundError for a folder
    without results or a file that cannot be read.

    Parameters
    ----------
    folder : Path
        the folder of a scale, such as results/full
    studies : list of str
        where a study lies that is neither in config/config.yaml nor in the working folder
    cores : int
        processes (default: all cores)
    all_ : bool
        make all runs again

    Examples
    --------
    verify results/full --cores 2
    """
    if cores < 1:
        raise ValueError(f"cores: {cores}; expected a number of at least 1")
    progress = partial(print, file=sys.stderr, flush=True)
    config = config_of()
    places = stored.places_of(folder, config, map(study_named, studies))
    loaded = studies_of([*places.values()]) if places else {}
    tasks, left = stored.tasks(loaded, folder), stored.of_nothing(loaded, folder)
    faults = proof.unlisted(folder)
    missing = [fault for fault in faults if not Path(fault.file).is_file()]
    if missing:
        _fail(*missing, f"{len(missing)} files are missing")
    try:
        verdict = recheck.verify(tasks, cores, progress)
    except ValueError as fault:
        # What cannot be read may have been told already.
        if not faults:
            raise
        _fail(*faults, fault)
    faults += verdict.faults
    lines = [f"{file}: of no table, figure or runs; delete it" for file in left]
    lines += [
        f"{verdict.runs} runs in {verdict.files} files: {verdict.paths} different paths judged "
        "again"
    ]
    if not faults:
        again = recheck.made_again(tasks, cores, verdict.digest, all_)
        faults = again.faults
        progress(f"{again.runs} runs made again, {len(faults)} faults")
        lines.append(f"{again.runs} runs made again")
    if not faults:
        files, faults = proof.differing(folder, left, config, places, cores)
        lines.append(f"{files} files made again")
    versions = (f"{name} {version}" for name, version in recheck.versions().items())
    lines.append(f"digest {verdict.digest}; {', '.join(versions)}")
    but = f" but for {len(left)} files that nothing makes" if left else ""
    lines.append(f"{len(faults)} values differ" if faults else f"sound{but}")
    if faults or left:
        _fail(*faults, *lines)
    print(*lines, sep="\n")


def _fail(*lines: Any) -> NoReturn:
    """End with status 1: something differs."""
    print(*lines, sep="\n")
    sys.exit(1)
