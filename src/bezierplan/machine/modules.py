"""Load modules by name, of this package or users' files, and find the code of a study."""

import importlib
import importlib.util
import sys
from functools import cache
from pathlib import Path
from types import ModuleType

from bezierplan.places import PACKAGE

USERS = "study_"
"""Beginning of the names of modules that are users' files."""
PARTS = ("metrics", "worlds", "functions", "panels", "audit")
"""Files of code, without `.py`, that the folder of a study may have."""


def is_file(name: str) -> bool:
    """Return whether a module is given as the path of a user's file, and not as a name in this
    package.
    """
    return name.endswith(".py")


@cache
def load_module(name: str) -> ModuleType:
    """Load a module: `bezierplan.a.b` of this package, or `folder/name.py`, a user's file, which
    can import the modules next to it at the top of the file.

    Raises ModuleNotFoundError or FileNotFoundError if there is none.
    """
    if not is_file(name):
        return importlib.import_module(name)
    file = Path(name).resolve()
    # Modules know themselves by name, such as those that numba or pickle keep parts of; this one is
    # no library's.
    key = f"{USERS}{file.stem}"
    spec = importlib.util.spec_from_file_location(key, name)
    made = importlib.util.module_from_spec(spec)
    known = {*sys.modules, key}
    # A compiled file is known by second and size of its source: after a quick edit, the old one
    # would run.
    written, sys.dont_write_bytecode = sys.dont_write_bytecode, True
    sys.path.append(str(file.parent))  # last, so that no user file shadows a library
    sys.modules[key] = made
    try:
        spec.loader.exec_module(made)
    except BaseException:
        sys.modules.pop(key, None)  # whatever the file has done before it failed
        raise
    finally:
        sys.dont_write_bytecode = written
        sys.path.remove(str(file.parent))
        # Files of another study may have modules of the same name next to them.
        beside = {each.stem for each in file.parent.iterdir()}
        for each in [each for each in sys.modules.keys() - known if each.split(".")[0] in beside]:
            del sys.modules[each]
    return made


def find_code(study: str, folder: str) -> dict[str, str]:
    """Return the names for `load_module` of the parts `PARTS` of a study, by part: files of its
    folder, or for a paper of this project modules of `bezierplan.papers`.
    """
    ours = PACKAGE / "papers" / study
    if ours.is_dir():
        dotted = f"{PACKAGE.name}.papers.{study}"
        return {part: f"{dotted}.{part}" for part in PARTS if (ours / f"{part}.py").exists()}
    files = {part: f"{folder}/{part}.py" for part in PARTS}
    return {part: file for part, file in files.items() if Path(file).exists()}


@cache
def find_kinds(folder: str, part: str) -> dict[str, str]:
    """Return the modules with one kind each, by the kind: those of a folder of this package, and
    those in the folder `part` of its papers.
    """
    files = [*(PACKAGE / folder).glob("[!_]*.py"), *PACKAGE.glob(f"papers/*/{part}/[!_]*.py")]
    return {
        file.stem: ".".join(file.relative_to(PACKAGE.parent).with_suffix("").parts)
        for file in sorted(files, key=lambda file: file.stem)
    }
