"""A study as its files define it."""

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
    """A study as its files define it: a paper of this project, or a user's own folder of the same
    form (config/README.md). The fields hold the content of the files.
    """

    claims: Sequence[Claim] = ()
    assumptions: Sequence[AssumptionEntry] = ()
    readings: Sequence[ReadingEntry] = ()
    fitted: Mapping = {}
    layout: Mapping[str, Layout] = {}
    values: Mapping[str, Any] = {}
    """Assumption id -> value in place of the default (`alternatives.apply_values`)."""

    # What follows from a study is kept by the study itself, whose fields are no keys of a mapping.
    __hash__ = object.__hash__

    def list_governed_methods(self, assumption: AssumptionEntry) -> list[str]:
        """Return the methods whose setting an assumption governs: those that it names, otherwise
        all except baselines and variants.
        """
        of = assumption.methods or [
            name
            for name, method in self.methods.items()
            if name not in self.baselines and not method.variant_of
        ]
        return [
            method for method in of if assumption.setting in self.read_accepted_settings(method)
        ]

    def find_changed_settings(self, method: str, problem: str = "") -> dict[str, Any]:
        """Return the settings of a method that `values` change, by name.

        problem: the settings that change on this problem alone; empty for those that change
        everywhere.
        """
        chosen = [
            each
            for each in self.assumptions
            if each.id in self.values and method in self.list_governed_methods(each)
        ]
        governed, settings = {each.setting for each in chosen}, {}
        for each in chosen:
            if problem in (each.problems or [""]):
                along = each.along.get(method, {}).items()
                # A setting that another chosen assumption governs keeps that assumption's value.
                settings |= {name: value for name, value in along if name not in governed}
                settings[each.setting] = self.values[each.id]
        return settings

    def maps(self, workspaces: Iterable[str]) -> list[str]:
        """Return the map files of workspaces, each once, relative to the working folder."""
        named = (files.sources(self.workspaces[name].plain(), self.folder) for name in workspaces)
        return sorted({shorten_path(file) for each in named for file in each})

    def list_names(self, folder: str) -> list[str]:
        """Return the names of the tables and figures in a folder of results.

        folder: `paper` for those that the paper numbers (for all, if it numbers none), `beyond` for
        the others.
        """
        names = [*self.tables, *self.figures]
        numbered = [name for name in names if choose_tree(name) == PAPER] or names
        return numbered if folder == PAPER else [name for name in names if name not in numbered]

    def artefact(self, name: str) -> TableEntry | Figure:
        """Return the table or figure of a name."""
        return self.tables.get(name) or self.figures[name]

    def files_of(self, name: str) -> list[str]:
        """Return the files of a table or figure, relative to the folder of the study's results."""
        endings = ["svg", "png", "pdf", "csv", "txt"] if name in self.figures else ["csv", "tex"]
        if name in self.find_published_tables():
            endings += ["comparison.csv", "published.csv"]
        return [f"{choose_tree(name)}/{name}.{ending}" for ending in endings]

    def find_tables_of_runs(self) -> dict[str, Pivot]:
        """Return those of the study's tables that summarise runs (kind `pivot`), by name."""
        return {name: table for name, table in self.tables.items() if isinstance(table, Pivot)}

    def find_published_file(self, table: str) -> str | None:
        """Return the file of a table's published numbers, relative to the working folder; None
        without one.
        """
        file = getattr(self.tables[table], "published", None)
        return file and shorten_path(self.folder / "published" / file)

    def list_reconstructed_workspaces(self, table: Pivot) -> list[str]:
        """Return the workspaces of a table whose maps the paper does not print, drawn ones too."""
        problems = self.problems_of(table.experiment, "full")
        shown = convert_to_list(table.where.get("problem", [*problems]))
        names = sorted({problems[name]["workspace"] for name in shown})
        return [name for name in names if self.workspaces[name].origin == "reconstructed"]

    def own_methods(self, experiment: str, artefact: str) -> list[str]:
        """Return the methods of an experiment that a table or figure shows unless it selects some.
        A table or figure of the paper shows no variants.
        """
        of_paper = choose_tree(artefact) == PAPER or artefact in self.find_published_tables()
        methods = self.experiments[experiment].methods
        return [name for name in methods if not (of_paper and name in self.variants())]

    def find_published_tables(self) -> dict[str, Pivot]:
        """Return the tables of runs that have published numbers, by name."""
        return {
            name: table for name, table in self.find_tables_of_runs().items() if table.published
        }

    def verdict_file(self) -> str | None:
        """Return the file with the sentences of the study's verdict, relative to the working
        folder; None if it has none.
        """
        file = self.folder / "verdict.yaml"
        return shorten_path(file) if file.is_file() else None

    def list_published_files(self) -> list[str]:
        """Return all files of published numbers, relative to the working folder."""
        return [shorten_path(file) for file in sorted((self.folder / "published").glob("*.csv"))]

    def variants(self) -> dict[str, str]:
        """Return the methods with whose published numbers variants are compared, by variant."""
        return {
            name: method.variant_of for name, method in self.methods.items() if method.variant_of
        }
