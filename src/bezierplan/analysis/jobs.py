"""The jobs of the workflow but those that draw, each declared once: a class whose fields are all
values that a job depends on, and whose `run` is the function that works. From both follows the
account of a job (`Job.account`), by which Snakemake sees that it must run again, and `verify` that
its files are what it makes.

`run` imports what it needs itself: the workflow makes jobs at every start, and imports none of it.
"""

from abc import ABC, abstractmethod
from collections.abc import Iterable
from dataclasses import dataclass, field, fields
from functools import cached_property
from pathlib import Path
from typing import Any

from bezierplan.analysis.claims.material import Material, StudyForClaims
from bezierplan.analysis.table_kinds import Pivot, TableEntry
from bezierplan.machine import opened_files
from bezierplan.machine.digest import (
    compute_content_digest,
    describe_code,
    find_sources,
    hash_text,
    name_module,
)
from bezierplan.machine.modules import is_file
from bezierplan.running.chunk import Chunk
from bezierplan.running.descriptions import Descriptions
from bezierplan.running.inputs import Shows
from bezierplan.workspaces.kinds import modules_of


@dataclass(frozen=True)
class Job(ABC):
    """One step of the workflow: its fields are all that it depends on, `run` is the work.

    shows: experiment, or study/experiment -> method -> number of chunks: the results that it reads,
    in the order of its input files. sources: other files that it reads, of the folder of a study.
    code: modules of the study's own code.
    """

    shows: Shows = field(default_factory=dict, kw_only=True)
    sources: list[str] = field(default_factory=list, kw_only=True)
    code: list[str] = field(default_factory=list, kw_only=True)

    @abstractmethod
    def run(self, input_files: Any, output_files: Any) -> None:
        """Do the work with the files of a rule, by their names there."""

    @staticmethod
    def write(table: Any, file: str) -> None:
        """Write a table to a csv file, without its index."""
        table.to_csv(file, index=False, float_format="%.10g", lineterminator="\n")

    def __str__(self) -> str:
        """Return the name of the class, for reports, whose readers' browsers must not run words of
        a study.
        """
        return type(self).__name__

    def list_modules(self) -> Iterable[str]:
        """List the modules that `run` imports by name, because of the values."""
        return self.code

    def run_recorded(self, input_files: Any, output_files: Any) -> None:
        """Run the job, and keep which files the code of a study opens meanwhile."""
        files = [name for name in self.list_modules() if is_file(name)]
        if files:
            opened_files.watch()
        self.run(input_files, output_files)
        if files:
            opened_files.keep(self.key, [*find_sources(*files), *self.sources])

    @cached_property
    def account(self) -> dict[str, str]:
        """Return what the job's files follow from, by name: digests of its values (settings), of
        the code that works and of its sources, and the versions of libraries that compute.

        Objects that have the same text are the same; where files lie does not count.
        """
        # Sources count by their content, and where files lie does not count.
        names = [each.name for each in fields(self) if each.name not in ("sources", "folder")]
        text = repr([(name, getattr(self, name)) for name in names])
        works = type(self).run, type(self).write
        return (
            {"settings": hash_text(text)}
            | describe_code(works, *sorted(set(self.list_modules())))
            | {"sources": compute_content_digest(*self.sources)}
        )

    @cached_property
    def key(self) -> str:
        """Return the digest of the account, under which the opened files are kept."""
        return hash_text(repr(self.account))

    @property
    def grounds(self) -> dict[str, str]:
        """Return the account by which a job runs again: with those files that have changed since
        the code of a study first opened them. Before its first run nobody knows them.
        """
        first = opened_files.read_kept(self.key)
        now = opened_files.hash_contents(first)
        return self.account | {name: now[name] for name in now if now[name] != first[name]}


@dataclass(frozen=True)
class Problems(Job):
    """The job that builds the problems of an experiment: drawn once, shared by all its methods."""

    descriptions: Descriptions
    folder: str

    def list_modules(self):
        """List the modules of the kinds of workspace."""
        return modules_of(self.descriptions.workspaces)

    def run(self, input_files, output_files):
        """Build the problems, with the worlds of those that move."""
        from bezierplan.running import problems

        built, moving = problems.build_all(self.descriptions, Path(self.folder))
        problems.write(built, self.descriptions.homes, output_files[0], moving)


@dataclass(frozen=True)
class Bounds(Job):
    """The job that computes the exact shortest path of each problem; for drives, the arrival that
    no robot can beat.
    """

    def run(self, input_files, output_files):
        """Compute the bounds of all problems."""
        from bezierplan.running import problems, table_files

        table = problems.compute_bounds(*problems.read(input_files.problems))
        table_files.write(table, output_files[0])


