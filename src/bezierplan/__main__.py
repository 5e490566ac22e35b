"""The command line: `python -m bezierplan COMMAND`. Each command is a file of `commands` with a
function `main`.
"""

import ast
import importlib
import os
import re
import signal
import sys
from pathlib import Path
from typing import NoReturn

import bezierplan
from bezierplan.commands import arguments
from bezierplan.places import EXTRA, PACKAGE, choose_machine_code, require_extra
from bezierplan.running.jobs import watchdog
from bezierplan.schema.checked import Fault, describe_known

PROGRAM = "bezierplan" if Path(sys.argv[0]).name == "bezierplan" else "python -m bezierplan"
"""The words that called the command line."""

COMMANDS = {
    file.stem.replace("_", "-"): file
    for file in sorted((PACKAGE / "commands").glob("[!_]*.py"))
    if file.stem != "arguments"
}
"""Command -> its file."""


def main(words: list[str]) -> None:
    """Run the command that the words of a command line name.

    A fault ends the process with one line: wrong input with status 2, a planner's failure with 1.
    """
    name, *rest = words or ["--help"]
    try:
        if name in ("-h", "--help"):
            print(
                f"usage: {PROGRAM} COMMAND ...\n\ncommands; `COMMAND --help` shows its arguments:"
            )
            for command, file in COMMANDS.items():
                text = ast.get_docstring(ast.parse(file.read_text(encoding="utf-8")))
                sentence = re.split(r"\.\s", f"{text}\n")[0]
                print(f"  {command:16}{' '.join(sentence.split())}")
        elif name == "--version":
            print(f"bezierplan {bezierplan.__version__}")
        elif name not in COMMANDS:
            _refuse(f"{PROGRAM}: {name}: unknown{describe_known(name, COMMANDS)}")
        else:
            with require_extra():
                command = importlib.import_module(f"bezierplan.commands.{COMMANDS[name].stem}")
                functions = getattr(command, "PASSES_ON", ())
                if name == "run" and {"-h", "--help"}.isdisjoint(rest):  # most are Snakemake's
                    command.main(*rest)
                else:
                    arguments.call(f"{PROGRAM} {name}", command.main, functions, rest)
        sys.stdout.flush()
    # The reader, such as `head`, has enough; Python flushes once more when it exits.
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except watchdog.PlannerFailure as failure:
        sys.exit(str(failure))
    except ModuleNotFoundError as missing:
        if missing.name not in EXTRA:
            raise
        _refuse(f"{name}: {missing}")
    except (ValueError, OSError) as fault:
        # What the operating system says names the file last, and an error number first.
        file = getattr(fault, "filename", None)
        text = f"{file}: {fault.strerror}" if file else str(fault)
        _refuse(*Fault(*getattr(fault, "lines", [text])).lines)


def _refuse(*lines: str) -> NoReturn:
    """Print lines and end with the status of wrong input."""
    print(*lines, sep="\n", file=sys.stderr)
    sys.exit(2)


def start() -> None:
    """Run the command line of this process."""
    choose_machine_code()
    try:
        main(sys.argv[1:])
    except KeyboardInterrupt:
        print(f"{PROGRAM}: interrupted", file=sys.stderr, flush=True)
        sys.exit(128 + signal.SIGINT)


if __name__ == "__main__":
    start()
