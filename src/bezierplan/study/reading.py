"""Read studies from their folders and check them: every possible fault is found here, before the
first job starts, and reported in one line (`checked.Fault`).
"""

import json
import os
import re
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any, TypeVar

from bezierplan.places import STUDIES
from bezierplan.schema import checked
from bezierplan.schema.checked import Fault, closest
from bezierplan.schema.model import DEVICES, LONGEST_NAME, Model, parsed
from bezierplan.study import stamps
from bezierplan.study.artefacts import ArtefactsFile, ConfigFile
from bezierplan.study.claims import AssumptionsFile, ClaimsFile
from bezierplan.study.definition import Study, relative
from bezierplan.study.experiments import ExperimentsFile
from bezierplan.study.files import inside

M = TypeVar("M", bound=Model)


Folders = dict[Path, dict[str, Any]]
"""Folders of studies, with the settings that take the place of a study's own."""


def read_config(config: Mapping[str, Any], alone: bool = False) -> Folders:
    """The studies that a configuration names: config/config.yaml in the working folder, updated
    with the given values, or these alone.

    Alone they count in a workflow that includes this one: config/config.yaml is its own there.
    Raises Fault.
    """
    file = Path("config/config.yaml")
    location = "config of the module" if alone else f"{file} or --config"
    content = parsed(
        ConfigFile,
        (checked.read(file) if file.is_file() and not alone else {}) | dict(config),
        location,
    )
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


def asked_for(folder: Path, targets: Iterable[str], folders: Iterable[Path]) -> bool:
    """Whether a target may need the study in a folder: one that is named after it, or after none of
    the studies in `folders`; or there is no target, which asks for all.
    """
    names = [each.resolve().name for each in folders]
    concerned = [
        [name for name in names if target.startswith(f"{name}_") or name in Path(target).parts]
        for target in targets
    ]
    return not concerned or any(folder.resolve().name in own or not own for own in concerned)


def load(
    folders: Iterable[Path] | Folders,
    at_changes: Callable[[], object] = lambda: None,
    is_needed: Callable[[Path], bool] = lambda folder: True,
) -> dict[str, Study]:
    """The studies in folders, by name, read and checked, unless that was done before. Raises Fault.

    at_changes: called before each check, which takes seconds. is_needed: whether a study is read
    that has not been checked before; the others are left out.
    """
    studies = {}
    for folder in folders:
        changed = folders[folder] if isinstance(folders, dict) else {}
        try:
            stamp = stamps.stamp_of(folder, json.dumps(changed, sort_keys=True) if changed else "")
            before = stamps.remembered(stamp, folder)
            if not before and not is_needed(folder):
                continue
            study = before or read_study(folder, changed)
            if study.key in studies:
                raise Fault(
                    f"{relative(folder)}: a study of the name {study.key} is there already; "
                    "rename the folder"
                )
            if not before:
                # What checks need takes long to import, and most starts find nothing that has
                # changed.
                at_changes()
                from bezierplan.study.checks import check

                check(study)
                stamps.remember(stamp, study)
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
    experiments = _read(folder, "experiments", ExperimentsFile)
    for name, value in (changed or {}).items():
        own = experiments.settings.get(name)
        experiments.settings[name] = (
            own | value if isinstance(own, dict) and isinstance(value, dict) else value
        )
    artefacts = _read(folder, "artefacts", ArtefactsFile) or ArtefactsFile()
    claims = _read(folder, "claims", ClaimsFile)
    assumptions = _read(folder, "assumptions", AssumptionsFile)
    for name in experiments.baselines:
        if name in experiments.methods:
            raise Fault(
                f"{relative(folder / 'experiments.yaml')}: "
                f"baselines: {name}: a method has this name already"
            )
    return Study(
        key=folder.resolve().name,
        folder=folder,
        title=experiments.title,
        methods=experiments.methods | experiments.baselines,
        baselines=frozenset(experiments.baselines),
        settings={
            name: value
            for name, value in experiments.settings.items()
            if not isinstance(value, dict)
        },
        planner_settings={
            name: value for name, value in experiments.settings.items() if isinstance(value, dict)
        },
        presets=experiments.presets,
        policies=experiments.policies,
        workspaces=experiments.workspaces,
        problems=experiments.problems,
        experiments=experiments.experiments,
        baseline_comparison=experiments.baseline_comparison,
        labels=artefacts.labels,
        looks=artefacts.looks,
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
    location = relative(file)
    inside(folder, file.name, location)
    return parsed(model, checked.read(file, location), location)


def check_names(given: Mapping[str, Study], taken: Iterable[str]) -> None:
    """Raise Fault for a study whose results or targets would clash with others. taken: names of
    rules and other targets.
    """
    owners = dict.fromkeys(taken, "the workflow")
    for key, study in given.items():
        location = relative(study.folder)
        check_name(key, f"{location}: {key}")
        if {"{", "}"} & set(location):
            raise Fault(
                f"{location}: Snakemake reads braces as a pattern; expected a folder without "
                "them; rename it"
            )
        if (STUDIES / key).is_dir() and not (STUDIES / key).samefile(study.folder):
            raise Fault(
                f"{location}: config/studies has a study {key} already, whose results this one "
                "would overwrite; rename the folder"
            )
        for target in [key, *(f"{key}_{item}" for item in [*study.tables, *study.figures])]:
            if target in owners:
                raise Fault(
                    f"{location}: {target}: {owners[target]} has a target of this name already; "
                    "rename the folder"
                )
            owners[target] = f"study {key}"


def check_name(key: str, location: str) -> None:
    """Raise Fault, beginning with a location, unless a study can have this name."""
    if (
        not re.fullmatch("[A-Za-z][A-Za-z0-9_-]*", key)
        or len(key) > LONGEST_NAME
        or key.lower() in DEVICES
    ):
        wanted = (
            f"at most {LONGEST_NAME} letters, digits, _ and -, a letter first, and not the "
            "name of a device"
        )
        raise Fault(
            f"{location}: not a name of a study; "
            f"expected {wanted}; choose another name for its folder"
        )


def check_start(cores: int | None) -> None:
    """Raise Fault unless there is a core to work on, if their number is given, and results can be
    written below the working folder.
    """
    if cores is not None and cores < 1:
        raise Fault(f"--cores: {cores}; expected a number of at least 1")
    for location in (Path(), Path("results")):
        if location.exists() and not (location.is_dir() and os.access(location, os.W_OK | os.X_OK)):
            raise Fault(
                f"{location.resolve()}: cannot be written; the workflow writes its results into "
                "results/ of the working folder"
            )
