"""Do all files of a scale follow from the studies? What each file of runs is to hold, and what
follows from the runs, made again in a folder of its own.
"""

import json
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from bezierplan.places import TREE
from bezierplan.running import rows
from bezierplan.running.judge.recheck import Fault, Task, sha256
from bezierplan.schema import checked
from bezierplan.schema.checked import check_known
from bezierplan.study import jobs
from bezierplan.study.experiments import SCALES
from bezierplan.study.jobs import Studies

LIST = "verified.json"
"""The file that lists the digests of all others."""

_FOLLOW = (
    *("*/problems/*.parquet", "*/paper/*", "*/beyond/*", "*/*.csv", "*/verdict.md"),
    *("*.csv", "summary.md", "index.html"),
)
"""Files that follow from the studies, from runs and from bounds."""
_ENDINGS = {".csv", ".tex", ".md", ".html", ".parquet"}
"""Those by which Snakemake is asked for all of them."""
_RULES = (
    *("problems", "table", "unprinted_table", "listing", "latex", "figure", "claims", "audit"),
    *("baseline_comparison", "summary", "verdict", "page"),
)


def places_of(folder: Path, config: dict[str, Any], words: Iterable[str]) -> dict[str, str]:
    """Where the studies lie whose results a scale's folder holds, by name: as a configuration or
    further words say, or in the working folder. Raises Fault for one that is in none of these.
    """
    known = {Path(word).resolve().name: word for word in (*config["studies"], *words)}
    found = {problems.parent.name for problems in folder.glob("*/problems")}
    for key in sorted(found - known.keys()):
        if not Path(key, "experiments.yaml").is_file():
            raise checked.Fault(
                f"{folder / key}: no study {key} in config/config.yaml or here; say where it lies: "
                f"--studies FOLDER/{key}"
            )
        known[key] = f"./{key}"
    return {key: word for key, word in known.items() if key in found}


def tasks(studies: Studies, folder: Path) -> list[Task]:
    """What is to be judged below a scale's folder. Raises Fault for what no study makes, and
    FileNotFoundError without runs.
    """
    scale = folder.resolve().name
    listed = [*_runs(studies, folder, scale)]
    if not listed:
        raise FileNotFoundError(
            f"{folder}: no runs here; expected a folder of results, such as results/full"
        )
    for file in sorted(folder.glob("*/problems/*.bounds.parquet")):
        listed.append(Task(str(file).replace(".bounds.", "."), {}, str(file)))
    return listed


def _problems(folder: Path, study: str, experiment: str) -> str:
    return str(folder / study / "problems" / f"{experiment}.parquet")


def _runs(studies: Studies, folder: Path, scale: str) -> Iterator[Task]:
    for place in sorted(folder.glob("*/runs/*/*")):
        key, _, experiment, method = place.relative_to(folder).parts
        check_known(scale, SCALES, f"{folder}: scale")
        check_known(experiment, studies[key].experiments, f"{place}: experiment")
        check_known(method, studies[key].methods_of(experiment), f"{place}: method")
        chunks = jobs.judgement(studies[key], scale, experiment, method).chunks
        files = {str(place / f"{number}.parquet"): chunk for number, chunk in enumerate(chunks)}
        yield Task(_problems(folder, key, experiment), files)


def _listed(folder: Path) -> dict[str, str]:
    """The list of digests; empty without one. Raises ValueError for a list that is none."""
    file = folder / LIST
    try:
        return dict(json.loads(file.read_text())["sha256"]) if file.is_file() else {}
    except (KeyError, TypeError, ValueError):
        raise rows.misplaced(str(file), "not a list of digests") from None


def unlisted(folder: Path) -> list[Fault]:
    """Files that are not what the list of digests says; none without a list, which only a page
    needs. Raises ValueError for a list that is none.
    """
    listed = _listed(folder)
    if not listed and (folder / "index.html").is_file():
        return [Fault(str(folder / LIST), "all bytes", "SHA-256", "no file", "a list")]
    found = {name: sha256(folder / name) or "no file" for name in listed}
    return [
        Fault(str(folder / name), "all bytes", "SHA-256", listed[name], found[name])
        for name in listed
        if listed[name] != found[name]
    ]


def differing(
    folder: Path, config: dict[str, Any], places: dict[str, str], processes: int
) -> tuple[int, list[Fault]]:
    """How many files follow from studies, runs and bounds, and which of them are others if they are
    made again. places: of the studies. Raises ValueError if that fails.
    """
    with tempfile.TemporaryDirectory() as away:
        again = Path(away, "results", folder.resolve().name)
        shutil.copytree(folder, again, ignore=shutil.ignore_patterns("logs"))
        files = [
            file
            for pattern in _FOLLOW
            for file in sorted(again.glob(pattern))
            if ".bounds." not in file.name
        ]
        before = {file: sha256(file) for file in files}
        # What lies above all studies is of those that the list names.
        listed = {name.split("/")[0] for name in _listed(folder)}
        shown = [key for key in places if key in listed] or [*places]
        whole = [*shown, *(file.name for file in files if file.parent == again)]
        for group in [whole, *([key] for key in places if key not in shown)]:
            own = [file for file in files if file.relative_to(again).parts[0] in group]
            studies = [places[key] for key in places if key in group]
            _make(own, config, studies, away, processes)
        return len(files), [
            Fault(
                str(folder / file.relative_to(again)), "all bytes", "SHA-256", stored, sha256(file)
            )
            for file, stored in before.items()
            if stored != sha256(file)
        ]


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
        f"    prefix: {away!r}\n\nuse rule * from again\n"
    )
    done = subprocess.run(
        [
            *(sys.executable, "-m", "snakemake", "--snakefile", workflow, "--forceall"),
            *("--cores", str(processes), "--nolock", "--drop-metadata"),
            *("--workflow-profile", "none", "--allowed-rules", *_RULES, "--"),
            *(file for file in files if file.suffix in _ENDINGS),
        ],
        capture_output=True,
        text=True,
    )
    if done.returncode:
        told = [line for line in (done.stdout + done.stderr).splitlines() if line.strip()]
        line = next((each for each in told if "full account:" in each), told[-1])
        raise ValueError(f"what follows from runs cannot be made again: {line}")
