"""Output of Snakemake while it works: in a terminal the rich logger's progress bars, otherwise a
line at most every 15 seconds. At the end: what was made, where it is, and the time taken; or why
jobs failed, a line for each fault.

Snakemake finds a logger by its package's name; `logger: bezierplan` in profiles/default names this
one.
"""

import html
import re
import time
from datetime import timedelta
from itertools import takewhile
from logging import LogRecord
from pathlib import Path

from rich.progress import MofNCompleteColumn, TimeRemainingColumn
from snakemake_interface_logger_plugins.common import LogEvent
from snakemake_logger_plugin_rich import LogHandler as RichHandler

REASON = "CRITICAL "
"""Beginning of the line in a job's log that says why the job failed
(`bezierplan.running.jobs.log`).
"""
LOCKED = (
    "LockException: {}: another Snakemake works in this folder, or was killed here; if none "
    "works, free it by `snakemake --unlock` and "
    "start again (`make smoke`, `make reproduce` and `make extended` do so themselves)"
)
NOISE = ("Config file ", "Conda environments: ignored", "Elapsed time: ")
"""Beginnings of messages that tell a user nothing."""
KNOWN: set[str] = set()
"""Names of targets, which the workflow fills in."""
SPENT: list[float] = []
"""The CPU seconds of Snakemake and all jobs, which the workflow tells at its end."""
MADE = {"table": ".tex", "figure": ".svg", "page": "index.html"}
"""What is counted at the end -> the end of its file's name."""
BETWEEN_LINES = 15.0
"""Least seconds between two lines of progress without a terminal."""


class LogHandler(RichHandler):
    """The rich logger, with fewer and clearer lines."""

    def __post_init__(self) -> None:
        super().__post_init__()
        self.progress.columns += (MofNCompleteColumn(), TimeRemainingColumn())
        self.progress.speed_estimate_period = 24 * 3600  # the usual 30 s are shorter than a job
        if not self.console.is_terminal:
            # They would leave blank lines.
            self.live_display.start = self.progress.stop = lambda: None
        self.started = self.last_line = time.monotonic()
        self.outputs: set[Path] = set()
        # By job, for one that succeeds when it is tried again has not failed; None: of no job.
        self.reasons: dict[int | None, str] = {}

    def emit(self, record: LogRecord) -> None:
        """Show a record of Snakemake, keep it as a reason why a job failed, or drop it."""
        event, message = getattr(record, "event", None), record.getMessage()
        job = getattr(record, "jobid", None) if event == LogEvent.JOB_ERROR else None
        fault = getattr(record, "exception", None) if event == LogEvent.ERROR else None
        reason = LOCKED.format(Path.cwd()) if fault == "LockException" else ""
        if fault == "MissingRuleException":
            reason = describe_unknown_target(message)
        elif event == LogEvent.JOB_ERROR:
            reason = self.find_reason(job)
            # If it is tried again, it is not another job.
            if info := self.event_handler.jobs_info.get(job):
                self.event_handler.rule_counts[info["rule"]]["started"] -= 1
        if reason:
            self.reasons[job] = reason
            return
        # A job's own log says why it failed, and where the rest of its account stands.
        if fault == "RuleException" or (event is None and message.startswith(NOISE)):
            return
        done = self.event_handler.completed == self.event_handler.total_jobs
        if "Complete log" in message and done:
            self.say(*list_last_lines(self.outputs, time.monotonic() - self.started, *SPENT))
            return
        super().emit(record)
        if event == LogEvent.JOB_INFO:
            self.outputs.update(map(Path, record.output or []))
            if self.common_settings.dryrun:
                self.say(" ".join([record.rule_name, *(record.wildcards or {}).values()]))
        elif event == LogEvent.JOB_FINISHED:
            self.reasons.pop(record.job_id, None)
            if not self.console.is_terminal:
                self.show_progress()

    def say(self, *lines: str) -> None:
        """Print lines without wrapping or colours."""
        for line in lines:
            self.console.print(line, soft_wrap=True, highlight=False, markup=False)

    def find_reason(self, job: int) -> str:
        """Return why a job failed, from the last lines of its log; if these do not say it, where
        the log is.
        """
        logs = self.event_handler.jobs_info.get(job, {}).get("log") or []
        for log in map(Path, logs):
            lines = log.read_text("utf-8", "replace").splitlines() if log.is_file() else []
            last = [*takewhile(lambda line: REASON in line, reversed(lines))]
            if last:
                return "\n".join(line.partition(REASON)[2] for line in reversed(last))
        return f"job {job} failed, and its log does not say why (log: {', '.join(logs)})"

    def close(self) -> None:
        """End, and repeat last what matters most: why jobs failed."""
        super().close()
        self.say(*self.reasons.values())
        self.reasons.clear()

    def show_progress(self) -> None:
        """Print a line of progress, unless the last one is too recent."""
        now = time.monotonic()
        done, total = self.event_handler.completed, self.event_handler.total_jobs
        if done == total or now - self.last_line >= BETWEEN_LINES:
            self.last_line, taken = now, now - self.started
            share = 100 * done // total
            # The first jobs say little of the others.
            left = f", about {format_duration(taken * (total / done - 1))} left" * (
                5 <= share < 100
            )
            self.say(f"{share} %: {done} of {total} jobs, {format_duration(taken)} elapsed{left}")


def list_last_lines(outputs: set[Path], seconds: float, *spent: float) -> list[str]:
    """Return the lines at the end: what was made, where the results are, the time, and last the
    page.

    spent: the CPU seconds, if they are known.
    """
    results = [file.parts for file in outputs if file.parts[0] == "results"]
    folders = {"/".join(parts[:-1][:3]) for parts in results if len(parts) > 2}
    made = [
        f"{count} {what}{'s' * (count > 1)}"
        for what, ending in MADE.items()
        if (count := sum(file.name.endswith(ending) for file in outputs))
    ]
    cpu = "".join(f", CPU: {each:.0f} s" for each in spent)
    lines = [f"Made: {', '.join(made)}"] if made else []
    lines += [f"Results: {', '.join(sorted(folders))}", f"Time: {format_duration(seconds)}{cpu}"]
    figures = sorted(file for file in outputs if file.suffix == ".svg")
    lines += [f"Figure: {figures[0]}"] if len(figures) == 1 else []
    for page in sorted(file for file in outputs if file.name == "index.html"):
        said = re.search(r'<p class="headline">(.*?)</p>', page.read_text(encoding="utf-8"))
        lines += [html.unescape(said[1])] if said else []
        lines.append(f"Open {page} in a browser: file://{page.resolve()}")
    return lines if folders else []


def describe_unknown_target(message: str) -> str:
    """Return the message about a target that no rule makes, from Snakemake's own; empty for another
    one.
    """
    from bezierplan.schema.checked import describe_known

    match = re.search(r"No rule to produce (\S+)", message)
    return f"{match[1]}: no target{describe_known(match[1], KNOWN)}" if match and KNOWN else ""


def format_duration(seconds: float) -> str:
    """Return seconds as h:mm:ss."""
    return str(timedelta(seconds=round(seconds)))
