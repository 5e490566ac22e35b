"""Completion of commands, options and names by bash, zsh and fish (`argcomplete`)."""

import importlib
import os
from argparse import Action, ArgumentParser
from collections.abc import Callable, Iterable
from typing import Any

SHELLS = ("bash", "zsh", "fish")


class _DeclaredError(Exception):
    """A command has said which arguments it takes."""


def main(parser: ArgumentParser, words: list[str]) -> None:
    """Print what a shell evaluates to complete the words of `bezierplan`."""
    parser.epilog = (
        'bash: eval "$(bezierplan completion bash)" in ~/.bashrc; fish: bezierplan '
        "completion fish | source"
    )
    parser.add_argument("shell", choices=SHELLS, help="whose words are to be completed")
    shell = parser.parse_args(words).shell
    import argcomplete

    print(argcomplete.shellcode(["bezierplan"], shell=shell))


def named(action: Action, names: Callable[[], Iterable[str]]) -> None:
    """Let an argument be completed by names, which are looked up only then."""
    action.completer = lambda **_: list(names())  # type: ignore[attr-defined]  # where argcomplete looks for it


def answer(commands: dict[str, str]) -> None:
    """Tell the shell, which asks by its environment, how the words go on, and end the process.
    commands: name -> what it does.
    """
    import argcomplete

    parser = ArgumentParser(prog="bezierplan")
    parser.add_argument("--version", action="store_true", help="print the version")
    below = parser.add_subparsers()
    written = os.environ.get("COMP_LINE", "").split()
    for name, text in commands.items():
        own = below.add_parser(name, help=text)
        if name in written:  # to import a command takes time
            declare(own, name)
    argcomplete.autocomplete(parser)


def declare(parser: ArgumentParser, name: str) -> None:
    """Add the arguments of a command to a parser, without running it."""

    def stop(*_: Any, **__: Any) -> None:
        raise _DeclaredError

    parser.parse_args = parser.parse_known_args = stop  # type: ignore[method-assign]
    try:
        importlib.import_module(f"bezierplan.commands.{name.replace('-', '_')}").main(parser, [])
    except _DeclaredError:
        pass
    finally:
        del parser.parse_args, parser.parse_known_args
