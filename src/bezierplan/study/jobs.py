"""The jobs of the workflow, each declared once: a class whose fields are all values that a job
depends on, and whose `run` is the function that works. From that function, and from the modules
that the values name, follows the digest of code (`Job.digest`) by which Snakemake sees that a job
must run again. Files stand in the rules alone.

`run` imports what it needs itself: the workflow makes jobs at every start, and imports none of it.
"""

import hashlib
import inspect
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any, Self

from bezierplan.analysis.claims.claim import Claim
from bezierplan.analysis.claims.material import Shown
from bezierplan.analysis.sensitivity import Tried
from bezierplan.analysis.table_kinds import Layout, Pivot, Table
from bezierplan.figures import style
from bezierplan.figures.panels import Panel
from bezierplan.machine.digest import content_digest, function_digest, module_of
from bezierplan.planners import PLACE
from bezierplan.running.chunk import Chunk
from bezierplan.running.descriptions import Descriptions
from bezierplan.running.inputs import Shows
from bezierplan.schema.model import keys, one_or_list
from bezierplan.study import alternatives
from bezierplan.study.artefacts import Figure as FigureOfStudy
from bezierplan.study.definition import Study, relative
from bezierplan.workspaces.kinds import kind_of

Studies = dict[str, Study]


@dataclass(frozen=True)
class Job(ABC):
    """What a job is made of. `of` makes it from the studies and the wildcards of its rule.

    shows: experiment, or study/experiment -> method -> number of chunks: the results that it reads,
    in the order of its input files.
    """

    shows: Shows = field(default_factory=dict, kw_only=True)

    @classmethod
    @abstractmethod
    def of(cls, studies: Studies, **wildcards: str) -> Self:
        """The job of some wildcards."""

    @abstractmethod
    def run(self, input_files: Any, output_files: Any, threads: int) -> None:
        """Do the work with the files of a rule, by their names there."""

    def __str__(self) -> str:
        """For reports, whose readers' browsers must not run words of a study."""
        return type(self).__name__

    def modules(self) -> Iterable[str]:
        """Modules that `run` imports by name, because of the values."""
        return ()

    @property
    def digest(self) -> str:
        """Of the values, and of the code that works, with the versions of libraries that compute.
        Objects that have the same text are the same.
        """
        values = repr([(each.name, getattr(self, each.name)) for each in fields(self)])
        works = tuple(
            function
            for name, function in inspect.getmembers(type(self), inspect.isfunction)
            if not name.startswith("__") and name != "modules"
        )
        code = function_digest(works, *sorted(set(self.modules())))
        return f"{hashlib.sha256(values.encode()).hexdigest()[:16]} {code}"


@dataclass(frozen=True)
class Analysis(Job):
    """A job for which the code of a study itself is needed."""

    code: list[str] = field(default_factory=list, kw_only=True)
    """Its modules."""

    def modules(self) -> Iterable[str]:
        """Those of the study."""
        return self.code

    def load(self) -> dict[str, Callable[..., Any]]:
        """Load the study's own code; its functions by name."""
        from bezierplan.analysis import study_code

        return study_code.functions(self.code)


# --------------------------------------------------------------------------------------------------
# Problems, bounds and runs


def problems_job(study: Study, experiment: str, scale: str) -> Descriptions:
    """What the problems of an experiment depend on, except the content of map files."""
    problems = {
        name: {key: value for key, value in problem.items() if key != "settings"}
        for name, problem in study.problems_of(experiment, scale).items()
    }
    workspaces = {
        name: study.described(name)
        for name in sorted({problem["workspace"] for problem in problems.values()})
    }
    return Descriptions(study.key, problems, workspaces)


def kinds_of_workspace(workspaces: dict[str, dict]) -> list[str]:
    """Modules of the kinds of some workspaces, and of functions that draw them."""
    functions = [each["file"] for each in workspaces.values() if "function" in each]
    return [*(kind_of(each).__name__ for each in workspaces.values()), *functions]


