"""Make a study of your own, which runs at once, perhaps on a map of your own."""

import re
import shlex
import shutil
import sys
from pathlib import Path

import yaml

from bezierplan.commands.arguments import Place
from bezierplan.places import PACKAGE, TREE
from bezierplan.running import problems
from bezierplan.schema.checked import Fault
from bezierplan.study import loading
from bezierplan.workspaces import files
from bezierplan.workspaces.map_files import describe

TEMPLATE = PACKAGE / "template"
EXAMPLE = TREE / "examples" / "bailey2015"


def main(
    folder: Path,
    *,
    from_: Path | None = None,
    start: Place | None = None,
    target: Place | None = None,
    example: bool = False,
) -> None:
    """Make the folder of a study.

    Parameters
    ----------
    folder : Path
        where the study will lie; its name is the study's
    from_ : Path, optional
        a map file of your own, no image without the YAML file of a map_server beside it; needs
        --start and --target
    start : tuple of float, optional
        where paths begin on that map, in its unit
    target : tuple of float, optional
        where they end
    example : bool
        a complete study of a paper, with code of each kind, in place of an empty one

    Examples
    --------
    new mystudy
    new mystudy --example
    new mystudy --from map.yaml --start 1,1 --target 9,9
    """
    loading.check_name(folder.name, str(folder))
    if folder.exists() or not folder.parent.is_dir():
        raise Fault(f"{folder}: expected a new folder in one that exists")
    if len({from_ is None, start is None, target is None}) > 1:
        raise Fault("expected --from, --start and --target together: a map of your own")
    if from_:
        workspace = describe(from_, cells=True)
        ends = {"start": list(start), "target": list(target)}
        # A map that cannot be read, or an end that is not free, must not leave half a study behind.
        problems.build("", ends, files.load(workspace, from_.parent))
    shutil.copytree(
        EXAMPLE if example and not from_ else TEMPLATE,
        folder,
        ignore=shutil.ignore_patterns("__pycache__"),
    )
    _replace(folder / "README.md", "mystudy", folder.name)
    _replace(folder / "README.md", "^bezierplan", _find_call(folder.parent))
    if from_:
        _put(folder, files.sources(workspace, from_.parent), workspace, ends)
    print(f"{folder}: a study; next: {_find_call(Path())} run {shlex.quote(str(folder))}")


def _find_call(folder: Path) -> str:
    """Return the words by which a shell in a folder calls this program once more."""
    program, rest = sys.argv[0], ""
    if Path(program).name != "bezierplan":
        program, rest = sys.orig_argv[0], " -m bezierplan"
    elif program == shutil.which("bezierplan"):
        return "bezierplan"
    if "/" in program and not folder.samefile(Path()):
        program = str(Path(program).absolute())  # a relative path leads nowhere from there
    return shlex.quote(program) + rest


def _put(folder: Path, sources: list[Path], workspace: dict, ends: dict[str, list[float]]) -> None:
    """Put a map in place of the template's room."""
    # Before the copies: a map of one's own may have the same name.
    (folder / "room.txt").unlink()
    for source in sources:
        shutil.copyfile(source, folder / source.name)
    # The published number is about the room.
    shutil.rmtree(folder / "published")
    _replace(folder / "artefacts.yaml", "    published: lengths.csv\n", "")
    experiments = folder / "experiments.yaml"
    _replace(experiments, "^  room:.*\n", f"  room: {_write_flow(workspace)}")
    _replace(
        experiments, "^  across:.*\n", f"  across: {_write_flow({'workspace': 'room'} | ends)}"
    )


def _replace(file: Path, old: str, new: str) -> None:
    """Replace what a regular expression finds in a file."""
    # A function, because a text would lose its backslashes.
    text = re.sub(old, lambda _: new, file.read_text(encoding="utf-8"), flags=re.MULTILINE)
    file.write_text(text, encoding="utf-8")


def _write_flow(mapping: dict) -> str:
    """Return a mapping as one line of YAML."""
    return yaml.safe_dump(mapping, default_flow_style=True, sort_keys=False, width=1000)
