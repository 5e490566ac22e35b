"""How long jobs took and how much they wrote: what Snakemake noted in a working folder, and the
file that the repository keeps of it.

A job's name is its log file without scale, `logs` and ending, and for runs without the chunk:
`song2016/runs/routes/smooth`.
"""

import csv
import json
import re
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import NamedTuple

KEPT = Path("docs/outcome/times.csv")
METADATA = Path(".snakemake/metadata")
START = 3.0
"""Seconds that a job of runs takes beside its planner: a process, imports, compiled code from the
cache, checks of the paths. The median of 300 jobs.
"""

_LOG = re.compile(r"results/(?P<scale>[^/]+)/(?P<name>.+)\.log")
_RUNS = re.compile(r"(?P<name>[^/]+/runs/.+)/(?P<chunk>\d+)")


class Job(NamedTuple):
    """A job by its log file. chunk: number of the block of repeats, None if no planner runs."""

    scale: str
    name: str
    chunk: int | None


class Record(NamedTuple):
    """What a job took. units: how many runs it made, 1 for other jobs. seconds: of a core of its
    own. megabytes: of what it wrote.
    """

    units: int
    seconds: float
    megabytes: float

    def scaled(self, units: int) -> "Record":
        """What a job of the same name with other runs would take."""
        if units == self.units:
            return self
        factor = units / self.units
        return Record(
            units, START + factor * max(self.seconds - START, 0.0), factor * self.megabytes
        )


def job_of(log: str) -> Job | None:
    """The job that writes a log file; None for a file that no rule of this workflow writes."""
    match = _LOG.fullmatch(log)
    if not match:
        return None
    name = match["name"].replace("/logs/", "/", 1)
    runs = _RUNS.fullmatch(name)
    return (
        Job(match["scale"], runs["name"], int(runs["chunk"]))
        if runs
        else Job(match["scale"], name, None)
    )


def measured(folder: Path, units: Callable[[Job], int]) -> dict[tuple[str, str], Record]:
    """Record of each job noted in a working folder, by scale and name; of chunks their mean.

    units: how many runs a job makes. Of a job of runs, its planner's CPU time counts; of others the
    clock's, as far as a core was theirs: as CPU time to the clock's in the jobs of runs.
    """
    noted: dict[Job, tuple[float, list[Path]]] = {}
    for file in (folder / METADATA).glob("*"):
        try:
            content = json.loads(file.read_text(encoding="utf-8"))
            job, seconds = job_of(content["log"][0]), content["endtime"] - content["starttime"]
        except (OSError, ValueError, KeyError, IndexError, TypeError):
            continue  # of another version of Snakemake, or of a job without a log
        if job:
            output = folder / output_of(file)
            noted.setdefault(job, (seconds, []))[1].append(output)
    planner = {job: planner_times(outputs) for job, (_, outputs) in noted.items()}
    cpu, wall = (sum(column) for column in zip((0.0, 0.0), *filter(None, planner.values())))
    share = min(cpu / wall, 1.0) if wall else 1.0
    grouped: dict[tuple[str, str], list[Record]] = {}
    for job, (seconds, outputs) in noted.items():
        size = sum(file.stat().st_size for file in outputs if file.is_file()) / 1e6
        own = planner[job]
        record = Record(units(job), START + own[0] if own else seconds * share, size)
        grouped.setdefault((job.scale, job.name), []).append(record)
    return {
        key: Record(*(sum(column) / len(records) for column in zip(*records)))
        for key, records in grouped.items()
    }


def output_of(file: Path) -> str:
    """The output file that a file of metadata is about: its name is the output's in base 64."""
    import base64

    return base64.b64decode(file.name).decode(errors="replace")


def planner_times(outputs: Iterable[Path]) -> tuple[float, float] | None:
    """Seconds of the CPU and of the clock that a job's runs took; None for a job without runs."""
    import pyarrow as pa
    import pyarrow.parquet as parquet

    for file in outputs:
        if file.name.endswith(".times.parquet") and file.is_file():
            try:
                times = parquet.read_table(file, columns=["cpu_s", "wall_s"]).to_pandas()
            except (OSError, pa.ArrowException):
                return None
            # A planner without random numbers runs once; its other rows repeat the time.
            cpu, wall = times.drop_duplicates().sum()
            return float(cpu), float(wall)
    return None


def kept(file: Path) -> dict[str, Record]:
    """The records that the repository keeps, by name. Raises FileNotFoundError."""
    with file.open(encoding="utf-8", newline="") as lines:
        return {
            row["job"]: Record(int(row["units"]), float(row["seconds"]), float(row["megabytes"]))
            for row in csv.DictReader(lines)
        }


def keep(records: dict[str, Record], file: Path) -> None:
    """Write records into the file that the repository keeps."""
    with file.open("w", encoding="utf-8", newline="") as lines:
        writer = csv.writer(lines, lineterminator="\n")
        writer.writerow(["job", *Record._fields])
        for name, record in sorted(records.items()):
            writer.writerow(
                [name, round(record.units), f"{record.seconds:.3g}", f"{record.megabytes:.3g}"]
            )