@dataclass(frozen=True)
class Problems(Job):
    """The problems of an experiment: drawn once, shared by all its methods."""

    descriptions: Descriptions
    folder: str
    maps: str
    """Digest of map files."""

    @classmethod
    def of(cls, studies, scale, study, experiment):
        """Problems; of an experiment of drives, with their worlds."""
        content, kind = studies[study], Worlds if studies[study].moves(experiment) else Problems
        described = problems_job(content, experiment, scale)
        maps = content_digest(*content.maps(described.workspaces))
        return kind(described, relative(content.folder), maps)

    def modules(self):
        """Those of the kinds of workspace."""
        return kinds_of_workspace(self.descriptions.workspaces)

    def run(self, input_files, output_files, threads):
        """Build the problems."""
        from bezierplan.running import problems

        built = problems.build_all(self.descriptions, Path(self.folder))
        problems.write(built, self.descriptions.homes, output_files[0])


@dataclass(frozen=True)
class Worlds(Problems):
    """The problems of an experiment of drives, with the worlds that move."""

    def run(self, input_files, output_files, threads):
        """Build the problems and worlds."""
        from bezierplan.running import worlds

        built, moving = worlds.build_all(self.descriptions, Path(self.folder))
        worlds.write(built, self.descriptions.homes, moving, output_files[0])


@dataclass(frozen=True)
class Bounds(Job):
    """The exact shortest path of each problem of an experiment."""

    @classmethod
    def of(cls, studies, scale, study, experiment):
        """Bounds; of an experiment of drives, what no robot can beat."""
        return (BoundsOfDrives if studies[study].moves(experiment) else Bounds)()

    def run(self, input_files, output_files, threads):
        """Compute the bounds."""
        import pyarrow.parquet as parquet

        from bezierplan.running import problems

        parquet.write_table(
            problems.bounds_of(problems.read(input_files.problems)), output_files[0]
        )


@dataclass(frozen=True)
class BoundsOfDrives(Bounds):
    """For each problem what no robot can beat."""

    def run(self, input_files, output_files, threads):
        """Compute the bounds."""
        import pyarrow.parquet as parquet

        from bezierplan.running import problems, rides, worlds

        file = input_files.problems
        parquet.write_table(
            rides.bounds_of(problems.read(file), worlds.read(file)), output_files[0]
        )


def job(study: Study, experiment: str, method: str, scale: str, number: int) -> Chunk:
    """A chunk of runs, which always runs whole, whatever the number of requested repeats."""
    content = study.experiments[experiment]
    size = content.chunk[scale]
    settings = study.resolved(method).items()
    first = number * size
    vary = {
        name: [value for value in values if content.runs_of(scale, name, value) > first]
        for name, values in content.vary.items()
    }
    return Chunk(
        study=study.key,
        experiment=experiment,
        method=method,
        planner=study.planner(method),
        settings={name: value for name, value in settings if name not in content.vary},
        problems=_problems_met(study, experiment, method, scale, first),
        vary=vary,
        presets={name: preset for name, preset in study.presets.items() if name in content.vary},
        seeds=content.seeds,
        repeats=[first, first + size],
        time_limit=content.time_limit,
        policy=study.policies[study.methods[method].policy].model_dump()
        if study.moves(experiment)
        else None,
    )


def _problems_met(
    study: Study, experiment: str, method: str, scale: str, first: int
) -> dict[str, dict]:
    """Places of an experiment's problems that have the repeat `first`, by name, with those of their
    settings that a method leaves open.
    """
    accepted = study.accepted(method).keys() - study.methods[method].settings.keys()
    met = {}
    for name, problem in study.problems_of(experiment, scale, first).items():
        settings = {
            key: value for key, value in problem.get("settings", {}).items() if key in accepted
        }
        place = {key: problem[key] for key in PLACE if key in problem}
        met[name] = place | ({"settings": settings} if settings else {})
    return met


