"""How long a target takes, how much disk, and which jobs are the longest: from recorded times.

What is left to do comes from a dry run of Snakemake; how long it takes from the times of this
folder's own jobs, and where there are none from docs/outcome/times.csv, those of the last full
outcome.
"""

import heapq
import re
import subprocess
from argparse import ArgumentParser
from collections.abc import Iterable
from math import prod
from pathlib import Path
from typing import NamedTuple

from bezierplan.commands import SNAKEMAKE, cores
from bezierplan.places import TREE
from bezierplan.planners import planner_module
from bezierplan.running import records
from bezierplan.running.records import Job, Record
from bezierplan.schema.checked import Fault, closest
from bezierplan.study import jobs, reading, targets
from bezierplan.study.definition import Study
from bezierplan.study.experiments import SCALES

LONGEST = 5
"""How many of the longest jobs are printed."""


class Step(NamedTuple):
    """A job of a dry run."""

    log: str
    inputs: frozenset[str]
    outputs: tuple[str, ...]


def main(parser: ArgumentParser, words: list[str]) -> None:
    """Print a forecast. Raises ValueError for an unknown target."""
    parser.add_argument(
        "target",
        metavar="TARGET",
        help="as for snakemake: all, smoke, extended, a study, STUDY_TABLE, a file",
    )
    parser.add_argument(
        "--scale",
        choices=SCALES,
        default="full",
        help="of a study, a table or a figure (default: full)",
    )
    parser.add_argument(
        "--cores",
        type=int,
        default=cores(),
        metavar="N",
        help="how many jobs run at once (default: all cores of this machine)",
    )
    parser.add_argument("--anew", action="store_true", help="include outputs that already exist")
    arguments = parser.parse_args(words)
    if arguments.cores < 1:
        raise Fault(f"--cores: {arguments.cores}; expected a whole number of at least 1")
    studies = reading.load(reading.read_config({}))
    steps = planned(files(studies, arguments.target, arguments.scale), arguments.anew)
    print(
        "\n".join(
            lines(arguments.target, steps, estimates(studies, steps, Path()), arguments.cores)
        )
    )


def files(studies: dict[str, Study], target: str, scale: str) -> list[str]:
    """What snakemake is asked for: the files of a study or artefact at a scale; other targets as
    they are. Raises Fault.
    """
    known = {"all": {"smoke": "smoke", "full": "all", "extended": "extended"}[scale]}
    known |= {name: name for name in ("smoke", "extended", "alternatives", "interpretations")}
    if target in known or "/" in target:
        return [known.get(target, target)]
    if target in studies:
        return targets.files_of_study(studies, scale, target)
    for key, study in studies.items():
        for item in (*study.tables, *study.figures):
            if target == f"{key}_{item}":
                return targets.files_of(studies, scale, key, item)
    raise Fault(f"{target}: no target{closest(target, [*known, *studies])}")


