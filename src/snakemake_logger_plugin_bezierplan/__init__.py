"""Output of Snakemake while it works: in a terminal, one progress bar per rule with jobs done, jobs
in all and time left; without one, a line every 15 seconds or less often. At the end: the place of
the results, the time taken and the outcome, or for each failed job one line with the reason.

Snakemake finds a logger by its package's name; `logger: bezierplan` in profiles/default names this
one. It is the rich logger with other columns.
"""

import re
import time
from datetime import timedelta
from logging import LogRecord
from pathlib import Path

from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    SpinnerColumn,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from snakemake_interface_logger_plugins.common import LogEvent
from snakemake_logger_plugin_rich import LogHandler as RichHandler

__all__ = ["LogHandler"]

REASON = "CRITICAL "
"""What comes, in a job's log, before the line that says why the job failed
(`bezierplan.running.log`).
"""
LOCKED = (
    "LockException: {}: another Snakemake works in this folder, or was killed here; if none "
    "works, free it by `snakemake --unlock` and "
    "start again (`make smoke`, `make reproduce` and `make extended` do so themselves)"
)
KNOWN: set[str] = set()
"""Names of targets, which the workflow tells."""
BETWEEN_LINES = 15.0
"""Least time between two lines of progress without a terminal, in seconds."""


class LogHandler(RichHandler):
    def __post_init__(self) -> None:
        super().__post_init__()
        # Seconds looked back on; the usual 30 are shorter than one job.
        self.progress.speed_estimate_period = 24 * 3600
        self.progress.columns = (
            SpinnerColumn(finished_text="✓"),
            TextColumn("{task.description}"),
            BarColumn(bar_width=None),
            MofNCompleteColumn(),
            TextColumn("done, elapsed"),
            TimeElapsedColumn(),
            TextColumn("left"),
            TimeRemainingColumn(),
        )
        self.started = self.last_line = time.monotonic()
        self.folders: set[str] = set()
        self.pages: set[Path] = set()
        self.reasons: list[str] = []
        self.frames: LogRecord | None = (
            # Snakemake's account of a failed job, until it is known whether the job's own is
            # better.
            None
        )

    def emit(self, record: LogRecord) -> None:
        event, exception = getattr(record, "event", None), getattr(record, "exception", None)
        if event == LogEvent.ERROR and exception == "RuleException":
            self.show_frames()
            self.frames = record
            return
        if event == LogEvent.JOB_ERROR and (reason := self.reason_of(record.jobid)):
            self.reasons.append(reason)
            self.frames = None
            return
        if event == LogEvent.ERROR and exception == "LockException":
            self.reasons.append(LOCKED.format(Path.cwd()))
            return
        if (
            event == LogEvent.ERROR
            and exception == "MissingRuleException"
            and (reason := unknown_target(record.getMessage()))
        ):
            self.reasons.append(reason)
            return
        if event is None and record.getMessage().startswith("Elapsed time: "):
            return
        self.show_frames()
        super().emit(record)
        if event == LogEvent.JOB_INFO:
            self.folders.update(
                folder for file in record.output or [] if (folder := results_folder(file))
            )
            self.pages.update(
                Path(file) for file in record.output or [] if Path(file).name == "index.html"
            )
        elif event == LogEvent.JOB_FINISHED and not self.console.is_terminal:
            self.show_progress()
        elif event is None and "Complete log" in record.getMessage():
            done, total = self.event_handler.completed, self.event_handler.total_jobs
            if done == total and self.folders:
                self.show_end()

    def show_end(self) -> None:
        """Print where the results are, how long it took, what came out, and last the page."""
        lines = [
            f"Results: {', '.join(sorted(self.folders))}",
            f"Time: {shown(time.monotonic() - self.started)}",
        ]
        for page in sorted(self.pages):
            lines += [*headline(page.parent), f"Open {page} in a browser: file://{page.resolve()}"]
        for line in lines:
            self.console.print(line, soft_wrap=True, highlight=False, markup=False)

    def reason_of(self, job: int) -> str:
        """Why a job failed, as its log says in its last line; empty if it does not."""
        for log in self.event_handler.jobs_info.get(job, {}).get("log") or []:
            try:
                lines = Path(log).read_text(encoding="utf-8", errors="replace").splitlines()
            except OSError:
                continue
            if lines and REASON in lines[-1]:
                return lines[-1].split(REASON, 1)[1]
        return ""

    def show_frames(self) -> None:
        if self.frames:
            frames, self.frames = self.frames, None
            super().emit(frames)

    def close(self) -> None:
        """End, and repeat last what matters most: why jobs failed."""
        self.show_frames()
        super().close()
        while self.reasons:
            self.console.print(self.reasons.pop(0), soft_wrap=True, highlight=False, markup=False)

    def show_progress(self) -> None:
        """Print a line, unless the last one is too fresh: jobs done, jobs in all, time elapsed and
        left if all jobs take equally long.
        """
        now = time.monotonic()
        done, total = self.event_handler.completed, self.event_handler.total_jobs
        if done < total and now - self.last_line < BETWEEN_LINES:
            return
        self.last_line = now
        elapsed = now - self.started
        left = f", about {shown(elapsed / done * (total - done))} left" if done < total else ""
        self.console.print(
            f"{done} of {total} jobs done, {shown(elapsed)} elapsed{left}",
            soft_wrap=True,
            highlight=False,
        )


def results_folder(file: str) -> str | None:
    """The folder of results that a reader looks into for an output file, such as
    results/full/song2016; None for other files.
    """
    parts = Path(file).parts
    return (
        "/".join(parts[: min(3, len(parts) - 1)])
        if parts[0] == "results" and len(parts) > 2
        else None
    )


def unknown_target(message: str) -> str:
    """What to say of a target that no rule makes, from Snakemake's words; empty for other words."""
    from bezierplan.schema.checked import closest

    match = re.search(r"No rule to produce (\S+)", message)
    if not match or not KNOWN:
        return ""
    if "/" in match[1]:
        return (
            f"{match[1]}: no rule makes this file; `python -m bezierplan list` lists what there is"
        )
    return f"{match[1]}: no target{closest(match[1], KNOWN)}"


def headline(folder: Path) -> list[str]:
    """The headline of the results in a folder, as its summary has it, one sentence per line; none
    if there is no summary.
    """
    file = folder / "summary.md"
    if not file.is_file():
        return []
    bold = [
        line
        for line in file.read_text(encoding="utf-8").splitlines()
        if line.startswith("**Of ") and line.endswith("**")
    ]
    return bold[0].strip("*").replace(". ", ".\n").splitlines() if bold else []


def shown(seconds: float) -> str:
    """A time as h:mm:ss."""
    return str(timedelta(seconds=round(seconds)))
