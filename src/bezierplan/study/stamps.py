"""Studies that were checked before: one file for each content, with the study as it was read, so
that a start reads and checks only what has changed.

Most of a start would otherwise be spent on YAML, and on building every problem of every study. The
name of a stamp is a digest of all files in the study's folder and of this package, so nothing can
be stale.

A stamp is a pickle, from which models come back five times as fast as from JSON through their
checks. It is read only if nobody else can have written it, and only what a study consists of is
made from it: no stamp can call a function.
"""

import contextlib
import hashlib
import io
import os
import pickle
import stat
import sys
from dataclasses import replace
from functools import cache
from pathlib import Path

import pydantic

from bezierplan.places import PACKAGE, cache_folder
from bezierplan.running.digest import ROOT
from bezierplan.schema.model import Model
from bezierplan.study.definition import Study

STAMPS = cache_folder() / "studies"

# A folder with more than this, in bytes, is checked at every start: reading it would take longer.
MOST_READ = 100_000_000


def stamp_of(folder: Path, changed: str = "") -> Path | None:
    """Where the stamp of a study's folder lies; None if its content cannot be known: links, other
    special files, or too much of it.

    changed: what a configuration puts in the place of the study's own, as text.
    """
    digest = hashlib.sha256(_package().encode())
    digest.update(f"{folder.resolve().name}{changed}".encode())
    read = 0
    try:
        for place, folders, names in os.walk(folder):
            folders[:] = sorted(name for name in folders if name != "__pycache__")
            for path in [Path(place, name) for name in (*folders, *sorted(names))]:
                if path.is_symlink() or not (path.is_file() or path.is_dir()):
                    return None
                if path.is_file():
                    read += path.stat().st_size
                    if read > MOST_READ:
                        return None
                    digest.update(
                        f"\0{path.relative_to(folder)}\0".encode()
                        + hashlib.sha256(path.read_bytes()).digest()
                    )
    except OSError:
        return None
    return STAMPS / digest.hexdigest()[:32]


class _Unpickler(pickle.Unpickler):
    """Makes models of this package, studies, and plain values."""

    def find_class(self, module: str, name: str) -> type:
        """The class of a name. Raises UnpicklingError for anything else that a pickle can call."""
        if (module, name) in (
            ("builtins", "frozenset"),
            ("builtins", "set"),
            ("pathlib", "PosixPath"),
            ("pathlib", "WindowsPath"),
        ):
            return super().find_class(module, name)
        part = (
            super().find_class(module, name)
            if module.split(".")[0] == ROOT and "." not in name
            else None
        )
        if isinstance(part, type) and issubclass(part, Model | Study) and part.__module__ == module:
            return part
        raise pickle.UnpicklingError(f"{module}.{name}: no part of a study")


def _is_ours(path: Path) -> bool:
    """Whether a file or folder belongs to this user, and nobody else can write it."""
    found = path.lstat()
    return found.st_uid == os.getuid() and not found.st_mode & (stat.S_IWGRP | stat.S_IWOTH)


def remembered(stamp: Path | None, folder: Path) -> Study | None:
    """The study of a stamp, which now lies in a folder; None if there is none, or the stamp is
    damaged, or others could have written it.
    """
    try:
        if stamp and _is_ours(stamp.parent) and _is_ours(stamp):
            return replace(_Unpickler(io.BytesIO(stamp.read_bytes())).load(), folder=folder)
    except Exception:  # a damaged pickle raises almost anything
        return None
    return None


def remember(stamp: Path | None, study: Study) -> None:
    """Keep a study that was checked, unless the folder of stamps cannot be written."""
    if stamp:
        with contextlib.suppress(OSError):
            stamp.parent.mkdir(parents=True, exist_ok=True)
            # Whatever the user's mask says, others may not write here; in a folder that another
            # user made, nothing is kept.
            stamp.parent.chmod(0o700)
            part = stamp.with_suffix(f".{os.getpid()}")
            part.write_bytes(pickle.dumps(study))
            part.chmod(0o600)
            part.replace(stamp)


@cache
def _package() -> str:
    """The versions of Python and of pydantic, whose models a study consists of, and a digest of all
    files of this package.
    """
    files = sorted(PACKAGE.rglob("*.py"))
    return f"{sys.version} {pydantic.VERSION}" + "".join(
        f"{file.relative_to(PACKAGE)} {hashlib.sha256(file.read_bytes()).hexdigest()}"
        for file in files
    )
