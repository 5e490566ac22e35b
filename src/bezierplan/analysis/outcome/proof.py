"""Do all files of a scale follow from its runs? They are made again in a folder of their own."""

import json
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from bezierplan.places import TREE
from bezierplan.running import rows
from bezierplan.running.recheck import Difference, sha256

LIST = "verified.json"
"""The file that lists the digests of all others."""

_FOLLOW = (
    "*/problems/*.parquet",
    "*/paper/*",
    "*/beyond/*",
    "*/*.csv",
    "*/verdict.md",
    "*.csv",
    "index.html",
)
"""Files that follow from the studies and from runs."""
_ENDINGS = {".csv", ".tex", ".md", ".html", ".parquet"}
"""Those by which Snakemake is asked for all of them."""
_RULES = (
    "problems",
    "bounds",
    "table",
    "unprinted_table",
    "listing",
    "latex",
    "figure",
    "claims",
    "audit",
    "baseline_comparison",
    "summary",
    "verdict",
    "page",
)


def _listed(folder: Path) -> dict[str, str]:
    """The list of digests; empty without one. Raises ValueError for a list that is none."""
    file = folder / LIST
    try:
        return dict(json.loads(file.read_text())["sha256"]) if file.is_file() else {}
    except (KeyError, TypeError, ValueError):
        raise rows.misplaced(str(file), "not a list of digests") from None


def unlisted(folder: Path) -> list[Difference]:
    """Files that are not what the list of digests says; none without a list, which only a page
    needs. Raises ValueError for a list that is none.
    """
    listed = _listed(folder)
    if not listed and (folder / "index.html").is_file():
        return [Difference(str(folder / LIST), "all bytes", "SHA-256", "no file", "a list")]
    return _changed(folder, listed, folder)


def _changed(folder: Path, digests: dict[str, str], again: Path) -> list[Difference]:
    """Files of a folder whose digests are not those of the files of the same name in another."""
    found = {name: sha256(again / name) or "no file" for name in digests}
    return [
        Difference(str(folder / name), "all bytes", "SHA-256", digests[name], found[name])
        for name in digests
        if digests[name] != found[name]
    ]


def differing(
    folder: Path,
    left: list[Path],
    config: dict[str, Any],
    places: dict[str, str],
    processes: int,
) -> tuple[int, list[Difference]]:
    """How many files follow from studies and runs, and which of them are others if they are
    made again. left: files that nothing makes. places: of the studies. Raises ValueError if that
    fails.
    """
    with tempfile.TemporaryDirectory() as away:
        again = Path(away, "results", folder.resolve().name)
        shutil.copytree(folder, again, ignore=shutil.ignore_patterns("logs"))
        for file in left:
            (again / file.relative_to(folder)).unlink()
        files = [file for pattern in _FOLLOW for file in sorted(again.glob(pattern))]
        before = {str(file.relative_to(again)): sha256(file) for file in files}
        # What lies above all studies is of those that the list names.
        listed = {name.split("/")[0] for name in _listed(folder)}
        shown = [key for key in places if key in listed] or [*places]
        whole = [*shown, *(file.name for file in files if file.parent == again)]
        for group in [whole, *([key] for key in places if key not in shown)]:
            own = [file for file in files if file.relative_to(again).parts[0] in group]
            studies = [places[key] for key in places if key in group]
            _make(own, config, studies, away, processes)
        return len(files), _changed(folder, before, again)


def _make(
    files: list[Path], config: dict[str, Any], studies: list[str], away: str, processes: int
) -> None:
    """Make files below a folder again, which follow from some studies. Raises ValueError."""
    names = {Path(study).resolve().name for study in studies}
    settings = {name: each for name, each in config.get("settings", {}).items() if name in names}
    workflow = Path(away, "Snakefile")
    workflow.write_text(
        f"module again:\n    snakefile: {str(TREE / 'workflow' / 'Snakefile')!r}\n"
        f"    config: {config | {'studies': studies, 'settings': settings}!r}\n"
        f"    prefix: {away!r}\n\nuse rule * from again\n\n"
        # What a module does on start is not done.
        "onstart:\n    workflow.scheduler.job_rate_limiter = None\n"
    )
    done = subprocess.run(
        [
            *(sys.executable, "-m", "snakemake", "--snakefile", workflow, "--forceall"),
            *("--cores", str(processes), "--nolock", "--drop-metadata"),
            *("--workflow-profile", "none", "--scheduler", "greedy"),
            *("--allowed-rules", *_RULES, "--"),
            *(file for file in files if file.suffix in _ENDINGS),
        ],
        capture_output=True,
        text=True,
    )
    if done.returncode:
        told = [line for line in (done.stdout + done.stderr).splitlines() if line.strip()]
        line = next((each for each in told if "full account:" in each), told[-1].strip())
        if line.startswith(away):  # Snakemake ends with the files that a rule lacks
            line = f"no {Path(line).relative_to(away)}"
        raise ValueError(f"what follows from runs cannot be made again: {line}")
