"""Workspaces that a function of a study's `worlds.py` draws, one for each layout."""

from typing import Annotated, Literal

from pydantic import Field

from bezierplan.machine.modules import load_module
from bezierplan.schema.model import ARGUMENTS, Arguments, Name, Names
from bezierplan.workspaces import files
from bezierplan.workspaces.kinds import Workspace
from bezierplan.workspaces.seeds import generator


class Options(Workspace):
    """Keys of a workspace of kind `drawn`."""

    function: Annotated[Name, Names("world")] = Field(
        description="the name of a function of the study's `worlds.py`, called with a random "
        "generator and the problem: a mapping with `start`, `target`, `obstacles` and `layout`; it "
        "returns a workspace"
    )
    sees: Literal["circles", "grid", "polygons"] = Field(
        description="the kind of workspace that it returns: circles, grid or polygons"
    )
    arguments: Arguments = Field({}, description=ARGUMENTS)

    @property
    def drawn_kind(self) -> str:  # type: ignore[override]
        """Return the kind of workspace that planners see."""
        return self.sees


def draw(description: dict, problem: dict, name: str) -> files.Workspace:
    """Have a study's function draw the workspace of a layout.

    Its random numbers follow from the names of study and workspace, and from the layout's number,
    so that layouts with different numbers of obstacles can be nested.

    description: with `file`, the module of the function.

    Raises ValueError if the function returns another kind.
    """
    function = getattr(load_module(description["file"]), description["function"])
    rng = generator(name, problem["layout"])
    workspace: files.Workspace = function(rng, problem, **description.get("arguments", {}))
    if not isinstance(workspace, files.KINDS[description["sees"]]):
        raise ValueError(
            f"function: {function.__name__}: returns {type(workspace).__name__}; expected "
            f"{description['sees']}, as `sees` says"
        )
    return workspace
