"""Files of a study's folder."""

from pathlib import Path

from bezierplan.schema.checked import Fault


def inside(folder: Path, name: str, location: str) -> Path:
    """A file in a study's folder. Raises Fault, beginning with a location, if it is missing, is not
    a regular file, or lies outside the folder, also through a link.
    """
    file = folder / name
    if not file.resolve().is_relative_to(folder.resolve()):
        raise Fault(f"{location}: lies outside the study's folder; expected a file in it")
    if not file.is_file():
        reason = "not a regular file" if file.exists() else "no such file"
        raise Fault(f"{location}: {reason} in {file.parent.name or file.parent}")
    return file
