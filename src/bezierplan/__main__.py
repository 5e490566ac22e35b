"""The command line: `python -m bezierplan COMMAND`. Each command is a file of `commands` with a
function `main`.
"""

import argparse
import importlib
import os
import sys
from functools import partial
from pathlib import Path
from typing import NoReturn

import bezierplan
from bezierplan.places import EXTRA
from bezierplan.running import watchdog
from bezierplan.schema import words

PROGRAM = "bezierplan" if Path(sys.argv[0]).name == "bezierplan" else "python -m bezierplan"
"""How the command was called."""

COMMANDS = {
    "list": "studies, their artefacts, methods, workspaces and numbers of repeats",
    "replay": "one run again, bit-equal, with its picture",
    "digest": "one hash per run table, over sorted rows without times: what `same content` means",
    "verify": "every stored path and bound of a scale's results judged again, in processes that "
    "no planner was in",
    "check-planner": "the contract tests of a planner, on small and degenerate problems",
    "plan": "one path on a map, checked by exact geometry",
    "forecast": "how long a target takes on some cores, how much disk, and its longest jobs",
    "effort": "where the CPU time of the last start of the workflow went, by what it was for",
    "new": "a study of your own, which runs at once",
    "run": "targets of the workflow, from any folder",
    "completion": "what a shell evaluates to complete these words",
    "verify-outcome": "numbers made here beside those of docs/outcome: is this installation sound?",
    "outcome": "copy the outcome of results/extended and "
    "results/full to docs/outcome and into the README",
}


class _Parser(argparse.ArgumentParser):
    """A parser that tells what is wrong in one line, without the usage."""

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: {message}; `{self.prog} --help` tells what is expected\n")


def main(words: list[str]) -> None:
    """Do what the words of a command line say; a fault ends the process with one line: of input
    with status 2, of a planner with 1.
    """
    listed = "\n".join(f"  {name:16}{text}" for name, text in COMMANDS.items())
    parser = _Parser(
        prog=PROGRAM,
        epilog=f"commands:\n{listed}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "command",
        choices=COMMANDS,
        metavar="COMMAND",
        help="what to do; `COMMAND --help` tells its arguments",
    )
    parser.add_argument(
        "--version", action="version", version=f"bezierplan {bezierplan.__version__}"
    )
    if not words:
        parser.print_help()
        return
    name = parser.parse_args(words[:1]).command
    own = _Parser(prog=f"{PROGRAM} {name}", description=COMMANDS[name])
    try:
        importlib.import_module(f"bezierplan.commands.{name.replace('-', '_')}").main(
            own, words[1:]
        )
        if sys.stdout:  # which a process without one does not have
            sys.stdout.flush()
    # The reader, such as `head`, has enough; Python flushes once more when it exits.
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except watchdog.PlannerFailure as failure:
        sys.exit(str(failure))
    except ModuleNotFoundError as missing:
        if missing.name not in EXTRA:
            raise
        print(
            f"{name}: needs {missing.name}, which is not installed; install it with: pip install "
            "'bezierplan[workflow]'",
            file=sys.stderr,
        )
        sys.exit(2)
    except (ValueError, OSError) as fault:
        from bezierplan.schema.checked import Fault

        # What the operating system says names the file last, and an error number first.
        system = isinstance(fault, OSError) and fault.filename and fault.strerror
        print(
            Fault(f"{fault.filename}: {fault.strerror}" if system else str(fault)), file=sys.stderr
        )
        sys.exit(2)


def start() -> None:
    """Do what the words of this process say, in a child: a command may execute planners, which can
    end a process in silence.
    """
    if "_ARGCOMPLETE" in os.environ:
        from bezierplan.commands import completion

        completion.answer(COMMANDS)
    watchdog.supervise(
        words.plain(f"{PROGRAM} {' '.join(sys.argv[1:])}", words.LONGEST),
        partial(print, file=sys.stderr, flush=True),
    )
    try:
        main(sys.argv[1:])
    finally:
        watchdog.settle()


if __name__ == "__main__":
    start()
