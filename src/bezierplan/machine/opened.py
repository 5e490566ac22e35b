"""Files that the code of a study opens while a job works: what the job makes follows from them too.

They are known when the job is done. So they are kept beside Snakemake's own records, by the key of
the job, with the digests of what they held; the next start of the workflow sees which have changed.
"""

import importlib.util
import json
import os
import sys
from collections.abc import Iterable
from functools import cache
from pathlib import Path
from typing import Any

from bezierplan.machine.digest import content_digest
from bezierplan.machine.modules import USERS
from bezierplan.places import PACKAGE, cache_folder, relative

OPENS = "opens "
RECORDS = Path(".snakemake") / "opened"
SEEN: set[str] = set()
"""The files that were opened in this process, and in processes that it has awaited."""

# What belongs to the system, to a library, to a user's caches or to this package.
_SYSTEM = ("/proc", "/sys", "/dev", "/etc", "/usr", sys.prefix, sys.base_prefix)
_ELSEWHERE = (
    *(f"{os.path.realpath(folder)}/" for folder in (*_SYSTEM, PACKAGE, cache_folder())),
    f"{os.path.realpath(Path.home())}/.",
)


@cache
def watch() -> None:
    """From now on note each file that the code of a study opens to read."""
    sys.addaudithook(_note)


def _note(event: str, arguments: tuple[Any, ...]) -> None:
    if event != "open" or not isinstance(arguments[0], str | bytes):
        return
    if arguments[2] & (os.O_WRONLY | os.O_RDWR) or not _is_of_study():
        return
    file = os.path.realpath(os.fsdecode(arguments[0]))
    if file.endswith(".pyc"):
        file = importlib.util.source_from_cache(file)
    if "__pycache__" not in file and not file.startswith(_ELSEWHERE) and os.path.isfile(file):
        SEEN.add(file)


def _is_of_study() -> bool:
    """Return whether the code that runs was called by that of a study."""
    frame = sys._getframe(2)
    while frame:
        if str(frame.f_globals.get("__name__")).startswith(USERS):
            return True
        frame = frame.f_back
    return False


def keep(job: str, known: Iterable[str | Path]) -> None:
    """Keep the files that this process has noted but for some, for the job of a key."""
    before, files = kept(job), filter(os.path.isfile, SEEN - {*map(os.path.realpath, known)})
    if new := {f"{OPENS}{relative(Path(file))}" for file in files} - before.keys():
        file = RECORDS / f"{job}.json"
        file.parent.mkdir(parents=True, exist_ok=True)
        part = file.with_suffix(f".{os.getpid()}")
        part.write_text(json.dumps(before | contents(sorted(new))))
        part.replace(file)


def kept(job: str) -> dict[str, str]:
    """Return what was kept for a job: `opens FILE` -> the digest of what the file first held."""
    file = RECORDS / f"{job}.json"
    return json.loads(file.read_text()) if file.is_file() else {}


def contents(names: Iterable[str]) -> dict[str, str]:
    """Return, by each name `opens FILE`, the digest of what the file holds now."""
    return {
        name: content_digest(name.removeprefix(OPENS)) for name in names if name.startswith(OPENS)
    }
