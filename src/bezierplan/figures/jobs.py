"""Jobs of the workflow that draw figures, set tables for print and write the page of a scale
(`analysis.jobs`).
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from bezierplan.analysis.jobs import Job
from bezierplan.figures.layout import Layout
from bezierplan.figures.page.page_job import PageJob
from bezierplan.figures.panels import Panel
from bezierplan.machine.digest import name_module
from bezierplan.running.chunk import Chunk
from bezierplan.running.descriptions import Descriptions
from bezierplan.workspaces.kinds import modules_of


@dataclass(frozen=True)
class Latex(Job):
    """Write a table as LaTeX with its caption.

    A table of the paper's form has the printed numbers in the same cells.
    """

    label: str
    caption: str
    note: str | None
    heads: int = 0
    """How many columns name the rows of a table of the paper's form."""

    def run(self, input_files, output_files):
        """Write the table as LaTeX."""
        import pandas as pd

        from bezierplan.analysis.numbers import comparison
        from bezierplan.figures import latex

        table, *beside = (
            # As text: the last zero of 1.50 and a cell with the word NA stay.
            pd.read_csv(file, dtype=str, keep_default_na=False)
            for file in [input_files.table, *input_files.beside]
        )
        notes = [self.note] if self.note else []
        if beside:
            table = latex.stack_numbers(table, *beside, self.heads)
            notes = [comparison.SIGNS_MEAN, *notes]
        text = latex.format_table(table, self.caption, f"tab:{self.label}", notes)
        Path(output_files[0]).write_text(text, encoding="utf-8")


@dataclass(frozen=True)
class FigureFiles(Job):
    """Draw a figure: pictures, the data drawn in them, and its caption with notes on the runs."""

    caption: str
    columns: int
    width: str
    """Width of the sheet, a key of `style.WIDTHS`."""
    panels: list[Panel]
    layout: Layout | None
    """The form of the paper's figure, if it is one of a paper."""
    labels: dict[str, str]
    """Name -> printed name."""
    looks: dict[str, str]
    """Method -> the name of its look."""
    workspaces: dict[str, dict[str, Any]]
    """Name -> description, for workspaces that are drawn without runs."""
    problems: Descriptions
    """Problems that are drawn without runs."""
    repeats: dict[str, int]
    """Experiment -> number of repeats."""
    chunks: dict[str, dict[str, Chunk]]
    """Experiment -> method -> chunk whose runs are repeated, to draw values that no table keeps."""
    unit: str
    """The unit of lengths."""
    folder: str
    """The study's folder, with its maps."""
    alternatives: list[dict[str, str]]
    """Assumption, detail and value of each single alternative, in the order of its files."""

    def list_modules(self):
        """Return the modules of panels, of kinds of workspace and of planners that run again."""
        again = [chunk.planner for methods in self.chunks.values() for chunk in methods.values()]
        return [
            *self.code,
            *(type(panel).__module__ for panel in self.panels),
            *map(name_module, again),
            *modules_of(self.workspaces | self.problems.workspaces),
        ]

    def run(self, input_files, output_files):
        """Write the figure's data, read them back and draw them."""
        from bezierplan.analysis import results, study_code
        from bezierplan.analysis.claims import by_reading
        from bezierplan.figures import sheet
        from bezierplan.figures.panels import Sources
        from bezierplan.running import inputs
        from bezierplan.running import problems as problem_files
        from bezierplan.workspaces import files as workspace_files

        published = results.read_published_tables(input_files.sources)
        numbers = results.join_numbers(published)
        files = inputs.group_by_experiment(self.shows, input_files)
        experiments = {
            name: runs._replace(published=numbers, jobs=self.chunks.get(name))
            for name, runs in results.read_all(files, self.repeats).items()
        }
        workspaces = {
            name: workspace_files.load(described, Path(self.folder))
            for name, described in self.workspaces.items()
        }
        places, _ = problem_files.build_all(self.problems, Path(self.folder))
        problems = {name: runs.problems for name, runs in experiments.items()}
        drawings = study_code.load_part(self.code, "panels")
        scene = sheet.FigureScene(
            problems, workspaces, self.labels, self.unit, self.looks, drawings, self.layout, places
        )
        functions = study_code.load_functions(self.code)
        checks = [by_reading.read_checks(file) for file in input_files.alternatives]
        under = [*zip(self.alternatives, checks, strict=True)]
        sources = Sources(experiments, workspaces, functions, published, places, under)
        # Read back, so that pictures show exactly the content of the file.
        frame = sheet.store_data(sheet.collect_data(self.panels, sources), output_files.data)
        figure = sheet.draw(self.panels, frame, scene, self.columns, self.width)
        sheet.save(figure, output_files.svg, output_files.png, output_files.pdf)
        text = f"{self.caption}\n{figure.get_label()}\n"
        Path(output_files.caption).write_text(text, encoding="utf-8")


@dataclass(frozen=True)
class Page(Job):
    """Write the page of a scale, one file with all results."""

    page: PageJob

    def run(self, input_files, output_files):
        """Write the page as one html file."""
        from bezierplan.analysis import study_code
        from bezierplan.figures.page import EVIDENCE, build, reader

        study_code.load_functions(self.code)
        folder = Path(input_files.verified).parent
        page = build.gather_content(
            self.page,
            folder,
            list(input_files.summary),
            input_files.verified,
            reader.Evidence(*map(reader.read, EVIDENCE)) if self.page.outcome else None,
        )
        Path(output_files.page).write_text(build.render_page(page, folder), encoding="utf-8")
