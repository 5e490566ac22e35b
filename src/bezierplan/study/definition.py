"""A study as defined by its files."""

import itertools
import os
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from bezierplan.analysis.claims.claim import Claim
from bezierplan.analysis.table_kinds import Pivot, Table
from bezierplan.machine.modules import code_of
from bezierplan.planners import is_file, planner_module, planner_settings
from bezierplan.running.inputs import PAPER, tree
from bezierplan.schema.model import one_or_list
from bezierplan.study.artefacts import ArtefactsFile
from bezierplan.study.claims import Assumption
from bezierplan.study.experiments import ExperimentsFile
from bezierplan.workspaces import files
from bezierplan.workspaces.kinds import Workspace


class Study(ExperimentsFile, ArtefactsFile):
    """A study as defined by its files: a paper of this project or a user's own folder of the same
    form (config/README.md).

    key: its name; folder: its location; the others: what stands in the files. methods: with
    baselines.
    """

    key: str
    folder: Path
    claims: Sequence[Claim] = ()
    assumptions: Sequence[Assumption] = ()
    votes: dict

    def accepted(self, method: str) -> dict[str, Any]:
        """Settings accepted by a method's planner, with their annotations."""
        return planner_settings(planner_module(self.planner(method)))

    @property
    def of_planners(self) -> dict[str, dict[str, Any]]:
        """Planner -> settings of its methods alone."""
        return {name: each for name, each in self.settings.items() if isinstance(each, dict)}

    def resolved(self, method: str) -> dict[str, Any]:
        """All settings of a method, by name: the study's that its planner accepts, those of its
        planner, and its own.
        """
        accepted = self.accepted(method)
        common = {name: value for name, value in self.settings.items() if name in accepted}
        return (
            common
            | self.of_planners.get(self.methods[method].planner, {})
            | self.methods[method].settings
        )

    def planner(self, method: str) -> str:
        """The planner of a method: a name, or the path of a file relative to the working folder."""
        planner = self.methods[method].planner
        return relative(self.folder / planner) if is_file(planner) else planner

    def methods_of(self, experiment: str) -> list[str]:
        """Methods of an experiment, followed by the baselines that join: whose planner supports all
        its workspaces and has no setting that it varies.
        """
        content, moves = self.experiments[experiment], self.moves(experiment)
        kinds, methods = {self.kind_of(problem) for problem in content.problems}, [*content.methods]
        for name, baseline in self.baselines.items():
            module = planner_module(self.planner(name))
            varied = content.vary.keys() & self.accepted(name).keys()
            served = kinds <= set(getattr(module, "workspaces", kinds))
            if served and not varied and moves == bool(baseline.policy):
                methods.append(name)
        return methods

    def workspace_of(self, problem: str) -> Workspace:
        """The workspace of a problem."""
        return self.workspaces[self.problems[problem].workspace]

    def moves(self, experiment: str) -> bool:
        """Whether the runs of an experiment are simulated drives."""
        return any(
            self.workspace_of(problem).moves for problem in self.experiments[experiment].problems
        )

    def kind_of(self, problem: str) -> str:
        """The kind of workspace that planners see in a problem."""
        workspace = self.workspace_of(problem)
        return workspace.draws or workspace.gives or workspace.kind

    def problems_of(self, experiment: str, scale: str, repeat: int = 0) -> dict[str, dict]:
        """Descriptions of an experiment's problems that have a repeat, by name, as plain values.
        One with layouts expands to a problem for each layout and number of obstacles.
        """
        content, described = self.experiments[experiment], {}
        for name in content.problems:
            if content.runs_of(scale, "problem", name) <= repeat:
                continue
            problem = self.problems[name]
            if problem.layouts is None:
                described[name] = problem.plain()
                continue
            same = problem.plain("layouts", "obstacles")
            for layout, obstacles in itertools.product(
                range(problem.layouts[scale]), problem.obstacles
            ):
                described[f"{name}_{layout}_{obstacles}"] = same | {
                    "layout": layout,
                    "obstacles": obstacles,
                }
        return described

    def maps(self, workspaces: Iterable[str]) -> list[str]:
        """Map files of workspaces relative to the working folder, each once."""
        named = (files.sources(self.workspaces[name].plain(), self.folder) for name in workspaces)
        return sorted({relative(file) for each in named for file in each})

    def named(self, folder: str) -> list[str]:
        """Names of the tables and figures of a tree: `paper`, those that the paper numbers; a study
        without such has all of its own there. `beyond`: the others.
        """
        names = [*self.tables, *self.figures]
        numbered = [name for name in names if tree(name) == PAPER] or names
        return numbered if folder == PAPER else [name for name in names if name not in numbered]

    def compared(self) -> dict[str, Pivot]:
        """The tables of runs, which are compared with published numbers; the others have none."""
        return {name: table for name, table in self.tables.items() if isinstance(table, Pivot)}

    def whole(self, table: str) -> Table:
        """A table with what the one that it extends says of published numbers."""
        spec = self.tables[table]
        if not getattr(spec, "extends", None):
            return spec
        printed = self.tables[spec.extends]
        shared = ("published", "reads", "within", "primary", "identify")
        return spec.but(**{name: getattr(printed, name) for name in shared})

    def published_file(self, table: str) -> str | None:
        """The file of a table's published numbers relative to the working folder, or None."""
        file = getattr(self.whole(table), "published", None)
        return file and relative(self.folder / "published" / file)

    def reconstructed(self, table: Pivot) -> bool:
        """Whether runs of a table are on a map that the paper does not print."""
        problems = self.experiments[table.experiment].problems
        shown = one_or_list(table.where.get("problem", problems))
        return any(
            self.workspace_of(name).origin == "reconstructed" for name in problems if name in shown
        )

    def with_published(self) -> dict[str, Pivot]:
        """The tables of runs that have published numbers."""
        return {name: table for name, table in self.compared().items() if table.published}

    def verdict_file(self) -> str | None:
        """Its sentences of what follows, relative to the working folder, or None."""
        file = self.folder / "verdict.yaml"
        return relative(file) if file.is_file() else None

    def published_files(self) -> list[str]:
        """All files of published numbers, relative to the working folder."""
        return [relative(file) for file in sorted((self.folder / "published").glob("*.csv"))]

    def variants(self) -> dict[str, str]:
        """Method -> the method whose published numbers it is compared with."""
        return {
            name: method.variant_of for name, method in self.methods.items() if method.variant_of
        }

    def described(self, workspace: str) -> dict[str, Any]:
        """The description of a workspace as plain values, with the file of a function that draws
        it.
        """
        plain = self.workspaces[workspace].plain()
        return plain | {"file": self.code_for("worlds")[0]} if "function" in plain else plain

    def code_for(self, *parts: str) -> list[str]:
        """The modules of some parts of its code (`machine.modules`) that it has."""
        code = code_of(self.key, relative(self.folder))
        return [code[part] for part in parts if part in code]


def relative(path: Path) -> str:
    """A path relative to the working folder if it lies inside, so that a moved tree still finds its
    results; otherwise unchanged.
    """
    here = os.path.relpath(path)
    return str(path) if here.startswith("..") else here
