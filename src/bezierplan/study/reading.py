"""Read studies from their folders and check them: every possible fault is found here, before the
first job starts, and reported in one line (`checked.Fault`).
"""

import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from bezierplan.analysis import study_code
from bezierplan.machine.modules import code_of
from bezierplan.places import STUDIES, TREE, relative
from bezierplan.schema import checked
from bezierplan.schema.checked import Fault, check_known, closest
from bezierplan.schema.model import parsed, sound_part
from bezierplan.schema.words import told
from bezierplan.study.artefacts import ArtefactsFile, ConfigFile, LayoutFile
from bezierplan.study.claims import AssumptionsFile, ClaimsFile
from bezierplan.study.definition import Study
from bezierplan.study.experiments import ExperimentsFile

Folders = dict[Path, dict[str, Any]]
"""Folders of studies, with the settings that take the place of a study's own."""


def config_file() -> Path:
    """The file that names the studies to run: the working folder's, or the project's."""
    own = Path("config", "config.yaml")
    return own if own.is_file() else TREE / own


def read_config(config: Mapping[str, Any]) -> Folders:
    """The studies that a configuration names. Raises Fault."""
    location = "config/config.yaml or --config"
    settings = _with_values(config.get("settings", {}))
    content = parsed(ConfigFile, {**config, "settings": settings}, location)
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
    for name in content.settings:
        check_known(name, [folder.resolve().name for folder in folders], f"{location}: settings")
    return folders


def _with_values(settings: Any) -> Any:
    """Settings of a configuration, which are numbers where they look like it: Snakemake reads those
    of the command line as text.
    """
    if isinstance(settings, dict):
        return {name: _with_values(each) for name, each in settings.items()}
    return checked.parse(settings, "--config") if isinstance(settings, str) else settings


FILES = {
    "experiments": ExperimentsFile,
    "artefacts": ArtefactsFile,
    "layout": LayoutFile,
    "claims": ClaimsFile,
    "assumptions": AssumptionsFile,
}


def load(folders: Iterable[Path] | Folders) -> dict[str, Study]:
    """The studies in folders, by name, read and checked. Raises Fault."""
    from bezierplan.study.checks import Checks

    studies: dict[str, Study] = {}
    for folder in folders:
        changed = folders[folder] if isinstance(folders, dict) else {}
        study, faults, lost = _read(folder, changed)
        if faults := [*faults, *Checks(study, lost).check()]:
            more = f" (with the configuration's settings: {changed})" if changed else ""
            raise Fault(*(f"{line}{more}" for line in faults))
        if study.key in studies:
            raise Fault(
                f"{relative(folder)}: a study of the name {study.key} is there already; rename the "
                "folder"
            )
        studies[study.key] = study
    return studies


def read_study(folder: Path) -> Study:
    """The study in a folder, with each of its files checked on its own. Raises Fault."""
    study, faults, _ = _read(folder, {})
    if faults:
        raise Fault(*faults)
    return study


def _read(folder: Path, changes: Mapping[str, Any]) -> tuple[Study, list[str], list[str]]:
    """The study in a folder, as far as its files are sound, the faults of the rest, and the names
    of entries that are left out for them. Raises Fault if they are in experiments.yaml.

    changes: settings that take the place of those of the same name there; those of one planner are
    taken one by one.
    """
    key = folder.resolve().name
    for name in code_of(key, relative(folder)).values():
        try:
            study_code.functions([name])
        except (Exception, SystemExit) as error:  # a user's file can fail in any way
            raise Fault(f"{name}: {told(error)}") from None
    content = {"votes": {}, "reading_repeats": 0}
    faults, invalid, broken = [], [], []
    for name, model in FILES.items():
        file = folder / f"{name}.yaml"
        try:
            if name == "experiments" or file.exists():
                text = checked.read(file, relative(file))
                sound, lines, left = sound_part(model, text, relative(file))
                content |= dict(sound)
                faults += lines
                invalid += left
        except Fault as fault:
            broken += fault.lines
    if broken:  # What others say of such a file's names would follow from it.
        raise Fault(*broken, *faults)
    for name, value in changes.items():
        own = content["settings"].get(name)
        content["settings"][name] = (
            own | value if isinstance(own, dict) and isinstance(value, dict) else value
        )
    return Study.of(folder, content), faults, invalid


def check_names(studies: Mapping[str, Study], others: Iterable[str]) -> None:
    """Raise Fault for a study whose results or targets would clash with others. others: names of
    rules and other targets.
    """
    targets = {*others}
    for key, study in studies.items():
        location = relative(study.folder)
        check_name(key, f"{location}: {key}")
        if (STUDIES / key).is_dir() and not (STUDIES / key).samefile(study.folder):
            raise Fault(
                f"{location}: config/studies has a study {key} already, whose results this one "
                "would overwrite; rename the folder"
            )
        own = [key, *(f"{key}_{item}" for item in ("beyond", *study.tables, *study.figures))]
        for target in targets.intersection(own):
            raise Fault(f"{location}: {target}: a target has this name already; rename the folder")
        targets.update(own)


def check_name(key: str, location: str) -> None:
    """Raise Fault, beginning with a location, unless a study can have this name."""
    if not re.fullmatch("[A-Za-z][A-Za-z0-9_-]{0,99}", key):
        raise Fault(
            f"{location}: not a name of a study; expected at most 100 letters, digits, _ and -, a "
            "letter first; choose another name for its folder"
        )
