"""Files of a study's folder."""

from pathlib import Path

from bezierplan.schema.checked import LONGEST_FILE, Fault


def inside(folder: Path, name: str, location: str) -> Path:
    """A file in a study's folder. Raises Fault, beginning with a location, if it is missing, lies
    outside the folder (also through a link), is not a regular file, or has more than `LONGEST_FILE`
    bytes.
    """
    file = folder / name
    try:
        lies_inside = file.resolve().is_relative_to(folder.resolve())
        if not lies_inside:
            raise Fault(f"{location}: lies outside the study's folder; expected a file in it")
        if not file.exists():
            raise Fault(f"{location}: no such file in {file.parent.name or file.parent}")
        if not file.is_file():
            raise Fault(f"{location}: not a regular file")
        size = file.stat().st_size
    except (OSError, ValueError) as error:
        if isinstance(error, Fault):
            raise
        raise Fault(f"{location}: cannot be read ({type(error).__name__})") from None
    if size > LONGEST_FILE:
        raise Fault(f"{location}: {size} bytes; expected at most {LONGEST_FILE}")
    return file
