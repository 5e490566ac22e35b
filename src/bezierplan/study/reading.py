"""Read studies from their folders and check them: every possible fault is found here, before the
first job starts, and reported in one line (`checked.Fault`).
"""

import json
import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, TypeVar

from bezierplan.analysis import study_code
from bezierplan.machine.modules import code_of
from bezierplan.places import STUDIES, TREE
from bezierplan.schema import checked
from bezierplan.schema.checked import Fault, closest, part
from bezierplan.schema.model import Model, parsed
from bezierplan.study.artefacts import ArtefactsFile, ConfigFile
from bezierplan.study.claims import AssumptionsFile, ClaimsFile
from bezierplan.study.definition import Study, relative
from bezierplan.study.experiments import ExperimentsFile

M = TypeVar("M", bound=Model)


Folders = dict[Path, dict[str, Any]]
"""Folders of studies, with the settings that take the place of a study's own."""


def config_file() -> Path:
    """The file that names the studies to run: the working folder's, or the project's."""
    own = Path("config", "config.yaml")
    return own if own.is_file() else TREE / own


def read_config(config: Mapping[str, Any]) -> Folders:
    """The studies that a configuration names. Raises Fault."""
    location = "config/config.yaml or --config"
    content = parsed(ConfigFile, _with_values(dict(config)), location)
    folders: Folders = {}
    for name in content.studies:
        folder = STUDIES / name if "/" not in name else Path(name)
        if not (folder / "experiments.yaml").exists():
            known = [location.parent.name for location in STUDIES.glob("*/experiments.yaml")]
            raise Fault(
                f"{location}: studies: {name}: no experiments.yaml in "
                f"{relative(folder)}{closest(name, known)}"
            )
        folders[folder] = content.settings.get(folder.resolve().name, {})
    names = [folder.resolve().name for folder in folders]
    for name in content.settings:
        if name not in names:
            raise Fault(
                f"{location}: settings: {name}: not one of the studies to run{closest(name, names)}"
            )
    return folders


def _with_values(config: dict[str, Any]) -> dict[str, Any]:
    """A configuration whose settings are numbers where they look like it: Snakemake reads those of
    the command line as text.
    """

    def value(entry: Any) -> Any:
        if isinstance(entry, dict):
            return {key: value(each) for key, each in entry.items()}
        return checked.parse(entry, "--config") if isinstance(entry, str) else entry

    return {key: value(entry) if key == "settings" else entry for key, entry in config.items()}


def load(folders: Iterable[Path] | Folders) -> dict[str, Study]:
    """The studies in folders, by name, read and checked. Raises Fault."""
    from bezierplan.study.checks import check

    studies = {}
    for folder in folders:
        changed = folders[folder] if isinstance(folders, dict) else {}
        try:
            study = read_study(folder, changed)
            if study.key in studies:
                raise Fault(
                    f"{relative(folder)}: a study of the name {study.key} is there already; "
                    "rename the folder"
                )
            check(study)
        except Fault as fault:
            if not changed:
                raise
            raise Fault(
                f"{fault} (with the configuration's settings: {json.dumps(changed)[:300]})"
            ) from None
        studies[study.key] = study
    return studies


def read_study(folder: Path, changed: Mapping[str, Any] | None = None) -> Study:
    """The study in a folder, with each of its files checked on its own. Raises Fault.

    changed: settings that take the place of those of the same name in experiments.yaml; those of
    one planner are taken one by one.
    """
    study_code.functions(code_of(folder.resolve().name, relative(folder)).values())
    experiments = _read(folder, "experiments", ExperimentsFile)
    for name, value in (changed or {}).items():
        own = experiments.settings.get(name)
        experiments.settings[name] = (
            own | value if isinstance(own, dict) and isinstance(value, dict) else value
        )
    artefacts, claims, assumptions = None, None, None
    with part():
        artefacts = _read(folder, "artefacts", ArtefactsFile) or ArtefactsFile()
    with part():
        claims = _read(folder, "claims", ClaimsFile)
    with part():
        assumptions = _read(folder, "assumptions", AssumptionsFile)
    if artefacts is None:  # while faults are gathered: what refers to tables would only repeat this
        artefacts, claims = ArtefactsFile(), None
    for name in experiments.baselines:
        if name in experiments.methods:
            raise Fault(
                f"{relative(folder / 'experiments.yaml')}: "
                f"baselines: {name}: a method has this name already"
            )
    shared = experiments.settings
    of_planners = {name: each for name, each in shared.items() if isinstance(each, dict)}
    declared = {
        name: getattr(file, name)
        for file in (experiments, artefacts)
        for name in type(file).model_fields
        if name not in ("settings", "methods", "baselines")
    }
    return Study(
        key=folder.resolve().name,
        folder=folder,
        methods=experiments.methods | experiments.baselines,
        baselines=frozenset(experiments.baselines),
        settings={name: each for name, each in shared.items() if name not in of_planners},
        planner_settings=of_planners,
        claims=claims.claims if claims else [],
        assumptions=assumptions.assumptions if assumptions else [],
        votes=assumptions.votes if assumptions else {},
        **declared,
    )


def _read(folder: Path, name: str, model: type[M]) -> M | None:
    """A file of a study; None if it is missing, because all but the experiments are optional."""
    file = folder / f"{name}.yaml"
    if name != "experiments" and not file.exists():
        return None
    return parsed(model, checked.read(file, relative(file)), relative(file))


def check_names(given: Mapping[str, Study], taken: Iterable[str]) -> None:
    """Raise Fault for a study whose results or targets would clash with others. taken: names of
    rules and other targets.
    """
    owners = dict.fromkeys(taken, "the workflow")
    for key, study in given.items():
        location = relative(study.folder)
        check_name(key, f"{location}: {key}")
        if (STUDIES / key).is_dir() and not (STUDIES / key).samefile(study.folder):
            raise Fault(
                f"{location}: config/studies has a study {key} already, whose results this one "
                "would overwrite; rename the folder"
            )
        items = ["beyond", *study.tables, *study.figures]
        for target in [key, *(f"{key}_{item}" for item in items)]:
            if target in owners:
                raise Fault(
                    f"{location}: {target}: {owners[target]} has a target of this name already; "
                    "rename the folder"
                )
            owners[target] = f"study {key}"


def check_name(key: str, location: str) -> None:
    """Raise Fault, beginning with a location, unless a study can have this name."""
    if not re.fullmatch("[A-Za-z][A-Za-z0-9_-]{0,99}", key):
        raise Fault(
            f"{location}: not a name of a study; expected at most 100 letters, digits, _ and -, a "
            "letter first; choose another name for its folder"
        )
