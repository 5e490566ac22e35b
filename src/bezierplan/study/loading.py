"""Read studies from their folders and check them. Every fault is found here, before the first job
starts, and is one line (`checked.Fault`).
"""

import contextlib
import hashlib
import json
import os
import re
import sys
from collections.abc import Iterable, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import pydantic

from bezierplan.machine.digest import hash_text
from bezierplan.machine.modules import find_code
from bezierplan.places import PACKAGE, STUDIES, TREE, find_cache_folder, shorten_path
from bezierplan.schema import checked
from bezierplan.schema.checked import Fault, check_all, describe_known
from bezierplan.schema.model import Model, find_names, parse, parse_sound_part
from bezierplan.schema.safe_text import describe_in_one_line
from bezierplan.study.artefacts import ArtefactsFile, ConfigFile, LayoutFile
from bezierplan.study.claims import AssumptionsFile, ClaimsFile
from bezierplan.study.definition import Study
from bezierplan.study.experiments import ExperimentsFile

Folders = dict[Path, dict[str, Any]]
"""Folder of a study -> settings that take the place of the study's own."""


def find_config_file() -> Path:
    """Return the file that names the studies to run: the working folder's, otherwise the
    project's.
    """
    own = Path("config", "config.yaml")
    return own if own.is_file() else TREE / own


def read_config(config: Mapping[str, Any]) -> Folders:
    """Return the folders of the studies that a configuration names, with its settings. Raises
    Fault.
    """
    location = "config/config.yaml or --config"
    settings = _convert_values(config.get("settings", {}))
    content = parse(ConfigFile, {**config, "settings": settings}, location)
    folders: Folders = {}
    for name in content.studies:
        folder = STUDIES / name if "/" not in name else Path(name)
        if not (folder / "experiments.yaml").exists():
            known = [location.parent.name for location in STUDIES.glob("*/experiments.yaml")]
            raise Fault(
                f"{location}: studies: {name}: no experiments.yaml in "
                f"{shorten_path(folder)}{describe_known(name, known)}"
            )
        folders[folder] = content.settings.get(folder.resolve().name, {})
    # Settings of a study that is not run now are no fault.
    known = [folder.resolve().name for folder in (*folders, *STUDIES.glob("*"))]
    check_all(content.settings, known, f"{location}: settings")
    return folders


def read_page_studies(scale_folder: str | Path) -> dict[str, str]:
    """Return the studies that the page of a scale shows and that have results there: by name, the
    word that names each in a configuration. Without a page the result is empty.

    scale_folder: the folder of the scale.
    """
    try:
        words = dict(json.loads(Path(scale_folder, "verified.json").read_text())["studies"])
    except (OSError, ValueError, TypeError, KeyError):
        return {}
    return {key: word for key, word in words.items() if Path(scale_folder, key).is_dir()}


def load_others(words: Mapping[str, str], config: Mapping[str, Any]) -> dict[str, Study]:
    """Load the studies of existing pages that nobody asked for now, so that the pages keep them.

    words: name -> the word that names it in a configuration. A study that is gone or has a fault is
    reported on stderr and left out.
    """
    studies = {}
    for key, own in words.items():
        try:
            studies |= load(read_config({**config, "studies": [own]}))
        except Fault as fault:
            print(f"the page leaves out the study {key}: {fault.lines[0]}", file=sys.stderr)
    return studies


def select_studies(folders: Folders, targets: Iterable[str]) -> Folders:
    """Return the studies to which the workflow's targets belong; all of them, unless each target
    belongs to one.
    """
    patterns = {
        folder: f"(results/[^/]+/)?{re.escape(folder.resolve().name)}([_/]|$)" for folder in folders
    }
    named = [
        {folder for folder, pattern in patterns.items() if re.match(pattern, target)}
        for target in targets
    ]
    wanted = set().union(*named) if all(named) else set()
    return {folder: folders[folder] for folder in folders if folder in wanted or not wanted}


def _convert_values(settings: Any) -> Any:
    """Return a configuration's settings with numbers for text that looks like one, because
    Snakemake reads the values of its command line as text.
    """
    if isinstance(settings, dict):
        return {name: _convert_values(each) for name, each in settings.items()}
    return checked.parse(settings, "--config") if isinstance(settings, str) else settings


FILES = {
    "experiments": ExperimentsFile,
    "artefacts": ArtefactsFile,
    "layout": LayoutFile,
    "claims": ClaimsFile,
    "assumptions": AssumptionsFile,
}


def load(folders: Iterable[Path] | Folders) -> dict[str, Study]:
    """Read the studies in folders and check them; return them by name.

    The checks are skipped if they found nothing in the same files before. Raises Fault.
    """
    studies: dict[str, Study] = {}
    for folder in folders:
        changed = folders[folder] if isinstance(folders, dict) else {}
        stamp = _find_stamp(folder, changed)
        known = stamp.exists()
        # Code that was checked before is loaded by the jobs that need it, not at every start.
        if not known:
            _load_code(folder)
        study, faults, lost = _read(folder, changed)
        if not known:
            # It imports planners and figures, which a study that was checked before does not need.
            from bezierplan.study.checks import Checks

            if faults := [*faults, *Checks(study, lost).check()]:
                more = f" (with the configuration's settings: {changed})" if changed else ""
                raise Fault(*(f"{line}{more}" for line in faults))
            # If the mark cannot be written, the study is checked again next time.
            with contextlib.suppress(OSError):
                stamp.parent.mkdir(parents=True, exist_ok=True)
                stamp.touch()
        if study.key in studies:
            raise Fault(
                f"{shorten_path(folder)}: a study of the name {study.key} is there already; rename "
                "the folder"
            )
        studies[study.key] = study
    return studies