@dataclass(frozen=True)
class Runs(Job):
    """The job that runs a method under every condition of an experiment, one block of repeats."""

    chunk: Chunk

    def list_modules(self):
        """List the module of the planner."""
        return [name_module(self.chunk.planner)]

    def run(self, input_files, output_files):
        """Run the method, or let the robot drive."""
        import pyarrow.parquet as parquet

        from bezierplan.running import execution, problems, table_files

        built, moving = problems.read(input_files.problems)
        tables = execution.run_chunk(built, self.chunk, moving)
        table_files.write(tables[0], output_files.runs)
        parquet.write_table(tables[1], output_files.times)
        for traces in tables[2:]:
            parquet.write_table(traces, output_files.traces, compression="zstd")


@dataclass(frozen=True)
class Recheck(Job):
    """The job that judges the runs of some methods again from their rows, in a process that no
    planner was in, before anything reads them.
    """

    chunks: list[Chunk]

    def run(self, input_files, output_files):
        """Judge the runs again from their rows. Raises an error unless all are sound."""
        from bezierplan.running import recheck

        files = dict(zip(input_files.runs, self.chunks, strict=True))
        verdict = recheck.judge(recheck.StoredRuns(input_files.problems[0], files))
        recheck.write(recheck.check_sound(verdict), output_files[0])


@dataclass(frozen=True)
class TableOfRuns(Job):
    """The job that makes a table of runs, and compares it with published numbers if it has any."""

    name: str
    """`study/table`, which seeds random draws."""
    spec: Pivot
    """The table without its title, which stands in the caption alone."""
    labels: dict[str, str]
    """Name -> how it is printed."""
    reconstructed: list[str]
    """Workspaces that the paper does not print."""
    fitted: dict[str, dict]
    """By metric, the numbers to which something was fitted."""
    repeats: int

    def run(self, input_files, output_files):
        """Make the table and its comparison with published numbers."""

        from bezierplan.analysis import results, study_code
        from bezierplan.analysis.numbers import comparison, tables
        from bezierplan.running import inputs

        # The metrics of a study are known once its code is loaded.
        study_code.load_functions(self.code)
        ((experiment, files),) = inputs.group_by_experiment(self.shows, input_files).items()
        runs = results.read(files, self.repeats, experiment)
        published = None
        if self.spec.published:
            published = comparison.read_published(input_files.sources[0], self.spec)
        table = tables.build_pivot(runs, self.spec, self.labels, published)
        table.to_csv(output_files.table, lineterminator="\n")
        if published is not None:
            compared = comparison.compare(
                runs, self.spec, published, self.name, self.reconstructed, self.fitted
            )
            placed = compared.dropna(subset="table_row")
            printed = tables.lay_out(placed, placed["as_printed"], table.index, table.columns)
            printed.to_csv(output_files.published, lineterminator="\n")
            self.write(compared, output_files.comparison)


@dataclass(frozen=True)
class TableWithoutRuns(Job):
    """The job that makes a table which a paper prints, or which a function computes from printed
    numbers.
    """

    spec: TableEntry
    """The table without its title."""

    def run(self, input_files, output_files):
        """Build the table from published numbers or by a function."""
        from bezierplan.analysis import study_code
        from bezierplan.analysis.numbers import listing
        from bezierplan.running import inputs

        table = listing.build_listing(
            self.spec,
            inputs.group_by_table(input_files.sources),
            study_code.load_functions(self.code),
        )
        self.write(table, output_files[0])


@dataclass(frozen=True)
class Claims(Job):
    """The job that judges the claims of a study on the runs of some experiments."""

    study: StudyForClaims
    repeats: dict[str, int]
    """By experiment, the repeats that are judged."""
    readings: dict[str, str]
    """By name, what each joint reading changes, in words; in the order of their files."""

    def list_modules(self):
        """List the study's own modules and those of the kinds of check."""
        kinds = {check.test for claim in self.study.claims for check in claim.checks}
        # Kinds are imported by name, so the imports of `run` do not lead to them.
        return [*self.code, *(f"bezierplan.analysis.claims.kinds.{kind}" for kind in kinds)]

    def run(self, input_files, output_files):
        """Judge the claims, and say which verdicts depend on a reading or a variant."""
        import pandas as pd

        from bezierplan.analysis import results, study_code
        from bezierplan.analysis.claims import by_reading, judge, sentences
        from bezierplan.running import inputs

        material = Material(
            self.study,
            results.read_all(inputs.group_by_experiment(self.shows, input_files), self.repeats),
            results.read_published_tables(input_files.sources),
            study_code.load_functions(self.code),
        )
        judged, checks = judge.judge_claims(material)
        self.write(checks, output_files.checks)
        if not hasattr(output_files, "by_reading"):  # the claims of a reading
            self.write(judged, output_files.claims)
            return
        under = {
            name: by_reading.ClaimTables(pd.read_csv(claims), by_reading.read_checks(own))
            for name, claims, own in zip(
                self.readings, input_files.readings, input_files.checks, strict=True
            )
        }
        names = sentences.name_variants(self.study.claims, self.study.labels)
        told = by_reading.add_dependence(judged, under, self.readings, names)
        self.write(told, output_files.claims)
        default = {by_reading.DEFAULT: by_reading.ClaimTables(judged, checks)}
        self.write(
            by_reading.list_checks(self.study.claims, default | under), output_files.by_reading
        )


