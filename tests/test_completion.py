"""Shells complete the words of the command line, and `list` shows what they name."""

import os
import subprocess
import sys

import pytest

from bezierplan.__main__ import COMMANDS, main
from bezierplan.commands import completion


def completed(line: str, folder) -> list[str]:
    """What a shell is told when its reader presses the key after a line."""
    told = folder / "told"
    asked = {
        "_ARGCOMPLETE": "1",
        "COMP_LINE": line,
        "COMP_POINT": str(len(line)),
        "_ARGCOMPLETE_IFS": "\n",
    }
    command = [sys.executable, "-m", "bezierplan"]
    subprocess.run(
        command,
        env=os.environ | asked | {"_ARGCOMPLETE_STDOUT_FILENAME": str(told)},
        check=True,
        timeout=120,
    )
    return [word.strip() for word in told.read_text(encoding="utf-8").splitlines()]


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("bezierplan ver", ["verify", "verify-outcome"]),
        ("bezierplan plan --ro", ["--robot-radius"]),
        ("bezierplan list song", ["song2016"]),
        ("bezierplan list met", ["methods"]),
        ("bezierplan check-planner ab", ["abc_ep"]),
        ("bezierplan completion z", ["zsh"]),
    ],
)
def test_words_are_completed(tmp_path, line, expected):
    assert completed(line, tmp_path) == expected


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_declares_its_arguments_without_doing_anything(name):
    from argparse import ArgumentParser

    parser = ArgumentParser(prog=name)
    completion.declare(parser, name)
    assert parser.parse_known_args.__func__ is ArgumentParser.parse_known_args
    assert parser.format_usage()


@pytest.mark.parametrize("shell", completion.SHELLS)
def test_every_shell_gets_code_that_names_the_command(shell):
    command = [sys.executable, "-m", "bezierplan", "completion", shell]
    told = subprocess.run(command, capture_output=True, text=True, check=True, timeout=120).stdout
    assert "bezierplan" in told
    assert "_ARGCOMPLETE" in told


@pytest.fixture
def listed(capsys):
    """What `list` prints for some words, and its exit code, in this process."""

    def of(*words: str) -> tuple[str, str, object]:
        code: object = 0
        try:
            main(["list", *words])
        except SystemExit as ended:
            code = ended.code
        return *capsys.readouterr(), code

    return of


def test_list_shows_the_kinds_and_studies_that_are_named(listed):
    first, *lines = listed("methods", "song2016")[0].splitlines()
    assert first.startswith("song2016: ")
    assert {line.split()[0] for line in lines} == {"method"}
    # One line says what the method is.
    assert any(
        "smooth" in line and "Genetic algorithm over the cells of a grid" in line for line in lines
    )
    kinds = {
        line.split()[0]
        for line in listed("claims", "tables")[0].splitlines()
        if line.startswith("  ")
    }
    assert kinds == {"claim", "table"}


def test_list_says_what_an_unknown_word_may_mean(listed):
    _, errors, code = listed("metods")
    assert code == 2
    assert errors.startswith("list: metods: neither a kind nor a study; did you mean methods?")
    assert len(errors.splitlines()) == 1