def _find_stamp(folder: Path, changes: Mapping[str, Any]) -> Path:
    """Return the file that marks a study as checked and without a fault.

    Its name is a digest of all that a fault could come from: the files of the study, the settings
    of a configuration, this package and its libraries.
    """
    parts = [
        repr(changes),
        *_describe_package(),
        # The name of the folder is that of the study, by which its code is found.
        str(folder.resolve()),
        *_describe_contents(folder),
    ]
    return find_cache_folder() / "checked" / hash_text("\n".join(parts))


_WRITTEN = frozenset(("__pycache__", "results", ".snakemake"))
"""Folders that Python and the workflow write, also where a study's folder is the working folder."""


@cache
def _describe_package() -> list[str]:
    """Return what this package and its environment are: the digests of its files, the version of
    Python, and when a library was last installed or removed.
    """
    libraries = Path(pydantic.__file__).parents[1]
    return [
        sys.version,
        f"{libraries} {libraries.stat().st_mtime_ns}",
        *_describe_contents(PACKAGE),
    ]


def _describe_contents(folder: Path) -> list[str]:
    """Return a line for each path below a folder, except for what is written there: its name, where
    it leads, and the digest of its content.
    """
    lines = []
    for path in sorted(folder.rglob("*")):
        if _WRITTEN.isdisjoint(path.relative_to(folder).parts):
            content = path.read_bytes() if path.is_file() else b""
            digest = hashlib.sha256(content).hexdigest()
            lines.append(f"{path} {os.path.realpath(path)} {digest}")
    return lines


def _load_code(folder: Path) -> None:
    """Load the code of the study in a folder, so that its metrics are known. Raises Fault."""
    from bezierplan.analysis import study_code

    for name in find_code(folder.resolve().name, shorten_path(folder)).values():
        try:
            study_code.load_functions([name])
        except (Exception, SystemExit) as error:  # a user's file can fail in any way
            raise Fault(f"{name}: {describe_in_one_line(error)}") from None


def _read(
    folder: Path, changes: Mapping[str, Any]
) -> tuple[Study, list[str], list[tuple[str, str]]]:
    """Read the study in a folder as far as its files are sound. Return it with the faults, and with
    section and name of the entries that are left out for these. Raises Fault if too little is left.

    changes: settings that take the place of those of the same name in experiments.yaml; those of
    one planner are replaced one by one.
    """
    content, faults, invalid, broken = {}, [], [], []
    for name, model in FILES.items():
        file = folder / f"{name}.yaml"
        try:
            if name == "experiments" or file.exists():
                text = checked.read(file, shorten_path(file))
                sound, lines, left = parse_sound_part(model, text, shorten_path(file))
                content |= dict(sound)
                faults += lines
                invalid += left
        except Fault as fault:
            broken += fault.lines
    if broken:  # What others say of such a file's names would follow from it.
        raise Fault(*broken, *faults)
    faults = [*_find_strange_files(folder, content["workspaces"]), *faults]
    for name, value in changes.items():
        own = content["settings"].get(name)
        # The settings of one planner are a mapping: those that stay keep their values.
        content["settings"][name] = (
            own | value if isinstance(own, dict) and isinstance(value, dict) else value
        )
    return Study.build(folder, content), faults, invalid


def _find_strange_files(folder: Path, workspaces: Mapping[str, Model]) -> list[str]:
    """Return a fault for each YAML file that nothing reads: its name may be misspelt."""
    known = [*(f"{name}.yaml" for name in FILES), "verdict.yaml"]
    maps = [
        name for home in workspaces.values() for _, what, name in find_names(home) if what == "file"
    ]
    return [
        f"{shorten_path(file)}: no file of a study{describe_known(file.name, known)}"
        # An editor leaves claims.yaml~ behind, but claims.yml is a slip.
        for file in sorted(each for each in folder.glob("*.y*ml*") if each.suffix != ".yaml~")
        if file.name not in (*known, *maps)
    ]


def check_names(studies: Mapping[str, Study]) -> None:
    """Raise Fault for a study whose results or targets would clash with others."""
    # A study is a target of the workflow by its name, and so is every rule.
    rules = [file.read_text() for file in (TREE / "workflow" / "rules").glob("*.smk")]
    targets = {"default", *re.findall(r"^(?:use )?rule (?:\w+ as )?(\w+)", "\n".join(rules), re.M)}
    for key, study in studies.items():
        location = shorten_path(study.folder)
        check_name(key, f"{location}: {key}")
        # The same folder may be given by another path, such as a link.
        if (STUDIES / key).is_dir() and not (STUDIES / key).samefile(study.folder):
            raise Fault(
                f"{location}: config/studies has a study {key} already, whose results this one "
                "would overwrite; rename the folder"
            )
        if key in targets:
            raise Fault(f"{location}: {key}: a target has this name already; rename the folder")


def check_name(key: str, location: str) -> None:
    """Raise Fault, beginning with a location, unless a study can have this name."""
    if not re.fullmatch("[A-Za-z][A-Za-z0-9_-]{0,99}", key):
        raise Fault(
            f"{location}: not a name of a study; expected at most 100 letters, digits, _ and -, a "
            "letter first; choose another name for its folder"
        )
