"""The command line: `python -m bezierplan COMMAND`. Each command is a file of `commands` with a
function `main`.
"""

import argparse
import importlib
import os
import signal
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
    "list": "list studies: their tables, figures, methods, workspaces, experiments and claims",
    "replay": "rerun one run, bit-identical, and plot it",
    "digest": "print a checksum of each run table; the order of rows does not matter, and timings "
    "are left out",
    "verify": "check every stored path and bound of a scale's results again, in fresh processes, "
    "or its numbers with docs/outcome",
    "check-planner": "run the contract tests of a planner on small and degenerate problems",
    "plan": "plan one path on a map and check it by exact geometry",
    "new": "make a study of your own, which runs at once",
    "run": "run targets of the workflow, from any folder",
    "outcome": "copy the outcome of results/extended and "
    "results/full to docs/outcome and into the README",
}

EXAMPLES = {
    "list": ("list", "list methods song2016", "list --settings --studies tharwat2018"),
    "replay": (
        "replay song2016/routes/15_240/smooth/3",
        "replay elhoseny2017/moving/moving_slow_0_10/mga_replans/0",
    ),
    "digest": ("digest results/full",),
    "verify": ("verify results/full --cores 2", "verify results/full --outcome"),
    "check-planner": (
        "check-planner bca --study ma2020",
        "check-planner mystudy/walk.py --settings '{tries: 200}'",
    ),
    "new": ("new mystudy", "new mystudy --from map.yaml --start 1,1 --target 9,9"),
}
"""Examples that the help of a command shows, where the command does not write its own."""


class _Parser(argparse.ArgumentParser):
    """A parser that tells what is wrong in one line, without the usage."""

    def error(self, message: str) -> NoReturn:
        self.exit(2, f"{self.prog}: {message}; `{self.prog} --help` shows what is expected\n")


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
        help="what to do; `COMMAND --help` shows its arguments",
    )
    parser.add_argument(
        "--version", action="version", version=f"bezierplan {bezierplan.__version__}"
    )
    if not words:
        parser.print_help()
        return
    if words[0] not in COMMANDS and not words[0].startswith("-"):
        from bezierplan.schema.checked import closest

        parser.error(f"{words[0]!r}: unknown{closest(words[0], COMMANDS)}")
    name = parser.parse_args(words[:1]).command
    examples = "\n".join(f"    {PROGRAM} {example}" for example in EXAMPLES.get(name, ()))
    command_parser = _Parser(
        prog=f"{PROGRAM} {name}",
        description=COMMANDS[name],
        epilog=f"examples:\n{examples}" if examples else None,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    try:
        importlib.import_module(f"bezierplan.commands.{name.replace('-', '_')}").main(
            command_parser, words[1:]
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


INTERRUPTED = 128 + signal.SIGINT
"""The exit status of a command that its user interrupts."""


def start() -> None:
    """Do what the words of this process say, in a child: a command may execute planners, which can
    end a process in silence.
    """
    watchdog.supervise(
        words.plain(f"{PROGRAM} {' '.join(sys.argv[1:])}", words.LONGEST),
        partial(print, file=sys.stderr, flush=True),
    )
    status = 1
    try:
        main(sys.argv[1:])
        status = 0
    except SystemExit as end:
        status = end.code if isinstance(end.code, int) else int(end.code is not None)
        raise
    except watchdog.Interrupted:
        status = INTERRUPTED
        print(f"{PROGRAM}: interrupted", file=sys.stderr, flush=True)
        sys.exit(status)
    finally:
        watchdog.settle(status)


if __name__ == "__main__":
    start()
