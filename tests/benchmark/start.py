"""CPU time of processes that start: what a job of runs imports, and a command."""

import os
import resource
import subprocess
import sys
from collections.abc import Iterator

import frame

from bezierplan.places import PACKAGE

SOURCE = str(PACKAGE.parent)
COLUMNS = ("a process", "CPU s")
COMMANDS = {
    "imports of a job of runs": [
        "-c",
        "import pyarrow.parquet; from bezierplan.running import execution, problems",
    ],
    "bezierplan plan --help": ["-m", "bezierplan", "plan", "--help"],
    "bezierplan list": ["-m", "bezierplan", "list"],
}


def rows(small: bool) -> Iterator[frame.Row]:
    for name, words in COMMANDS.items():
        yield name, min(_seconds(words) for _ in range(1 if small else frame.ROUNDS))


def _seconds(words: list[str]) -> float:
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    environment = os.environ | {"PYTHONPATH": SOURCE}
    command = [sys.executable, *words]
    subprocess.run(command, env=environment, stdout=subprocess.DEVNULL, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
