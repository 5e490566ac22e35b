"""A study as defined by its files."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from bezierplan.analysis.claims.claim import Claim
from bezierplan.analysis.table_kinds import Pivot, TableEntry
from bezierplan.figures.figure import Figure
from bezierplan.figures.layout import Layout
from bezierplan.places import shorten_path
from bezierplan.running.inputs import PAPER, choose_tree
from bezierplan.schema.model import convert_to_list
from bezierplan.study.artefacts import ArtefactsFile
from bezierplan.study.claims import AssumptionEntry, ReadingEntry
from bezierplan.study.experiments import Experiments
from bezierplan.workspaces import files


class Study(Experiments, ArtefactsFile):
    """A study as defined by its files: a paper of this project or a user's own folder of the same
    form (config/README.md).

    Its fields are what stands in the files.
    """

    claims: Sequence[Claim] = ()
    assumptions: Sequence[AssumptionEntry] = ()
    readings: Sequence[ReadingEntry] = ()
    fitted: Mapping = {}
    layout: Mapping[str, Layout] = {}
    values: Mapping[str, Any] = {}
    """Id of an assumption -> the value that it has instead of the default (`alternatives.under`).
    """

    def concerned(self, assumption: AssumptionEntry) -> list[str]:
        """Return the methods whose setting an assumption governs, except baselines and variants;
        only those that it names, if any.
        """
        of = assumption.methods or [
            name
            for name, method in self.methods.items()
            if name not in self.baselines and not method.variant_of
        ]
        return [method for method in of if assumption.setting in self.accepted(method)]

    def changed(self, method: str, problem: str = "") -> dict[str, Any]:
        """Return the settings of a method that `values` change: everywhere, or on a problem."""
        chosen = [
            each
            for each in self.assumptions
            if each.id in self.values and method in self.concerned(each)
        ]
        governed, settings = {each.setting for each in chosen}, {}
        for each in chosen:
            if problem in (each.problems or [""]):
                along = each.along.get(method, {}).items()
                settings |= {name: value for name, value in along if name not in governed}
                settings[each.setting] = self.values[each.id]
        return settings

    def maps(self, workspaces: Iterable[str]) -> list[str]:
        """Map files of workspaces relative to the working folder, each once."""
        named = (files.sources(self.workspaces[name].plain(), self.folder) for name in workspaces)
        return sorted({shorten_path(file) for each in named for file in each})

    def named(self, folder: str) -> list[str]:
        """Names of the tables and figures of a tree: `paper`, those that the paper numbers; a study
        without such has all of its own there. `beyond`: the others.
        """
        names = [*self.tables, *self.figures]
        numbered = [name for name in names if choose_tree(name) == PAPER] or names
        return numbered if folder == PAPER else [name for name in names if name not in numbered]

    def artefact(self, name: str) -> TableEntry | Figure:
        """A table or figure."""
        return self.tables.get(name) or self.figures[name]

    def files_of(self, name: str) -> list[str]:
        """The files of a table or figure, in the folder of the study's results."""
        if name in self.figures:
            endings = ["svg", "png", "pdf", "csv", "notes.txt", "txt"]
        else:
            endings = ["csv", "tex"]
        if name in self.compared():
            endings.append("comparison.csv")
        if name in self.with_published():
            endings += ["published.csv", "wholes.csv"]
        return [f"{choose_tree(name)}/{name}.{ending}" for ending in endings]

    def compared(self) -> dict[str, Pivot]:
        """The tables of runs, which are compared with published numbers; the others have none."""
        return {name: table for name, table in self.tables.items() if isinstance(table, Pivot)}

    def whole(self, table: str) -> TableEntry:
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
        return file and shorten_path(self.folder / "published" / file)

    def reconstructed(self, table: Pivot) -> list[str]:
        """Return the problems of a table on maps that the paper does not print."""
        problems = self.experiments[table.experiment].problems
        shown = convert_to_list(table.where.get("problem", problems))
        return [
            name
            for name in problems
            if name in shown and self.workspace_of(name).origin == "reconstructed"
        ]

    def own_methods(self, experiment: str, artefact: str) -> list[str]:
        """The methods of an experiment in a table or figure that selects none: without variants,
        where it is one of the paper's.
        """
        of_paper = choose_tree(artefact) == PAPER or artefact in self.with_published()
        methods = self.experiments[experiment].methods
        return [name for name in methods if not (of_paper and name in self.variants())]

    def with_published(self) -> dict[str, Pivot]:
        """The tables of runs that have published numbers."""
        return {name: table for name, table in self.compared().items() if table.published}

    def verdict_file(self) -> str | None:
        """Its sentences of what follows, relative to the working folder, or None."""
        file = self.folder / "verdict.yaml"
        return shorten_path(file) if file.is_file() else None

    def published_files(self) -> list[str]:
        """All files of published numbers, relative to the working folder."""
        return [shorten_path(file) for file in sorted((self.folder / "published").glob("*.csv"))]

    def variants(self) -> dict[str, str]:
        """Method -> the method whose published numbers it is compared with."""
        return {
            name: method.variant_of for name, method in self.methods.items() if method.variant_of
        }
