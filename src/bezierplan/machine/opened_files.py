"""Files that a study's code opens while a job works. The job's results follow from them too.

They are known when the job is done. So they are kept beside Snakemake's own records, by the key of
the job, with digests of their content; the next start of the workflow sees which have changed.
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
"""Files that were opened in this process, and in processes that it has awaited."""

# Files of the system, of libraries, of this package and of a user's caches are not noted.
_ELSEWHERE = (
    *("/proc/", "/sys/", "/dev/", "/etc/", "/usr/", f"{Path.home()}/."),
    *map(
        os.path.realpath,
        (sys.prefix, sys.base_prefix, PACKAGE, find_cache_folder(), find_user_cache_folder()),
    ),
)


@cache
def watch() -> None:
    """Note from now on each file that a study's code opens to read."""
    sys.addaudithook(_note)


def _note(event: str, arguments: tuple[Any, ...]) -> None:
    """Note a file, if a study's code opens it to read (an audit hook of Python)."""
    if event != "open" or not isinstance(arguments[0], str | bytes):
        return
    frames = (frame.f_globals for frame, _ in traceback.walk_stack(None))
    of_study = any(str(own.get("__name__")).startswith(USERS) for own in frames)
    if arguments[2] & (os.O_WRONLY | os.O_RDWR) or not of_study:
        return
    file = os.path.realpath(os.fsdecode(arguments[0]))
    # The source counts: Python writes the compiled file by itself.
    if file.endswith(".pyc"):
        file = importlib.util.source_from_cache(file)
    if "__pycache__" not in file and not file.startswith(_ELSEWHERE):
        SEEN.add(file)


def keep(job: str, sources: Iterable[str | Path]) -> None:
    """Keep the files that this process has noted, except for `sources`, for the job of a key."""
    before, files = read_kept(job), filter(os.path.isfile, SEEN - {*map(os.path.realpath, sources)})
    if new := {f"{OPENS}{shorten_path(Path(file))}" for file in files} - before.keys():
        keep_json(before | hash_contents(sorted(new)), RECORDS / f"{job}.json")


def read_kept(job: str) -> dict[str, str]:
    """Return what was kept for a job: by `opens FILE`, the digest of what the file first held."""
    file = RECORDS / f"{job}.json"
    return json.loads(file.read_text()) if file.is_file() else {}


def hash_contents(names: Iterable[str]) -> dict[str, str]:
    """Return the digests of what files hold now, by `opens FILE`, for names of this form."""
    return {
        name: compute_content_digest(name.removeprefix(OPENS))
        for name in names
        if name.startswith(OPENS)
    }
