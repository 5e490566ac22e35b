"""Files that the code of a study opens while a job works: what the job makes follows from them too.

They are known when the job is done. So they are kept beside Snakemake's own records, by the key of
the job, with the digests of what they held; the next start of the workflow sees which have changed.
"""

import importlib.util
import json
import os
import sys
import traceback
from collections.abc import Iterable
from functools import cache
from pathlib import Path
from typing import Any

from bezierplan.machine.digest import compute_content_digest, keep_json
from bezierplan.machine.modules import USERS
from bezierplan.places import PACKAGE, find_cache_folder, find_user_cache_folder, shorten_path

OPENS = "opens "
RECORDS = Path(".snakemake") / "opened"
SEEN: set[str] = set()
"""The files that were opened in this process, and in processes that it has awaited."""

# What belongs to the system, to libraries, to this package or to a user's caches.
_ELSEWHERE = (
    *("/proc/", "/sys/", "/dev/", "/etc/", "/usr/", f"{Path.home()}/."),
    *map(
        os.path.realpath,
        (sys.prefix, sys.base_prefix, PACKAGE, find_cache_folder(), find_user_cache_folder()),
    ),
)


@cache
def watch() -> None:
    """From now on note each file that the code of a study opens to read."""
    sys.addaudithook(_note)


def _note(event: str, arguments: tuple[Any, ...]) -> None:
    if event != "open" or not isinstance(arguments[0], str | bytes):
        return
    frames = (frame.f_globals for frame, _ in traceback.walk_stack(None))
    of_study = any(str(own.get("__name__")).startswith(USERS) for own in frames)
    if arguments[2] & (os.O_WRONLY | os.O_RDWR) or not of_study:
        return
    file = os.path.realpath(os.fsdecode(arguments[0]))
    if file.endswith(".pyc"):
        file = importlib.util.source_from_cache(file)
    if "__pycache__" not in file and not file.startswith(_ELSEWHERE):
        SEEN.add(file)


def keep(job: str, sources: Iterable[str | Path]) -> None:
    """Keep the files that this process has noted but for some, for the job of a key."""
    before, files = read_kept(job), filter(os.path.isfile, SEEN - {*map(os.path.realpath, sources)})
    if new := {f"{OPENS}{shorten_path(Path(file))}" for file in files} - before.keys():
        keep_json(before | hash_contents(sorted(new)), RECORDS / f"{job}.json")


def read_kept(job: str) -> dict[str, str]:
    """Return what was kept for a job: `opens FILE` -> the digest of what the file first held."""
    file = RECORDS / f"{job}.json"
    return json.loads(file.read_text()) if file.is_file() else {}


def hash_contents(names: Iterable[str]) -> dict[str, str]:
    """Return, by each name `opens FILE`, the digest of what the file holds now."""
    return {
        name: compute_content_digest(name.removeprefix(OPENS))
        for name in names
        if name.startswith(OPENS)
    }
