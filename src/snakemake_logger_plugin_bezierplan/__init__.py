"""What Snakemake shows while it works: a bar a rule with jobs done, jobs in all, and time left; without a terminal no line a job.

Snakemake finds a logger by its package's name; `logger: bezierplan` in profiles/default names this one.
It is the rich logger with other columns.
"""

from rich.progress import BarColumn, MofNCompleteColumn, SpinnerColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from snakemake_logger_plugin_rich import LogHandler as RichHandler

__all__ = ["LogHandler"]


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
