"""What each file of runs is to hold, by the studies."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from bezierplan.running.judge.recheck import Task
from bezierplan.schema import checked
from bezierplan.schema.checked import check_known
from bezierplan.study import jobs
from bezierplan.study.experiments import SCALES
from bezierplan.study.jobs import Studies


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
    scale, listed = folder.resolve().name, []
    for place in sorted(folder.glob("*/runs/*/*")):
        key, _, experiment, method = place.relative_to(folder).parts
        check_known(scale, SCALES, f"{folder}: scale")
        check_known(experiment, studies[key].experiments, f"{place}: experiment")
        check_known(method, studies[key].methods_of(experiment), f"{place}: method")
        chunks = jobs.judgement(studies[key], scale, experiment, method).chunks
        files = {str(place / f"{number}.parquet"): chunk for number, chunk in enumerate(chunks)}
        listed.append(Task(str(folder / key / "problems" / f"{experiment}.parquet"), files))
    if not listed:
        raise FileNotFoundError(
            f"{folder}: no runs here; expected a folder of results, such as results/full"
        )
    return listed
