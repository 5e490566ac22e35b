"""Names of the input files of jobs.

Snakemake hands a job lists of files, each with a name. What a file is of stands in that name, such
as `runs/routes/smooth`, so that no job takes paths apart: where files lie is up to the workflow,
and to the one of which it is a module.
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

RUNS, PROBLEMS, BOUNDS = "runs", "problems", "bounds"


class Files(NamedTuple):
    """Files of an experiment: chunks of runs by method, its problems and their exact bounds."""

    runs: dict[str, list[str]]
    problems: str
    bounds: str

    @property
    def chunks(self) -> list[str]:
        """Chunks of all methods."""
        return [chunk for chunks in self.runs.values() for chunk in chunks]


def named(part: str, files: Mapping[str, Any]) -> dict[str, Any]:
    """Input files of a job: what they are of, after the name of what they all are.

    >>> named("published", {"table1": "a.csv"})
    {'published/table1': 'a.csv'}
    """
    return {f"{part}/{name}": file for name, file in files.items()}


def part(inputs: Any, name: str) -> dict[str, Any]:
    """A job's inputs of one kind: what they are of -> file or files; the reverse of `named`."""
    return {
        key.removeprefix(f"{name}/"): files
        for key, files in inputs.items()
        if key.startswith(f"{name}/")
    }


def of_experiments(experiments: Mapping[str, Files]) -> dict[str, Any]:
    """Input files of a job that reads the results of experiments."""
    runs = {
        f"{name}/{method}": chunks
        for name, files in experiments.items()
        for method, chunks in files.runs.items()
    }
    others = {
        each: {name: getattr(files, each) for name, files in experiments.items()}
        for each in (PROBLEMS, BOUNDS)
    }
    return named(RUNS, runs) | named(PROBLEMS, others[PROBLEMS]) | named(BOUNDS, others[BOUNDS])


def experiments(inputs: Any) -> dict[str, Files]:
    """The files of each experiment of a job's inputs; the reverse of `of_experiments`."""
    runs: dict[str, dict[str, list[str]]] = {}
    for name, chunks in part(inputs, RUNS).items():
        experiment, _, method = name.rpartition("/")
        runs.setdefault(experiment, {})[method] = list(chunks)
    bounds = part(inputs, BOUNDS)
    return {
        name: Files(runs.get(name, {}), file, bounds[name])
        for name, file in part(inputs, PROBLEMS).items()
    }
