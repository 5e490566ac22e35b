"""What Snakemake shows while it works: in a terminal a bar a rule with jobs done, jobs in all, and time left; without one a line every 15
seconds or less often; at the end where the results are.

Snakemake finds a logger by its package's name; `logger: bezierplan` in profiles/default names this one.
It is the rich logger with other columns.
"""

import time
from datetime import timedelta
from logging import LogRecord
from pathlib import Path

from rich.progress import BarColumn, MofNCompleteColumn, SpinnerColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from snakemake_interface_logger_plugins.common import LogEvent
from snakemake_logger_plugin_rich import LogHandler as RichHandler

__all__ = ["LogHandler"]

BETWEEN_LINES = 15.0
"""Least time between two lines of progress without a terminal, in seconds."""


class LogHandler(RichHandler):
    def __post_init__(self) -> None:
        super().__post_init__()
        self.progress.speed_estimate_period = 24 * 3600  # seconds looked back on; the usual 30 are shorter than one job
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

    def emit(self, record: LogRecord) -> None:
        super().emit(record)
        event = getattr(record, "event", None)
        if event == LogEvent.JOB_INFO:
            self.folders.update(folder for file in record.output or [] if (folder := results_folder(file)))
        elif event == LogEvent.JOB_FINISHED and not self.console.is_terminal:
            self.show_progress()
        elif event is None and "Complete log" in record.getMessage():
            done, total = self.event_handler.completed, self.event_handler.total_jobs
            if done == total and self.folders:
                self.console.print(f"Results: {', '.join(sorted(self.folders))}", soft_wrap=True, highlight=False)

    def show_progress(self) -> None:
        """Print a line, unless the last one is too fresh: jobs done, jobs in all, time elapsed and left if all jobs take equally long."""
        now = time.monotonic()
        done, total = self.event_handler.completed, self.event_handler.total_jobs
        if done < total and now - self.last_line < BETWEEN_LINES:
            return
        self.last_line = now
        elapsed = now - self.started
        left = f", about {shown(elapsed / done * (total - done))} left" if done < total else ""
        self.console.print(f"{done} of {total} jobs done, {shown(elapsed)} elapsed{left}", soft_wrap=True, highlight=False)


def results_folder(file: str) -> str | None:
    """The folder of results that a reader looks into for an output file, such as results/full/song2016; None for other files."""
    parts = Path(file).parts
    return "/".join(parts[: min(3, len(parts) - 1)]) if parts[0] == "results" and len(parts) > 2 else None


def shown(seconds: float) -> str:
    """A time as h:mm:ss."""
    return str(timedelta(seconds=round(seconds)))
