"""A new study: `python -m bezierplan new FOLDER` copies one that runs at once, `--from MAP` puts a
map of your own into it.
"""

import re
import shutil
from argparse import ArgumentParser
from pathlib import Path

import yaml

from bezierplan.places import PACKAGE
from bezierplan.schema.checked import Fault
from bezierplan.study import reading
from bezierplan.workspaces import files
from bezierplan.workspaces.map_files import described, point

TEMPLATE = PACKAGE / "template"


def main(parser: ArgumentParser, words: list[str]) -> None:
    """Make the folder of a study. Raises Fault."""
    parser.add_argument(
        "folder",
        type=Path,
        metavar="FOLDER",
        help="where the study will lie; its name is the study's",
    )
    parser.add_argument(
        "--from",
        type=Path,
        dest="map",
        metavar="MAP",
        help="a map file of your own; needs --start and --target",
    )
    parser.add_argument("--start", metavar="X,Y", help="where paths begin on that map, in its unit")
    parser.add_argument("--target", metavar="X,Y", help="where they end")
    arguments = parser.parse_args(words)
    reading.check_name(arguments.folder.name, str(arguments.folder))
    if arguments.folder.exists():
        raise Fault(f"{arguments.folder}: is there already; expected a new folder")
    if not arguments.folder.parent.is_dir():
        raise Fault(
            f"{arguments.folder}: no folder {arguments.folder.parent}; expected one that exists"
        )
    if arguments.map is None and (arguments.start or arguments.target):
        raise Fault("--start and --target: expected only with --from, a map of your own")
    map_file = _own_map(arguments.map, arguments.start, arguments.target) if arguments.map else None
    shutil.copytree(TEMPLATE, arguments.folder, ignore=shutil.ignore_patterns("__pycache__"))
    _replace(arguments.folder / "README.md", "mystudy", arguments.folder.name)
    if map_file:
        _put(arguments.folder, *map_file)
    print(f"{arguments.folder}: a study; next: bezierplan run {arguments.folder}")


Ends = dict[str, list[float]]


def _own_map(file: Path, start: str | None, target: str | None) -> tuple[list[Path], dict, Ends]:
    """The files of a map, its workspace as a study describes it, and the ends of the paths. Raises
    ValueError for a faulty map.
    """
    ends = {"start": list(point("--start", start)), "target": list(point("--target", target))}
    workspace = described(file, cells=True)
    files.load(workspace, file.parent)
    return files.sources(workspace, file.parent), workspace, ends


def _put(folder: Path, sources: list[Path], workspace: dict, ends: Ends) -> None:
    """Put a map in the place of the room. The claims and the published number are about the room,
    so they go.
    """
    for source in sources:
        shutil.copyfile(source, folder / source.name)
    (folder / "room.txt").unlink()
    shutil.rmtree(folder / "published")
    (folder / "claims.yaml").unlink()
    _replace(folder / "artefacts.yaml", "    published: lengths.csv\n", "")
    experiments = folder / "experiments.yaml"
    _replace(experiments, "^  room:.*\n", f"  room: {_flow(workspace)}")
    _replace(experiments, "^  across:.*\n", f"  across: {_flow({'workspace': 'room'} | ends)}")


def _replace(file: Path, old: str, new: str) -> None:
    """Put a text in the place of what a regular expression finds in a file."""
    text = re.sub(old, lambda _: new, file.read_text(encoding="utf-8"), flags=re.MULTILINE)
    file.write_text(text, encoding="utf-8")


def _flow(mapping: dict) -> str:
    return yaml.safe_dump(mapping, default_flow_style=True, sort_keys=False, width=1000)