def planned(wanted: list[str], anew: bool) -> list[Step]:
    """The jobs that snakemake would run, from a dry run. Raises Fault with snakemake's words."""
    options = ["--workflow-profile", "none", "--cores", "1", "--dry-run", "--nolock"]
    triggers = ["--rerun-triggers", "mtime", "input", "params"]
    done = subprocess.run(
        [*SNAKEMAKE, *options, *wanted, *triggers, *(["--forceall"] if anew else [])],
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        raise Fault((done.stderr or done.stdout).strip().splitlines()[-1])
    steps = {}
    for body in re.split(r"^(?:local)?rule ", done.stdout + done.stderr, flags=re.M)[1:]:
        parts = {
            name: text.split(", ")
            for name, text in re.findall(r"^    (input|output|log): (.*)$", body, flags=re.M)
        }
        if "log" in parts:
            steps[parts["log"][0]] = Step(
                parts["log"][0], frozenset(parts.get("input", ())), tuple(parts["output"])
            )
    return list(steps.values())


def units_of(studies: dict[str, Study], job: Job) -> int:
    """How many runs a job makes; 1 for other jobs, and for runs that no study has."""
    if job.chunk is None:
        return 1
    key, _, experiment, method = job.name.split("/")
    study = studies.get(key)
    if (
        study is None
        or experiment not in study.experiments
        or method not in study.methods_of(experiment)
    ):
        return 1
    described = jobs.job(study, experiment, method, job.scale, job.chunk)
    conditions = len(described.problems) * prod(len(values) for values in described.vary.values())
    first, last = described.repeats
    alike = getattr(planner_module(described.planner), "deterministic", False)
    return conditions * (1 if alike else last - first)


def estimates(
    studies: dict[str, Study], steps: Iterable[Step], folder: Path
) -> dict[str, Record | None]:
    """What each job takes, by log file; None where nothing like it was recorded."""

    def units(job: Job) -> int:
        return units_of(studies, job)

    own, kept = records.measured(folder, units), records.kept(TREE / records.KEPT)
    known: dict[str, Record | None] = {}
    for step in steps:
        job = records.job_of(step.log)
        same = (
            own.get((job.scale, job.name))
            or kept.get(job.name)
            or next((own[s, n] for s, n in own if n == job.name), None)
        )
        known[step.log] = same and same.scaled(units(job))
    return known


def keep(studies: dict[str, Study], folder: Path) -> None:
    """Renew the kept times of this folder's jobs of scale full; those of other jobs stay."""
    own = records.measured(folder, lambda job: units_of(studies, job))
    known = records.kept(TREE / records.KEPT) if (TREE / records.KEPT).is_file() else {}
    records.keep(
        known | {name: record for (scale, name), record in own.items() if scale == "full"},
        TREE / records.KEPT,
    )


def duration(steps: list[Step], seconds: dict[str, float], cores: int) -> float:
    """How long jobs take on some cores, each of which takes the next job whose input is there, in
    the given order.
    """
    maker = {file: step.log for step in steps for file in step.outputs}
    waits = {step.log: {maker[file] for file in step.inputs if file in maker} for step in steps}
    after: dict[str, list[str]] = {}
    for log, needed in waits.items():
        for each in needed:
            after.setdefault(each, []).append(log)
    ready = [step.log for step in steps if not waits[step.log]][::-1]
    running: list[tuple[float, str]] = []
    now = 0.0
    while ready or running:
        while ready and len(running) < cores:
            log = ready.pop()
            heapq.heappush(running, (now + seconds[log], log))
        now, ended = heapq.heappop(running)
        for log in after.get(ended, ()):
            waits[log].discard(ended)
            if not waits[log]:
                ready.insert(0, log)
    return now


def lines(
    target: str, steps: list[Step], recorded: dict[str, Record | None], cores: int
) -> list[str]:
    """The forecast, one line each."""
    if not steps:
        return [f"{target}: nothing is left to do"]
    known = [record for record in recorded.values() if record]
    usual = sum(record.seconds for record in known) / len(known) if known else records.START
    seconds = {log: record.seconds if record else usual for log, record in recorded.items()}
    told = [
        f"{target}: {len(steps)} jobs, {shown(sum(seconds.values()))} of CPU time",
        f"on {cores} core{'s' * (cores > 1)}: about {shown(duration(steps, seconds, cores))}",
        f"disk: about {sum(record.megabytes for record in known):.0f} MB",
    ]
    if len(known) < len(steps):
        told.append(f"not recorded: {len(steps) - len(known)} jobs, counted as {usual:.0f} s each")
    told.append("the longest jobs:")
    longest = sorted(seconds, key=seconds.__getitem__, reverse=True)[:LONGEST]
    return told + [
        f"  {shown(seconds[log]):>9}  {log.removesuffix('.log').replace('/logs/', '/', 1)}"
        for log in longest
    ]


def shown(seconds: float) -> str:
    """A time in the unit that suits it."""
    if seconds < 90:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 90 * 60 else f"{seconds / 3600:.1f} h"