@dataclass(frozen=True)
class Audit(Job):
    """The job that checks a paper's own numbers against each other and against exact bounds."""

    study: str
    tables: dict[str, Pivot]
    """By the name of their published numbers, without what is only printed."""
    reconstructed: list[str]
    """Tables on maps that the paper does not print."""

    def run(self, input_files, output_files):
        """Check the printed numbers against each other and against bounds."""
        from bezierplan.analysis import study_code
        from bezierplan.analysis.audit import audit
        from bezierplan.running import inputs

        study_code.load_functions(self.code)
        table = audit.check_paper(
            self,
            study_code.load_audit(self.code),
            inputs.group_by_experiment(self.shows, input_files),
            inputs.group_by_table(input_files.sources),
        )
        self.write(table, output_files[0])


@dataclass(frozen=True)
class MethodsTable(Job):
    """The job that measures all studies' methods on each problem, beside the exact
    shortest path.
    """

    proposed: dict[str, str | None]
    """By study, the method that its paper proposes."""
    families: dict[str, dict[str, Any]]
    """By study: the families that it declares (`study.experiments.FamilyEntry`)."""
    repeats: dict[str, int]
    """By study/experiment."""
    problems: dict[str, list[str]]
    """By study/experiment, the problems of scale full, which `score` asks for; scale extended draws
    many more.
    """

    def run(self, input_files, output_files):
        """Measure the methods on each problem."""
        from bezierplan.analysis import results
        from bezierplan.analysis.numbers import methods
        from bezierplan.running import inputs

        files = inputs.group_by_experiment(self.shows, input_files)
        by_place = {}
        for place, number in self.repeats.items():
            every = results.read(files[place], number, place.partition("/")[2])
            runs = results.select(every.runs, {"problem": self.problems[place]})
            by_place[place] = every._replace(runs=runs)
        table = methods.measure_studies(self.proposed, self.families, by_place)
        table.to_csv(output_files[0], index=False, float_format="%.6g", lineterminator="\n")


@dataclass(frozen=True)
class Summary(Job):
    """The job that gathers the numbers and claims of all studies."""

    tables: list[tuple[str, str]]
    """Study and table of each comparison with published numbers, in order."""

    def run(self, input_files, output_files):
        """Gather the numbers and claims of all studies."""
        from bezierplan.analysis import study_code
        from bezierplan.analysis.outcome import summary

        study_code.load_functions(self.code)
        summed = summary.gather(
            dict(zip(self.tables, input_files.comparisons, strict=True)),
            input_files.claims,
        )
        for name, table in summed.items():
            self.write(table, getattr(output_files, name))


@dataclass(frozen=True)
class Verification(Job):
    """The job that lists the verdicts of all rechecks behind the page, and the digest of every
    file, with the account of the job that makes it.
    """

    folder: str
    """The folder of the scale."""
    studies: dict[str, str]
    """The studies of the page, by name, each with the word that names it in a configuration."""
    accounts: list[tuple[list[str], str, dict[str, str]]]
    """Files below it, with the key and the account of the job that makes them."""

    def run(self, input_files, output_files):
        """List all files with their digests and the accounts of their jobs."""
        import json

        from bezierplan.analysis.outcome import verification
        from bezierplan.running import recheck

        judgements = [json.loads(Path(file).read_text()) for file in input_files.judgements]
        verdict = recheck.merge_verdicts(
            recheck.RunsVerdict(**each | {"digests": tuple(each["digests"])}) for each in judgements
        )
        content = recheck.check_sound(verdict) | {
            "digest": verdict.digest,
            "made_by": verification.describe_version(),
            "versions": recheck.read_versions(),
            "studies": self.studies,
            "accounts": [
                (["verified.json"], self.account),
                *(
                    (files, account | opened_files.hash_contents(opened_files.read_kept(key)))
                    for files, key, account in self.accounts
                ),
            ],
            "sha256": {
                str(file.relative_to(self.folder)): recheck.compute_sha256(file)
                for file in sorted({*map(Path, input_files)})
            },
        }
        recheck.write(content, output_files[0])
