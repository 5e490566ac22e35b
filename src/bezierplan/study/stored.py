"""What each file of runs is to hold, by the studies."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from bezierplan.running.recheck import StoredRuns
from bezierplan.schema import checked
from bezierplan.schema.checked import check_known
from bezierplan.study import jobs, reading
from bezierplan.study.experiments import SCALES
from bezierplan.study.jobs import Studies


def places_of(folder: Path, config: dict[str, Any], words: Iterable[str]) -> dict[str, str]:
    """Where the studies lie whose results a scale's folder holds, by name: as a configuration,
    further words or the page say, or in the working folder. Raises Fault for one that is in none of
    these.
    """
    named = {Path(word).resolve().name: word for word in (*config["studies"], *words)}
    known = reading.on_page(folder) | named
    found = {problems.parent.name for problems in folder.glob("*/problems")}
    for key in sorted(found - known.keys()):
        if not Path(key, "experiments.yaml").is_file():
            raise checked.Fault(
                f"{folder / key}: no study {key} in config/config.yaml or here; say where it lies: "
                f"--studies FOLDER/{key}"
            )
        known[key] = f"./{key}"
    return {key: word for key, word in known.items() if key in found}


def tasks(studies: Studies, folder: Path) -> list[StoredRuns]:
    """What is to be judged below a scale's folder. Raises Fault for a folder of no scale, and
    FileNotFoundError without runs.
    """
    scale, all_tasks = folder.resolve().name, []
    for place in sorted(folder.glob("*/runs/*/*")):
        key, _, experiment, method = place.relative_to(folder).parts
        check_known(scale, SCALES, f"{folder}: scale")
        study = studies[key]
        if experiment in study.experiments and method in study.methods_of(experiment):
            made = {
                str(place / f"{number}.parquet"): jobs.runs(
                    study, scale, experiment, method, str(number)
                )
                for number in jobs.chunks(study, experiment, method, scale)
            }
            all_tasks.append(
                StoredRuns(
                    str(folder / key / "problems" / f"{experiment}.parquet"),
                    {file: each.chunk for file, each in made.items()},
                    {file: each.digest for file, each in made.items()},
                )
            )
    if not all_tasks:
        raise FileNotFoundError(
            f"{folder}: no runs here; expected a folder of results, such as results/full"
        )
    return all_tasks


def of_nothing(studies: Studies, folder: Path) -> list[Path]:
    """Files in the folders of a scale that no study makes."""
    scale, strangers = folder.resolve().name, []
    for key, study in studies.items():
        made = {"claims.csv", "claim_checks.csv", "claims_by_reading.csv", "audit.csv"}
        made.update(*map(study.files_of, (*study.tables, *study.figures)))
        for experiment in study.experiments:
            made |= {f"problems/{experiment}.{end}parquet" for end in ("", "bounds.")}
            for method in study.methods_of(experiment):
                numbers = jobs.chunks(study, experiment, method, scale)
                chunks = [f"{n}.{end}parquet" for n in numbers for end in ("", "times.", "traces.")]
                made |= {f"runs/{experiment}/{method}/{n}" for n in (*chunks, "judgement.json")}
        patterns = ("*.csv", "problems/[!.]*", "paper/[!.]*", "beyond/[!.]*", "runs/*/*/[!.]*")
        files = (file for pattern in patterns for file in sorted((folder / key).glob(pattern)))
        strangers += [file for file in files if str(file.relative_to(folder / key)) not in made]
    return strangers
