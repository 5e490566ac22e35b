"""Are the files of a scale those that its list names, and do they follow from its runs? They are
made again in a folder of their own.
"""

import json
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import bezierplan
from bezierplan.places import TREE
from bezierplan.running.recheck import Difference, compute_sha256

LIST, PAGE = "verified.json", "index.html"
"""The file that lists the digests of all others, and the page that names its own."""

# Rules of all that follows from runs; runs themselves are not made again.
_RULES = (
    "problems",
    "bounds",
    "table",
    "unprinted_table",
    "listing",
    "latex",
    "figure",
    "claims",
    "claims_of_reading",
    "audit",
    "methods",
    "summary",
    "page",
)


class FileList(NamedTuple):
    """The content of the list of a scale.

    digests: of files, by name. accounts: of the job that made each. versions: of libraries. fault:
    empty, or the line that says what is wrong with the list.
    """

    digests: Mapping[str, str] = {}
    accounts: Mapping[str, Mapping[str, str]] = {}
    versions: Mapping[str, str] = {}
    fault: str = ""


def read_list(folder: Path) -> FileList:
    """Read the list of a scale; empty if there is none, or none that can be read."""
    file, page = folder / LIST, folder / PAGE
    text = page.read_text(encoding="utf-8") if page.is_file() else ""
    if not file.is_file():
        return FileList(fault="is not there, though a page is" if text else "")
    try:
        content = json.loads(file.read_text(encoding="utf-8"))
        accounts = {name: account for files, account in content["accounts"] for name in files}
        found = FileList(dict(content["sha256"]), accounts, dict(content["versions"]))
    except (KeyError, TypeError, ValueError):
        return FileList(fault="not a list of digests")
    # The page holds the digest of its list, so a list of another page is told.
    if text and compute_sha256(file) not in text:
        return found._replace(fault=f"not the list that {PAGE} names")
    return found


def find_changed_files(folder: Path, file_list: FileList) -> list[Difference]:
    """Find the files of a scale that are not what its list says; the list alone, if it is wrong."""
    if file_list.fault:
        return [Difference(str(folder / LIST), file_list.fault)]
    now = {name: compute_sha256(folder / name) for name in file_list.digests}
    return [
        Difference(str(folder / name), "was changed since" if now[name] else "is not there")
        for name, digest in file_list.digests.items()
        if digest != now[name]
    ]


def describe_version() -> str:
    """Describe the version of this package, in a clone with the commit and its date."""
    version = f"bezierplan {bezierplan.__version__}"
    if not (TREE / ".git").exists():
        return version
    command = ["git", "-C", str(TREE), "log", "-1", "--format=%h of %cs"]
    try:
        found = subprocess.run(command, capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):  # such as no git, or another user's clone
        return version
    return f"{version}, commit {found.stdout.strip()}"


def keep_studies(config: dict[str, Any], studies: list[str]) -> dict[str, Any]:
    """Return a configuration with some of its studies alone, given by name or folder."""
    names = {Path(study).resolve().name for study in studies}
    settings = {name: each for name, each in config.get("settings", {}).items() if name in names}
    return config | {"studies": studies, "settings": settings}


def find_differences(
    folder: Path,
    made: Mapping[str, bool],
    config: dict[str, Any],
    file_list: Collection[str],
    processes: int,
) -> tuple[int, list[Difference]]:
    """Make again all files that follow from studies and runs; return how many they are, and which
    of them are others, or cannot be made.

    made: the files of a scale, and whether they follow. config: with its studies. file_list: files
    of its list, to whose studies belongs what lies above all of them.
    """
    places = {Path(study).resolve().name: study for study in config["studies"]}
    known = {name.split("/")[0] for name in file_list}
    shown = [key for key in places if key in known] or [*places]
    faults = []
    with tempfile.TemporaryDirectory() as away:
        # Rules know the files of a scale by their place below `results`.
        again = Path(away, "results", folder.resolve().name)
        there = [name for name in made if (folder / name).is_file()]
        for name in there:
            (again / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(folder / name, again / name)
        files = [name for name in there if made[name]]
        # Files above the studies depend on all that the page shows, so these are made together.
        for group in (shown, *([key] for key in places if key not in shown)):
            own = [
                again / name
                for name in files
                if (name.split("/")[0] if "/" in name else shown[0]) in group
            ]
            studies = keep_studies(config, [places[key] for key in group])
            faults += [
                Difference(line, "what follows cannot be made again")
                for line in _make_again(own, studies, away, processes)
            ]
        faults += [
            Difference(str(folder / name), "made again, it is another one")
            for name in files
            if (again / name).is_file()
            and compute_sha256(again / name) != compute_sha256(folder / name)
        ]
    return len(files), faults


def _make_again(files: list[Path], config: dict[str, Any], away: str, processes: int) -> list[str]:
    """Make files below a folder again, which follow from the studies of a configuration, and return
    what went wrong.
    """
    workflow = Path(away, "Snakefile")
    workflow.write_text(
        f"module again:\n    snakefile: {str(TREE / 'workflow' / 'Snakefile')!r}\n"
        f"    config: {config!r}\n"
        f"    prefix: {away!r}\n\nuse rule * from again\n\n"
        # Snakemake skips a module's onstart. Without this line it looked for new jobs 13,000 times
        # while it made 180 of them (`workflow/Snakefile` says why).
        "onstart:\n    workflow.scheduler.job_rate_limiter = None\n"
    )
    done = subprocess.run(
        [
            *(sys.executable, "-m", "snakemake", "--snakefile", workflow, "--forceall"),
            # The copies are thrown away, so nothing of them is to be remembered.
            # With --keep-going all that cannot be made is told, and not the first of it alone.
            *("--cores", str(processes), "--nolock", "--drop-metadata", "--keep-going"),
            # A profile might send the jobs to a cluster, from where the copies cannot be seen.
            # The usual scheduler would solve a linear program after each job.
            *("--workflow-profile", "none", "--scheduler", "greedy"),
            *("--allowed-rules", *_RULES, "--"),
            *files,
        ],
        capture_output=True,
        text=True,
    )
    if not done.returncode:
        return []
    printed = (done.stdout + done.stderr).replace(f"{away}/", "")
    lines = [line.strip() for line in printed.splitlines()]
    told = [line.partition(" (full account:")[0] for line in lines if "full account:" in line]
    # Snakemake ends with the files that a rule lacks.
    return [*dict.fromkeys(told)] or [line for line in lines if line][-1:]
