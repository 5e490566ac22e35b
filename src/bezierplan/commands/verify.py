"""Check all results of a scale again, from runs to page."""

import platform
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path

from bezierplan.analysis.jobs import Job, Runs
from bezierplan.analysis.outcome import proof
from bezierplan.commands import config_of, cores, study_named
from bezierplan.machine import opened
from bezierplan.places import relative
from bezierplan.running import recheck
from bezierplan.study import reading, stored
from bezierplan.study.jobs import Studies


def main(
    folder: Path,
    *,
    studies: Sequence[str] = (),
    cores: int = cores(),
    all_: bool = False,
) -> None:
    """Print a line for each stored value or file that differs from what is made again, what was
    checked, and the answer: `made by this code`, `made by other code or libraries`, or `differs`.

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
    places = stored.places_of(folder, config_of(), map(study_named, studies))
    config = proof.narrowed(config_of(), [*places.values()])
    loaded = reading.load(reading.read_config(config))
    listed = proof.listed(folder)
    made = _jobs(loaded, listed, folder)
    changes = _changes(made, listed)
    left = stored.strangers(folder, made)
    wrong: dict[str, recheck.Difference] = {}

    def add(faults: Iterable[recheck.Difference]) -> None:
        for fault in faults:
            wrong.setdefault(fault.file, fault)

    add(proof.unlisted(folder, listed))
    tasks = [*_tasks(loaded, made, changes, folder)]
    verdict = recheck.verify(tasks, cores, progress)
    add(verdict.faults)
    again = recheck.made_again(tasks, wrong, cores, verdict.digest, all_)
    progress(f"{again.runs} runs made again")
    files, faults = proof.differing(folder, left, config, listed.studies, cores)
    add((*again.faults, *faults))
    words = _in_words(changes, listed)
    versions = (f"{name} {version}" for name, version in recheck.versions().items())
    answer = f"made by other code or libraries ({words})" if words else "made by this code"
    print(
        *(f"{fault}{_since(fault, changes, folder)}" for fault in wrong.values()),
        *(f"{file}: nothing makes it; delete it" for file in left),
        f"{verdict.runs} runs in {verdict.files} files: {verdict.paths} different paths judged "
        f"again; digest {verdict.digest}",
        f"verified with {', '.join(versions)}",
        f"differs: {len(wrong)} files; {answer}"
        if wrong
        else f"{answer}: {again.runs} runs and {files} files made again, all equal",
        sep="\n",
    )
    if wrong or left:
        sys.exit(1)


def _jobs(studies: Studies, listed: proof.Listed, folder: Path) -> dict[str, Job]:
    """Return the job that makes each file of a scale. What shows several studies shows those of
    its list.
    """
    together = {key: studies[key] for key in studies if key in listed.studies} or studies
    found = {}
    for make, names, files in stored.made(studies, folder.resolve().name, f"{folder}/../"):
        job = stored.build_job(studies if "study" in names else together, make, names)
        found.update(dict.fromkeys(files, job))
    return found


def _changes(made: Mapping[str, Job], listed: proof.Listed) -> dict[str, set[str]]:
    """Return what of the accounts of listed files is not that of their jobs, by file, in words."""
    found = {}
    for file, account in listed.accounts.items():
        now = made[file].account | opened.contents(account) if file in made else {}
        found[file] = {
            f"{name} {account.get(name)} -> {now.get(name)}" if name in listed.versions else name
            for name in account.keys() | now
            if account.get(name) != now.get(name)
        }
    return found


def _tasks(
    studies: Studies, made: Mapping[str, Job], changes: Mapping[str, set[str]], folder: Path
) -> Iterator[recheck.StoredRuns]:
    """Yield the runs of each method in an experiment of which there are some."""
    of_methods: dict[Path, dict[str, Runs]] = {}
    for file, job in made.items():
        place = folder / file
        if isinstance(job, Runs) and place.stem.isdecimal() and place.parent.is_dir():
            of_methods.setdefault(place.parent, {})[str(place)] = job
    for place, runs in of_methods.items():
        key, _, experiment, _ = place.relative_to(folder).parts
        names = {name for file in runs for name in changes.get(file.removeprefix(f"{folder}/"), ())}
        yield recheck.StoredRuns(
            str(folder / key / "problems" / f"{experiment}.parquet"),
            {file: job.chunk for file, job in runs.items()},
            relative(studies[key].folder / "experiments.yaml") if "settings" in names else "",
        )


def _in_words(changes: Mapping[str, set[str]], listed: proof.Listed) -> str:
    """Return what of the accounts of all files is another now, in words; empty if nothing is."""
    if not listed.accounts:
        return f"no {proof.LIST} says which"
    # The list holds all accounts, so that each change is one of its settings.
    names = set().union(*(changes[file] for file in changes if file != proof.LIST))
    python, now = listed.versions["python"], platform.python_version()
    if names and python != now:
        names.add(f"python {python} -> {now}")
    return ", ".join(sorted(names or changes[proof.LIST]))


def _since(fault: recheck.Difference, changes: Mapping[str, set[str]], folder: Path) -> str:
    """Return what has changed since the file of a fault was made."""
    changed = ", ".join(sorted(changes.get(fault.file.removeprefix(f"{folder}/"), ())))
    return f"; since it was made, other: {changed}" if changed else ""
