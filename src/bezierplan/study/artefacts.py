"""Models of `artefacts.yaml` (tables, figures and printed names), `layout.yaml` and the
configuration.

Kinds of table and of figure are defined beside the code that makes them.
"""

from typing import Annotated, Literal

from pydantic import Field

from bezierplan.analysis.table_kinds import TABLES, TableEntry
from bezierplan.figures import style
from bezierplan.figures.figure import Figure
from bezierplan.figures.layout import Layout
from bezierplan.schema.model import Line, Model, Name, build_choice_type, build_list_type
from bezierplan.study.experiments import SettingsByPlanner


class ArtefactsFile(Model):
    """The content of `artefacts.yaml`."""

    labels: dict[Line, Line] = Field(
        {},
        description="name of a method, problem, workspace, column, metric or value → how it is "
        "printed",
    )
    looks: dict[Name, Literal[tuple(style.LOOKS)]] = Field(
        {},
        description="name of a method → how it looks in every figure: "
        + ", ".join(style.LOOKS)
        + "; left out: as its planner does in all "
        "studies, or unlike most other methods",
    )
    tables: dict[Name, Annotated[TableEntry, build_choice_type("kind", TABLES)]] = Field(
        {}, description="name → a table"
    )
    figures: dict[Name, Figure] = Field({}, description="name → title, columns and panels")


class LayoutFile(Model):
    """The content of `layout.yaml`."""

    layout: dict[Name, Layout] = Field(
        description="name of a table or figure of a paper → how the paper prints it"
    )


class ConfigFile(Model):
    """The content of `config/config.yaml`, or of `--config`."""

    studies: build_list_type(Line) = Field(
        description="a list of studies, each the name of a folder in `config/studies` or a path"
    )
    settings: dict[Name, SettingsByPlanner] = Field(
        {},
        description="study → settings that override those of the same name in its "
        "`experiments.yaml`",
    )
