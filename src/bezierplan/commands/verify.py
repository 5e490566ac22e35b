"""Check all results of a scale again, from runs to page."""

import sys
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path

from bezierplan.analysis import naming
from bezierplan.analysis.jobs import Job, Recheck, Runs, Verification
from bezierplan.analysis.outcome import verification
from bezierplan.commands import count_cores, find_study_path, read_config
from bezierplan.machine import opened_files
from bezierplan.places import shorten_path
from bezierplan.running import recheck
from bezierplan.study import loading, stored
from bezierplan.study.jobs import Studies

# These jobs are not made again as a whole: their files do not follow from others, or take minutes.
_KEPT = (Runs, Recheck, Verification)


def main(
    folder: Path,
    *,
    studies: Sequence[str] = (),
    cores: int = count_cores(),
    all_: bool = False,
) -> None:
    """Print a line for each file that differs from what is made again, then what was checked, and
    the answer: `made by this code`, `made by other code or libraries`, or `differs`.

    Runs are judged again; the first run of each file and one in a hundred, bounds and all files
    that follow from runs are made again. Ends with status 1 if anything differs, or nothing makes a
    file. Raises ValueError or FileNotFoundError for a folder without results.

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
    places = stored.read_places(folder, read_config(), map(find_study_path, studies))
    config = verification.keep_studies(read_config(), [*places.values()])
    at = stored.list_places(loading.load(loading.read_config(config)))
    contents = verification.read_list(folder)
    makers = stored.find_jobs(at, folder, contents.digests)
    changes = {
        file: _find_changes(makers.get(file), contents.accounts[file]) for file in contents.accounts
    }
    tasks = _list_tasks(at, makers, changes, folder)
    verdict = recheck.verify(tasks, cores, progress)
    faults = [*verification.find_changed_files(folder, contents), *verdict.faults]
    again = recheck.run_again(tasks, {fault.file for fault in faults}, cores, verdict.digest, all_)
    progress(f"{again.runs} runs made again")
    follow = {name: not isinstance(makers[name], _KEPT) for name in makers}
    files, others = verification.find_differences(folder, follow, config, contents.digests, cores)
    wrong: dict[str, recheck.Difference] = {}
    for fault in (*faults, *again.faults, *others):
        # One line for each file: its first fault. What cannot be made from it is no other one.
        if not any(file in fault.file for file in wrong):
            wrong[fault.file] = fault
    left, versions = stored.find_strangers(folder, makers), recheck.read_versions()
    # The list holds all accounts, so that each change is one of its own.
    names = set().union(*(changes[file] for file in changes if file != verification.LIST))
    names = names or changes.get(verification.LIST, {f"no {verification.LIST} says by which"})
    moved = [
        f"{name} {before} -> {versions.get(name)}"
        for name, before in contents.versions.items()
        if names and versions.get(name) != before
    ]
    words = ", ".join([*sorted(names - versions.keys()), *moved])
    answer = f"made by other code or libraries ({words})" if words else "made by this code"
    if left:
        answer = f"nothing makes {naming.format_count(len(left), 'file')}; the others: {answer}"
    print(
        *wrong.values(),
        *(f"{file}: nothing makes it; delete it" for file in left),
        f"{verdict.runs} runs in {verdict.files} files: {verdict.paths} different paths judged "
        f"again; digest {verdict.digest}",
        f"verified with {', '.join(map(' '.join, versions.items()))}",
        f"differs: {naming.format_count(len(wrong), 'file')}; {answer}"
        if wrong
        else f"{answer}: {again.runs} runs and {files} files made again, all equal",
        sep="\n",
    )
    if wrong or left:
        sys.exit(1)


def _find_changes(job: Job | None, account: Mapping[str, str]) -> set[str]:
    """Return the names in which a listed file's account differs from that of its job now."""
    now = job.account | opened_files.hash_contents(account) if job else {}
    return {name for name in account.keys() | now if account.get(name) != now.get(name)}


def _list_tasks(
    at: Studies, makers: Mapping[str, Job], changes: Mapping[str, set[str]], folder: Path
) -> list[recheck.StoredRuns]:
    """Return the stored runs to check, for each method of an experiment that has any.

    at: place of results -> study.
    """
    tasks: dict[Path, recheck.StoredRuns] = {}
    for name, job in makers.items():
        file = folder / name
        if isinstance(job, Runs) and file.stem.isdecimal() and file.parent.is_dir():
            place, experiment = name.partition("/runs/")[0], job.chunk.experiment
            home = stored.find_home(at, place, folder.resolve().name, experiment)
            changed = shorten_path(at[place].folder / "experiments.yaml")
            task = recheck.StoredRuns(
                str(folder / home / "problems" / f"{experiment}.parquet"),
                {},
                changed if "settings" in changes.get(name, ()) else "",
            )
            tasks.setdefault(file.parent, task).runs[str(file)] = job.chunk
    return [*tasks.values()]