def chunks(study: Study, experiment: str, method: str, scale: str) -> range:
    """Numbers of the chunks that contain a method's repeats in an experiment at a scale, under the
    condition with the most.
    """
    content = study.experiments[experiment]
    factors = {"method": [method], "problem": content.problems} | content.vary
    repeats = min(
        max(content.runs_of(scale, factor, value) for value in values)
        for factor, values in factors.items()
    )
    return range(-(-repeats // content.chunk[scale]))


def chunks_of(study: Study, experiment: str, methods: Iterable[str], scale: str) -> dict[str, int]:
    """Number of chunks of each of some methods."""
    return {method: len(chunks(study, experiment, method, scale)) for method in methods}


@dataclass(frozen=True)
class Runs(Job):
    """A method on every condition of an experiment, one block of repeats."""

    chunk: Chunk

    @classmethod
    def of(cls, studies, scale, study, experiment, method, chunk):
        """Runs; of an experiment of drives, drives."""
        kind = Drives if studies[study].moves(experiment) else Runs
        return kind(job(studies[study], experiment, method, scale, int(chunk)))

    def modules(self):
        """The planner."""
        return [module_of(self.chunk.planner)]

    def run(self, input_files, output_files, threads):
        """Run the method."""
        import pyarrow.parquet as parquet

        from bezierplan.running import execution, problems, rows

        runs, times = execution.run_chunk(problems.read(input_files.problems), self.chunk)
        rows.write(runs, output_files.runs)
        parquet.write_table(times, output_files.times)


@dataclass(frozen=True)
class Drives(Runs):
    """A robot that drives under every condition of an experiment, one block of repeats."""

    def run(self, input_files, output_files, threads):
        """Let the robot drive."""
        import pyarrow.parquet as parquet

        from bezierplan.running import problems, rides, rows, worlds

        runs, times, traces = rides.run_chunk(
            problems.read(input_files.problems), worlds.read(input_files.problems), self.chunk
        )
        rows.write(runs, output_files.runs)
        parquet.write_table(times, output_files.times)
        parquet.write_table(traces, output_files.traces, compression="zstd")


@dataclass(frozen=True)
class Judgement(Job):
    """The runs of a method in an experiment, judged again from their rows, in a process that no
    planner was in, before anything reads them.
    """

    chunks: list[Chunk]

    @classmethod
    def of(cls, studies, scale, study, experiment, method):
        """All chunks of the scale."""
        own = studies[study]
        numbers = chunks(own, experiment, method, scale)
        return cls(
            [job(own, experiment, method, scale, number) for number in numbers],
            shows={experiment: {method: len(numbers)}},
        )

    def run(self, input_files, output_files, threads):
        """Judge the runs."""
        from bezierplan.running.judge import recheck

        files = dict(zip(input_files.runs, self.chunks, strict=True))
        verdict = recheck.judged(recheck.Task(input_files.problems[0], files))
        recheck.write(recheck.sound(verdict), output_files[0])


# --------------------------------------------------------------------------------------------------
# Tables and figures


def experiments_of(study: Study, artefact: str) -> list[str]:
    """Names of the experiments whose results an artefact shows, each once, in order."""
    if artefact in study.tables:
        return [study.compared()[artefact].experiment] if artefact in study.compared() else []
    shown = [getattr(panel, "experiment", None) for panel in study.figures[artefact].panels]
    return list(dict.fromkeys(filter(None, shown)))


def methods_of(study: Study, artefact: str, experiment: str) -> list[str]:
    """Methods of an experiment whose runs an artefact needs: for a table of the paper's form those
    it selects, for another all (the comparison shows them), for a figure those it selects,
    including baselines if named.
    """
    methods = study.experiments[experiment].methods
    if artefact in study.tables:
        spec = study.compared()[artefact]
        return (
            one_or_list(spec.where.get("method", methods))
            if spec.printed
            else study.methods_of(experiment)
        )
    needed = set()
    for panel in study.figures[artefact].panels:
        if getattr(panel, "experiment", None) == experiment:
            needed.update(one_or_list(panel.where.get("method", methods)))
    return [method for method in study.methods_of(experiment) if method in needed]


def shown_by(study: Study, artefact: str, scale: str) -> Shows:
    """The results that a table or figure shows."""
    return {
        name: chunks_of(study, name, methods_of(study, artefact, name), scale)
        for name in experiments_of(study, artefact)
    }


def looks(study: Study) -> dict[str, str]:
    """Method -> the name of its look in every figure."""
    return style.looks_of({method: study.planner(method) for method in study.methods}, study.looks)


def labels_of(study: Study, artefact: str) -> dict[str, str]:
    """Labels, except those of methods, problems and workspaces that a table or figure cannot show.
    A function may name any.
    """
    spec = (study.tables.get(artefact) or study.figures[artefact]).plain()
    panels = spec.get("panels", [])
    if spec.get("kind") in ("function", "comparison") or any("data" in panel for panel in panels):
        return study.labels
    shown = {panel["method"] for panel in panels if "method" in panel}
    for experiment in experiments_of(study, artefact):
        content = study.experiments[experiment]
        shown |= {*study.methods_of(experiment), *content.problems}
        shown |= {str(value) for values in content.vary.values() for value in values}
        for problem in (study.problems[name] for name in content.problems):
            shown |= {problem.workspace, problem.route}
    names = study.methods.keys() | study.problems.keys() | study.workspaces.keys()
    return {
        name: label for name, label in study.labels.items() if name in shown or name not in names
    } | spec.get("labels", {})


@dataclass(frozen=True)
class TableOfRuns(Analysis):
    """A table of runs, and its comparison with published numbers."""

    name: str
    """`study/table`, of the table that it extends, so that equal rows have equal numbers."""
    spec: Pivot
    """Without its title, which stands in the caption alone."""
    labels: dict[str, str]
    """Name -> how it is printed."""
    variants: dict[str, str]
    """Method -> the method whose published numbers it is compared with."""
    baselines: list[str]
    repeats: int
    published: str
    """Digest of the file of published numbers."""

    @classmethod
    def of(cls, studies, scale, study, table, tree=""):
        """The table of a name."""
        content = studies[study]
        spec = content.whole(table)
        experiment = content.experiments[spec.experiment]
        # The experiment's own methods unless the table selects some: baselines appear only in the
        # comparison, and there with variants, unless the table has the paper's form.
        where = {"method": experiment.methods} | spec.where
        if spec.printed:
            where |= spec.primary
        more = {} if spec.printed else content.variants()
        baselines = [] if spec.printed else content.methods_of(spec.experiment)
        file = content.published_file(table)
        return cls(
            name=f"{study}/{spec.extends or table}",
            spec=spec.but(title=table, note=None, labels={}, monotone=[], fitted=[], where=where),
            labels=labels_of(content, table),
            variants={name: method for name, method in more.items() if name in experiment.methods},
            baselines=[name for name in baselines if name in content.baselines],
            repeats=experiment.repeats[scale],
            published=content_digest(file) if file else "",
            shows=shown_by(content, table, scale),
            code=content.code_for("metrics"),
        )

    def run(self, input_files, output_files, threads):
        """Make the table and its comparison."""
        import pandas as pd

        from bezierplan.analysis import comparison, results, tables
        from bezierplan.running import inputs

        self.load()
        ((experiment, files),) = inputs.experiments(self.shows, input_files).items()
        runs = results.read(files, self.repeats, experiment)
        file = input_files.published[0] if self.published else None
        published = comparison.read_published(file, self.spec)
        compared = comparison.compare(
            runs, self.spec, published, self.variants, self.baselines, self.name
        )
        table = tables.pivot(runs, self.spec, self.labels)
        table.to_csv(output_files.table, lineterminator="\n")
        if self.spec.printed:
            compared = compared[compared["value_published"].notna()]
            numbers = pd.read_csv(file, dtype=str, keep_default_na=False)
            verdicts = compared.assign(value=compared["verdict"].fillna(""))
            for rows, laid in ((numbers, output_files.published), (verdicts, output_files.marks)):
                laid_out = tables.alike(rows, self.spec, self.labels, like=table)
                laid_out.to_csv(laid, lineterminator="\n")
        compared.to_csv(
            output_files.comparison, index=False, float_format="%.10g", lineterminator="\n"
        )


@dataclass(frozen=True)
class TableWithoutRuns(Analysis):
    """What a paper prints, or what follows from it."""

    spec: Table
    """Without its title."""
    published: str
    """Digest of files of published numbers."""

    @classmethod
    def of(cls, studies, scale, study, table, tree=""):
        """The table of a name."""
        content = studies[study]
        spec = content.tables[table].but(title=table)
        code = content.code_for("functions") if spec.kind == "function" else []
        published = content_digest(*content.published_of(table))
        return cls(spec, published, code=code)

    def run(self, input_files, output_files, threads):
        """Make the table."""
        from bezierplan.analysis import listing
        from bezierplan.running import inputs

        published = inputs.by_table(input_files.published)
        table = listing.table(self.spec, published, self.load())
        table.to_csv(output_files[0], index=False, float_format="%.10g", lineterminator="\n")


@dataclass(frozen=True)
class Latex(Job):
    """A table as LaTeX, with its caption, which alone holds the title. One of the paper's form has
    the printed numbers in the same cells.
    """

    label: str
    caption: str
    note: str | None

    @classmethod
    def of(cls, studies, scale, study, table, tree=""):
        """The table of a name."""
        content = studies[study]
        return cls(f"{study}-{table}", caption(content, table, scale), content.tables[table].note)

    def run(self, input_files, output_files, threads):
        """Set the table."""
        import pandas as pd

        from bezierplan.analysis import latex

        table, *beside = (
            pd.read_csv(file, dtype=str, keep_default_na=False)
            for file in [input_files.table, *input_files.beside]
        )
        notes = [self.note] if self.note else []
        if beside:
            table, notes = latex.laid_over(table, *beside), [latex.LEGEND, *notes]
        text = latex.document(table, self.caption, f"tab:{self.label}", notes)
        Path(output_files[0]).write_text(text, encoding="utf-8")


@dataclass(frozen=True)
class Figure(Analysis):
    """A figure: pictures, exactly the data drawn in them, and what its caption says of the runs."""

    study: str
    columns: int
    width: str
    """Of the sheet, a key of `style.WIDTHS`."""
    panels: list[Panel]
    labels: dict[str, str]
    """Name -> how it is printed."""
    looks: dict[str, str]
    """Method -> the name of its look."""
    workspaces: dict[str, dict[str, Any]]
    """By name, those that are drawn without runs, as their files describe them."""
    repeats: dict[str, int]
    """By experiment."""
    chunks: dict[str, dict[str, Chunk]]
    """Those whose runs the figure reruns, to draw what no table keeps, by experiment and method."""
    unit: str
    """That of lengths."""
    folder: str
    """That of the study, with its maps."""
    sources: str
    """Digest of map files and published numbers."""

    @classmethod
    def of(cls, studies, scale, study, figure, tree=""):
        """The figure of a name."""
        content = studies[study]
        spec, experiments = content.figures[figure], experiments_of(content, figure)
        again = {panel.experiment for panel in spec.panels if panel.rerun}
        bare = workspaces_of_figure(content, figure)
        any_method = any(getattr(panel, "data", None) for panel in spec.panels)
        own = {"functions": any_method, "panels": any(panel.kind == "own" for panel in spec.panels)}
        parts = ["metrics", *(part for part, needed in own.items() if needed)]
        methods = {method for name in experiments for method in content.methods_of(name)}
        first = (
            content.problems[content.experiments[experiments[0]].problems[0]]
            if experiments
            else None
        )
        home = first.workspace if first else [*bare, *content.workspaces][0]
        return cls(
            study=study,
            columns=spec.columns,
            width=spec.width,
            panels=spec.panels,
            labels=labels_of(content, figure),
            looks={
                name: look for name, look in looks(content).items() if any_method or name in methods
            },
            workspaces={name: content.workspaces[name].plain() for name in bare},
            repeats={name: content.experiments[name].repeats[scale] for name in experiments},
            chunks={
                name: {
                    method: job(content, name, method, scale, 0)
                    for method in methods_of(content, figure, name)
                }
                for name in sorted(again)
            },
            unit=content.workspaces[home].unit,
            folder=relative(content.folder),
            sources=content_digest(*content.maps(bare), *content.published_drawn(figure)),
            shows=shown_by(content, figure, scale),
            code=content.code_for(*parts),
        )

    def modules(self):
        """Kinds of panel and workspace, and planners that run again."""
        again = [chunk.planner for methods in self.chunks.values() for chunk in methods.values()]
        return [
            *super().modules(),
            *(type(panel).__module__ for panel in self.panels),
            *map(module_of, again),
            *kinds_of_workspace(self.workspaces),
        ]

    def run(self, input_files, output_files, threads):
        """Draw the figure from its data, which are first written and read back."""
        from bezierplan.analysis import results, study_code
        from bezierplan.figures import sheet
        from bezierplan.figures.panels import Sources
        from bezierplan.running import inputs
        from bezierplan.workspaces import files as workspace_files

        published = {
            name: results.published_table(file)
            for name, file in inputs.by_table(input_files.published).items()
        }
        numbers = results.joined_numbers(published)
        read = results.read_all(inputs.experiments(self.shows, input_files), self.repeats)
        experiments = {
            name: runs._replace(published=numbers, jobs=self.chunks.get(name))
            for name, runs in read.items()
        }
        workspaces = {
            name: workspace_files.load(described, Path(self.folder))
            for name, described in self.workspaces.items()
        }
        problems = {name: runs.problems for name, runs in experiments.items()}
        drawings = study_code.part_of(
            [name for name in self.code if study_code.part(name) == "panels"]
        )
        scene = sheet.Scene(problems, workspaces, self.labels, self.unit, self.looks, drawings)
        sources = Sources(experiments, workspaces, self.load(), published, self.study)
        sheet.write_data(sheet.data(self.panels, sources), output_files.data)
        figure = sheet.draw(
            self.panels, sheet.read_data(output_files.data), scene, self.columns, self.width
        )
        sheet.save(figure, output_files.svg, output_files.png, output_files.pdf)
        Path(output_files.caption).write_text(f"{figure.get_label()}\n", encoding="utf-8")


def workspaces_of_figure(study: Study, figure: str) -> list[str]:
    """Names of the workspaces that a figure draws without runs."""
    panels = study.figures[figure].panels
    return sorted({panel.workspace for panel in panels if getattr(panel, "workspace", None)})


def caption(study: Study, artefact: str, scale: str) -> str:
    """The caption of a table or figure: title, how it mirrors the paper's, and the repeats in
    force. The page has the settings of each method.
    """
    spec = study.tables.get(artefact) or study.figures[artefact]
    sentences = [spec.title, getattr(spec, "mirrors", None)]
    for experiment in experiments_of(study, artefact):
        content = study.experiments[experiment]
        most = "at most " if scale == "extended" and content.fewer else ""
        repeats = content.repeats[scale]
        sentences.append(f"{experiment}: {most}{repeats} runs of each method on each problem")
    return ". ".join(filter(None, sentences)) + "."


def escaped(text: str) -> str:
    """Text as one line of literal reStructuredText: no markup, no directive, no HTML."""
    return "".join(
        f"\\{sign}" if sign.isascii() and not sign.isalnum() and sign != " " else sign
        for sign in " ".join(text.split())
    )


# --------------------------------------------------------------------------------------------------
# Claims, audit, alternatives


@dataclass(frozen=True)
class Claims(Analysis):
    """The claims of a study, judged on the runs of some experiments."""

    study: str
    claims: list[Claim]
    artefacts: dict[str, list[Shown]]
    """What each table and figure shows of runs."""
    variant_of: dict[str, str]
    """Method -> the method whose published numbers count."""
    paired: dict[str, bool]
    """By experiment, whether runs with equal repeat numbers share a start or a random workspace."""
    paper_repeats: dict[str, int]
    """By experiment, repeats of the paper, used if the printed numbers do not state them."""
    labels: dict[str, str]
    repeats: dict[str, int]
    """By experiment, the repeats that are judged."""
    published: str
    """Digest of files of published numbers."""

    @classmethod
    def of(cls, studies, scale, study):
        """The claims of a study."""
        content = studies[study]
        claims = [claim for claim in content.claims if claim.scale in (None, scale)]
        shows = {
            name: chunks_of(content, name, content.experiments[name].methods, scale)
            for name in alternatives.experiments_of_claims(claims)
        }
        return cls(**_claims(content, claims, scale), shows=shows)

    def modules(self):
        """Kinds of check as well."""
        kinds = {check.test for claim in self.claims for check in claim.checks}
        return [*super().modules(), *(f"bezierplan.analysis.claims.kinds.{kind}" for kind in kinds)]

    def files(self, input_files, output_files):
        """Files of the results by experiment."""
        from bezierplan.running import inputs

        return inputs.experiments(self.shows, input_files)

    def run(self, input_files, output_files, threads):
        """Judge the claims."""
        from bezierplan.analysis import results
        from bezierplan.analysis.claims import judge
        from bezierplan.running import inputs

        judged, checks = judge.judge(
            self.claims,
            results.read_all(self.files(input_files, output_files), self.repeats),
            {
                name: results.published_table(file)
                for name, file in inputs.by_table(input_files.published).items()
            },
            self.artefacts,
            self.study,
            self.load(),
            variant_of=self.variant_of,
            paired=self.paired,
            repeats=self.paper_repeats,
            labels=self.labels,
        )
        for table, file in ((judged, output_files.claims), (checks, output_files.checks)):
            table.to_csv(file, index=False, float_format="%.10g", lineterminator="\n")


def _claims(study: Study, claims: list[Claim], scale: str) -> dict[str, Any]:
    """Fields of the job that judges some claims of a study."""
    experiments = {
        name: study.experiments[name] for name in alternatives.experiments_of_claims(claims)
    }
    return {
        "study": study.key,
        "code": study.code_for("metrics", "functions"),
        "claims": claims,
        "artefacts": {
            name: parts
            for name, artefact in (study.tables | study.figures).items()
            if (parts := _shown(artefact))
        },
        "variant_of": study.variants(),
        "paired": {name: experiment.paired for name, experiment in experiments.items()},
        "paper_repeats": {
            name: experiment.repeats["full"] for name, experiment in experiments.items()
        },
        "labels": study.labels,
        "repeats": {name: experiment.repeats[scale] for name, experiment in experiments.items()},
        "published": content_digest(*study.published_files()),
    }


def _shown(artefact: Table | FigureOfStudy) -> list[Shown]:
    """What a table or figure shows of runs."""
    if isinstance(artefact, Pivot):
        entry = {name: each for name, each in artefact.plain().items() if name in keys(Shown)}
        return [Shown.model_validate(entry)]
    panels = artefact.panels if isinstance(artefact, FigureOfStudy) else []
    return [
        Shown(experiment=panel.experiment, where=panel.where)
        for panel in panels
        if getattr(panel, "experiment", None)
    ]


@dataclass(frozen=True)
class Alternative(Claims):
    """Claims judged in their primary variant on runs with one alternative of an assumption, which
    this job makes, and on the other methods' runs by default. One job, for most of its chunks take
    less time than starting a process.
    """

    chunks: list[tuple[int, Chunk]]
    """Numbers and chunks of runs that the alternative changes."""

    @classmethod
    def of(cls, studies, scale, study, alternative):
        """The alternative of a name."""
        content = studies[study]
        tried = alternatives.with_alternative(content, alternative)
        claims = alternatives.headline_claims(content, alternative)
        changed = alternatives.methods_changed(content, alternative)
        methods = {
            name: alternatives.methods_of_claims(content, claims, name)
            for name in alternatives.experiments_of_claims(claims)
        }
        return cls(
            **_claims(content, claims, scale),
            chunks=[
                (number, job(tried, name, method, scale, number))
                for name, compared in methods.items()
                for method in compared
                if method in changed
                for number in chunks(content, name, method, scale)
            ],
            shows={
                name: chunks_of(
                    content, name, [one for one in compared if one not in changed], scale
                )
                for name, compared in methods.items()
            },
        )

    def modules(self):
        """Planners as well."""
        return [*super().modules(), *(module_of(chunk.planner) for _, chunk in self.chunks)]

    def files(self, input_files, output_files):
        """Files of the results by experiment, with the runs that are made here."""
        from bezierplan.running import again, inputs

        return again.with_chunks(
            inputs.experiments(self.shows, input_files), self.chunks, Path(output_files.runs)
        )


@dataclass(frozen=True)
class Sensitivity(Job):
    """Verdicts under each alternative beside those under the defaults."""

    described: dict[str, Tried]

    @classmethod
    def of(cls, studies, scale, study):
        """The alternatives of a study."""
        return cls(alternatives.alternatives_described(studies[study]))

    def run(self, input_files, output_files, threads):
        """Compare the verdicts."""
        import pandas as pd

        from bezierplan.analysis import sensitivity

        tried = {
            name: pd.read_csv(file)
            for name, file in zip(self.described, input_files.alternatives, strict=True)
        }
        table = sensitivity.sensitivity(pd.read_csv(input_files.claims), tried, self.described)
        table.to_csv(output_files[0], index=False, float_format="%.10g", lineterminator="\n")


@dataclass(frozen=True)
class Audit(Analysis):
    """A paper's own numbers, checked against each other and against exact bounds."""

    study: str
    tables: dict[str, str]
    """Table of published numbers -> the experiment that reproduces it."""
    primary: dict[str, dict]
    """By table, the rows that count as the paper's interpretation: column -> value."""
    layouts: dict[str, Layout]
    """By table."""
    identified: list[str]
    """Experiments among whose paths printed lengths are sought."""
    published: str
    """Digest of files of published numbers."""

    @classmethod
    def of(cls, studies, scale, study):
        """The audit of a study."""
        content = studies[study]
        tables = {Path(each.published).stem: each for each in content.with_published().values()}
        return cls(
            study,
            {name: table.experiment for name, table in tables.items()},
            {name: table.primary for name, table in tables.items()},
            {name: Layout.of(table) for name, table in tables.items()},
            sorted({table.experiment for table in tables.values() if table.identify}),
            content_digest(*content.published_files()),
            code=content.code_for("metrics", "audit"),
            shows={name: {} for name in sorted({each.experiment for each in tables.values()})},
        )

    def run(self, input_files, output_files, threads):
        """Check the numbers."""
        from bezierplan.analysis import audit, study_code
        from bezierplan.running import inputs

        self.load()
        files = inputs.experiments(self.shows, input_files)
        table = audit.audited(
            self,
            study_code.audit(self.code),
            {name: files[name].problems for name in self.identified},
            {name: each.bounds for name, each in files.items()},
            inputs.by_table(input_files.published),
        )
        table.to_csv(output_files[0], index=False, float_format="%.10g", lineterminator="\n")


# --------------------------------------------------------------------------------------------------
# All studies together


@dataclass(frozen=True)
class BaselineComparison(Job):
    """The methods of all studies beside the baselines that the studies name."""

    baselines: dict[str, tuple[str, str | None]]
    """By study, and the method that its paper proposes."""
    repeats: dict[str, int]
    """By study/experiment."""

    @classmethod
    def of(cls, studies, scale):
        """The studies that name a baseline."""
        baselines, repeats, shows = {}, {}, {}
        for key, study in studies.items():
            if compared := study.baseline_comparison:
                baselines[key] = (compared.baseline, compared.proposed)
                for name in compared.experiments:
                    content = study.experiments[name]
                    methods = [*content.methods, compared.baseline]
                    repeats[f"{key}/{name}"] = content.repeats[scale]
                    shows[f"{key}/{name}"] = chunks_of(study, name, methods, scale)
        return cls(baselines, repeats, shows=shows)

    def run(self, input_files, output_files, threads):
        """Measure the methods."""
        from bezierplan.analysis import baseline_comparison
        from bezierplan.running import inputs

        rows = baseline_comparison.of_studies(
            self.baselines, self.repeats, inputs.experiments(self.shows, input_files)
        )
        rows.to_csv(output_files[0], index=False, float_format="%.6g", lineterminator="\n")


@dataclass(frozen=True)
class Summary(Analysis):
    """The numbers and claims of all studies."""

    scale: str
    tables: list[tuple[str, str]]
    """Study and table of each comparison with published numbers, in order."""
    titles: dict[str, str]
    """Those of the studies."""
    verdicts: dict[str, str]
    """Study -> the digest of its sentences of what follows, of those that have any."""

    @classmethod
    def of(cls, studies, scale):
        """All studies."""
        tables = [
            (key, name) for key, content in studies.items() for name in content.with_published()
        ]
        titles = {key: content.title for key, content in studies.items()}
        texts = {key: content.verdict_file() for key, content in studies.items()}
        digests = {key: content_digest(file) for key, file in texts.items() if file}
        code = [module for content in studies.values() for module in content.code_for("metrics")]
        return cls(scale, tables, titles, digests, code=code)

    def run(self, input_files, output_files, threads):
        """Gather them."""
        from bezierplan.analysis import summary

        self.load()
        summed = summary.gathered(
            dict(zip(self.tables, input_files.comparisons, strict=True)),
            self.titles,
            list(input_files.claims),
            input_files.baseline_comparison,
            dict(zip(self.verdicts, input_files.verdicts, strict=True)),
            list(input_files.audits),
            self.scale,
        )
        for table, file in (
            (summed.numbers, output_files.numbers),
            (summed.claims, output_files.claims),
            (summed.wholes, output_files.wholes),
        ):
            table.to_csv(file, index=False, float_format="%.10g", lineterminator="\n")
        Path(output_files.summary).write_text(summed.report, encoding="utf-8")


@dataclass(frozen=True)
class Verdict(Job):
    """What follows for a paper."""

    study: str
    text: str
    """Digest of its sentences."""

    @classmethod
    def of(cls, studies, scale, study):
        """That of a study."""
        return cls(study, content_digest(studies[study].verdict_file()))

    def run(self, input_files, output_files, threads):
        """Put the numbers into the sentences."""
        import pandas as pd

        from bezierplan.analysis import summary

        tables = [pd.read_csv(file) for file in input_files.summary]
        files = {self.study: input_files.verdict[0]}
        texts = summary.verdicts(*tables, files, [input_files.audit])
        Path(output_files[0]).write_text(texts[self.study], encoding="utf-8")
