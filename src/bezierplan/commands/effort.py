"""A profile of the last run of the workflow in this folder, from what its jobs and Snakemake noted:
CPU time by kind of work.
"""

import json
from argparse import ArgumentParser
from collections import Counter
from pathlib import Path

from bezierplan.running import effort, records
from bezierplan.running.effort import Session

# What jobs do, apart from importing and from loading and compiling kernels -> their rules; `runs`
# and `drives` also apart from planning.
_RULES = {
    "checking paths, warm-up, files of runs": ("runs", "drives"),
    "problems and exact bounds": ("problems", "worlds", "bounds", "clairvoyant"),
    "tables, claims, statistics": (
        *("table", "listing", "latex", "claims", "audit"),
        *("baseline_comparison", "summary", "sensitivity"),
    ),
    "alternatives: their runs and claims": ("alternative",),
    "interpretations: their runs and comparisons": ("interpretations_of",),
    "drawing figures": ("figure", "narrow_figure"),
    "judging stored runs again": ("verified",),
    "the page": ("page",),
}
WORK = {rule: work for work, rules in _RULES.items() for rule in rules}
ROWS = [
    *("planning", *_RULES),
    *("importing", "loading kernels", "compiling", "importing once for all jobs, forking"),
    *("starting and ending processes of jobs", "Snakemake itself"),
]


def main(parser: ArgumentParser, words: list[str]) -> None:
    """Print the table. Raises FileNotFoundError if no start was noted."""
    parser.parse_args(words)
    try:
        session = effort.last(Path())
    except FileNotFoundError:
        raise FileNotFoundError(
            f"{effort.SESSION}: no run of the workflow has succeeded in this folder; start "
            "`snakemake` first"
        ) from None
    print("\n".join(lines(session, *spent(session, Path()))))


def spent(session: Session, folder: Path) -> tuple[Counter[str], int, float]:
    """CPU seconds by what they were for, the number of jobs, and the seconds of the clock in which
    jobs waited for kernels.
    """
    seconds: Counter[str] = Counter(
        {
            "Snakemake itself": session.snakemake,
            "importing once for all jobs, forking": session.forked,
        }
    )
    jobs: dict[str, tuple[str, list[Path]]] = {}
    for file in (folder / records.METADATA).glob("*"):
        content = json.loads(file.read_text(encoding="utf-8"))
        if (
            content.get("log")
            and content["rule"] in WORK
            and session.started <= content["starttime"] <= session.ended
        ):
            jobs.setdefault(content["log"][0], (content["rule"], []))[1].append(
                folder / records.output_of(file)
            )
    waited = by_themselves = 0.0
    for log, (rule, outputs) in jobs.items():
        noted = effort.of_job(folder / log) or {"cpu": 0.0}
        waited += noted.pop("waiting", 0.0)
        by_themselves += noted["cpu"]
        rest = noted.pop("cpu") - sum(noted.values())
        if rule in ("runs", "drives"):
            planning, _ = records.planner_times(outputs) or (0.0, 0.0)
            seconds["planning"] += planning
            rest -= planning
        seconds.update(noted)
        seconds[WORK[rule]] += rest
    seconds["starting and ending processes of jobs"] = max(session.forks - by_themselves, 0.0)
    return seconds, len(jobs), waited


def lines(session: Session, parts: Counter[str], jobs: int, waited: float) -> list[str]:
    """A table in Markdown. What the cores did not do for this workflow is the time that is left."""
    clock = session.ended - session.started
    whole = clock * session.cores
    rest = {"cores idle, or busy with other programs": whole - parts.total()}
    rows = [(name, parts[name]) for name in ROWS if parts[name]] + list(rest.items())
    return [
        f"{jobs} jobs in {clock:.0f} s on {session.cores} cores; jobs waited {waited:.0f} s for "
        "kernels that another job compiled",
        "",
        "| work | core-seconds | share |",
        "| --- | --- | --- |",
        *(f"| {name} | {seconds:.1f} | {seconds / whole:.1%} |" for name, seconds in rows),
    ]
