"""Read studies from their folders and check them: every possible fault is found here, before the first job starts, and reported in
one line (`checked.Fault`).
"""

import os
import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, TypeVar

from bezierplan.running.digest import PACKAGE
from bezierplan.study import checked, stamps
from bezierplan.study.artefacts import ArtefactsFile, ConfigFile
from bezierplan.study.checked import Fault, closest
from bezierplan.study.checks import check
from bezierplan.study.claims import AssumptionsFile, ClaimsFile
from bezierplan.study.definition import Study, relative
from bezierplan.study.experiments import ExperimentsFile
from bezierplan.study.files import inside
from bezierplan.study.model import Model, parsed

M = TypeVar("M", bound=Model)


def read_config(given: Mapping[str, Any]) -> list[Path]:
    """Folders of the studies that a configuration names: config/config.yaml in the working folder, updated with the given values.

    Raises Fault.
    """
    file = Path("config/config.yaml")
    place = f"{file} or --config"
    content = parsed(ConfigFile, (checked.read(file) if file.is_file() else {}) | dict(given), place)
    root = PACKAGE.parents[1] / "config" / "studies"
    folders = []
    for name in content.studies:
        folder = root / name if "/" not in name else Path(name)
        if not (folder / "experiments.yaml").exists():
            known = [place.parent.name for place in root.glob("*/experiments.yaml")]
            raise Fault(f"{place}: studies: {name}: no experiments.yaml in {relative(folder)}{closest(name, known)}")
        folders.append(folder)
    return folders


def load(folders: list[Path]) -> dict[str, Study]:
    """The studies in folders, by name, read and checked; one whose content was checked before is only read. Raises Fault."""
    studies = {}
    for folder in folders:
        study = read_study(folder)
        if study.key in studies:
            raise Fault(f"{relative(folder)}: a study of the name {study.key} is there already; rename the folder")
        stamp = stamps.stamp_of(folder)
        if stamp is None or not stamp.exists():
            check(study)
            stamps.remember(stamp)
        studies[study.key] = study
    return studies


def read_study(folder: Path) -> Study:
    """The study in a folder, with each of its files checked on its own. Raises Fault."""
    experiments = _read(folder, "experiments", ExperimentsFile)
    artefacts = _read(folder, "artefacts", ArtefactsFile) or ArtefactsFile()
    claims, assumptions = _read(folder, "claims", ClaimsFile), _read(folder, "assumptions", AssumptionsFile)
    for name in experiments.baselines:
        if name in experiments.methods:
            raise Fault(f"{relative(folder / 'experiments.yaml')}: baselines: {name}: a method has this name already")
    return Study(
        key=folder.resolve().name,
        folder=folder,
        title=experiments.title,
        methods=experiments.methods | experiments.baselines,
        baselines=frozenset(experiments.baselines),
        settings={name: value for name, value in experiments.settings.items() if not isinstance(value, dict)},
        planner_settings={name: value for name, value in experiments.settings.items() if isinstance(value, dict)},
        presets=experiments.presets,
        policies=experiments.policies,
        workspaces=experiments.workspaces,
        problems=experiments.problems,
        experiments=experiments.experiments,
        worth=experiments.worth,
        labels=artefacts.labels,
        tables=artefacts.tables,
        figures=artefacts.figures,
        claims=claims.claims if claims else [],
        assumptions=assumptions.assumptions if assumptions else [],
    )


def _read(folder: Path, name: str, model: type[M]) -> M | None:
    """A file of a study; None if it is missing, because all but the experiments are optional."""
    file = folder / f"{name}.yaml"
    if name != "experiments" and not file.exists() and not file.is_symlink():
        return None
    place = relative(file)
    inside(folder, file.name, place)
    return parsed(model, checked.read(file, place), place)


def check_names(given: Mapping[str, Study], taken: Iterable[str]) -> None:
    """Raise Fault for a study whose results or targets would clash with others. taken: names of rules and other targets."""
    owners = dict.fromkeys(taken, "the workflow")
    home = PACKAGE.parents[1] / "config" / "studies"
    for key, study in given.items():
        place = relative(study.folder)
        if not re.fullmatch("[A-Za-z][A-Za-z0-9_-]*", key):
            raise Fault(f"{place}: {key}: not a name of a study; expected letters, digits, _ and -, a letter first; rename the folder")
        if (home / key).is_dir() and not (home / key).samefile(study.folder):
            raise Fault(f"{place}: config/studies has a study {key} already, whose results this one would overwrite; rename the folder")
        for target in [key, *(f"{key}_{item}" for item in [*study.tables, *study.figures])]:
            if target in owners:
                raise Fault(f"{place}: {target}: {owners[target]} has a target of this name already; rename the folder")
            owners[target] = f"study {key}"


def check_folder() -> None:
    """Raise Fault unless results can be written below the working folder."""
    for place in (Path(), Path("results")):
        if place.exists() and not (place.is_dir() and os.access(place, os.W_OK | os.X_OK)):
            raise Fault(f"{place.resolve()}: cannot be written; the workflow writes its results into results/ of the working folder")
