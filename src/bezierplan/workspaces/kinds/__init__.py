"""One file per kind of workspace, here or in a folder `worlds` of `papers`: `Options`, the keys of
its description, and how it is made.

- `Options`: the keys that a description of this kind may have
- `load(description, folder)`: the workspace of a description, if it is fixed; files are looked up
  in a folder
- `sources(description, folder)`: the files from which it is read, if they are more than those that
  its keys name
- `draw(description, problem, name)`: the workspace of a problem, if it is random; seeded by the
  name of study and workspace
- `world(description, problem, name, folder, length)`: the world of a problem, if the kind moves

A description is a mapping, as written in experiments.yaml; coordinates are in its unit, at most 1e5
in absolute value. `length(map)` is the length of the shortest path from cell to cell between the
ends of the problem. All faults are ValueErrors of one line.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Annotated, Any, ClassVar, Literal

from pydantic import AfterValidator, Field

from bezierplan.machine.modules import find_kinds, load_module
from bezierplan.schema.checked import Fault
from bezierplan.schema.model import (
    Line,
    Model,
    NotNegative,
    Number,
    Positive,
    build_error,
    build_name_type,
    build_text_type,
    build_value_type,
    build_whole_type,
    is_line,
    is_number,
)
from bezierplan.workspaces.limits import SMALLEST_FEATURE
from bezierplan.workspaces.text_file import read_text


def _is_file_name(entry: Any) -> bool:
    """Tell whether an entry can be a file's name, which Snakemake does not read as a pattern."""
    return is_line(entry) and not set("{}*?[]\\") & set(entry)


FileName: Any = build_value_type(_is_file_name, "the name of a file, without { } * ? [ ]")
File: Any = build_name_type("file", FileName)
Unit: Any = build_text_type(r"[^\W\d_]{1,20}", "letters, 20 at most")


def build_numbers_type(length: int, form: str) -> Any:
    """Build a type of list of so many numbers. form: what is expected, for messages.

    >>> from pydantic import TypeAdapter
    >>> TypeAdapter(build_numbers_type(2, "[x, y]")).validate_python([1, 2])
    [1, 2]
    """

    def check(entry: list) -> list:
        if len(entry) != length:
            raise build_error(f"{entry!r}: expected {form}")
        return entry

    return Annotated[list[Number], AfterValidator(check)]


Size: Any = build_value_type(
    lambda entry: is_number(entry) and entry >= SMALLEST_FEATURE,
    f"a number of at least {SMALLEST_FEATURE:g}",
)
"""A side or a radius of something solid, in units."""

Bounds: Any = build_numbers_type(4, "[x low, x high, y low, y high]")
SmallCount: Any = build_whole_type(1, 10_000)

# Descriptions of keys shared by several kinds.
REFLECTED = "[x low, x high, y low, y high]; centres of circles that move are reflected there"
UNKNOWN = "whether unknown pixels count as occupied or free"
CIRCLES = "how many circles a layout has, a whole number from 1 to 10000"


class Workspace(Model):
    """Keys common to all workspaces, and facts about a kind.

    drawn_kind: for a random workspace, the kind that planners see.
    given_kind: the same for any other, unless the name of the kind says it.
    with_side: true if its problems have a `side`.
    moves: true for a world, in which runs are simulated drives.
    """

    drawn_kind: ClassVar[str | None] = None
    given_kind: ClassVar[str | None] = None
    with_side: ClassVar[bool] = False
    moves: ClassVar[bool] = False

    kind: Line = Field(description="the name of a file in `src/bezierplan/workspaces/kinds`")
    unit: Unit = Field(description="the name of the unit of length, up to 20 letters")
    origin: Literal["printed", "reconstructed"] = Field(
        "printed",
        description="printed, or reconstructed: a map that the paper does not print, so that none "
        "of its numbers agrees or disagrees with ours, and none is compared with our bounds; "
        "left out: printed",
    )


class CellMap(Workspace):
    """Keys common to workspaces that begin with a map of cells."""

    file: File = Field(description="a map file in the study's folder")
    cell: Size = Field(description="the side of a cell, a number of at least 1e-6")


class World(Workspace):
    """Keys common to all worlds, in which obstacles move or cells change."""

    moves = True

    pace: Positive = Field(
        description="how far a robot drives in a step, in units, a number above 0"
    )
    steps: SmallCount = Field(
        description="the moment at which every drive in this world ends, "
        "in steps, a whole number from 1 to 10000"
    )


class RandomMoving(World):
    """Keys common to worlds with circles that move from random places in random directions."""

    clear_ends: NotNegative = Field(
        description="how far start and target are from a circle at first, at least 0"
    )
    speed: NotNegative = Field(
        description="how far every circle moves in a step, in units, a number of at least 0; "
        "their directions are random"
    )


def _places() -> dict[str, str]:
    """Return the modules of all kinds by name, here and in `papers`."""
    return find_kinds("workspaces/kinds", "worlds")


def kind_of(description: dict) -> ModuleType:
    """Import the module of a description's kind of workspace."""
    return load_module(_places()[description["kind"]])


def modules_of(workspaces: dict[str, dict]) -> list[str]:
    """List the modules of the kinds of some workspaces, and of functions that draw them."""
    functions = [each["file"] for each in workspaces.values() if "function" in each]
    return [*(_places()[each["kind"]] for each in workspaces.values()), *functions]


@cache
def kinds() -> dict[str, type[Workspace]]:
    """Return the keys of descriptions by kind of workspace: fixed, then random, then worlds."""
    found = {name: load_module(place).Options for name, place in _places().items()}
    return dict(
        sorted(found.items(), key=lambda each: (each[1].moves, bool(each[1].drawn_kind), each[0]))
    )


def text(description: dict, key: str, folder: Path) -> str:
    """Read the text of the file whose name a description gives under a key.

    Raises ValueError with both names.
    """
    with naming(f"{key}: {description[key]}"):
        return read_text(folder / description[key])


@contextmanager
def naming(file: str) -> Iterator[None]:
    """Prefix the message of a ValueError, as one line, with a file's name, or a key and the
    file.
    """
    try:
        yield
    except ValueError as error:
        # A fault is one line; its cause would add more.
        raise Fault(f"{file}: {error}") from None
