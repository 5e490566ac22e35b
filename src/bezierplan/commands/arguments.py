"""Make a command's arguments from the signatures and docstrings of functions."""

import inspect
import re
from argparse import SUPPRESS, ArgumentParser, ArgumentTypeError, RawDescriptionHelpFormatter
from collections.abc import Callable, Collection, Iterator, Sequence
from pathlib import Path
from typing import Annotated, Any, NoReturn, get_args, get_origin

from bezierplan.schema import checked
from bezierplan.schema.checked import Fault

Settings = dict[str, Any]
OutFile = Annotated[Path, "is written"]
# As in `workspaces.limits`, which would import numpy before `places.choose_machine_code`.
Place = tuple[float, float]


class Parser(ArgumentParser):
    """A parser that says what is wrong in one line, without the usage."""

    def error(self, message: str) -> NoReturn:
        """End the process with status 2, after one line."""
        message = message.removeprefix("argument ")
        self.exit(2, f"{self.prog}: {message}; `{self.prog} --help` shows what is expected\n")


def call(
    program: str,
    main: Callable[..., None],
    functions: Sequence[Callable[..., Any]],
    words: Sequence[str],
) -> None:
    """Call a command's function with the words of a command line.

    program: how the command is called. functions: further functions to which the command passes
    options on. Options that the words leave out are not passed. Raises ValueError as the functions
    do; if its message begins with the name of an option, this gets its dashes.
    """
    sections = _split_sections(main)
    parser = Parser(
        prog=program,
        description=sections[""],
        epilog=f"examples:\n{sections.get('Examples', 'none')}",
        formatter_class=RawDescriptionHelpFormatter,
        # Options that are left out keep the functions' own defaults.
        argument_default=SUPPRESS,
    )
    options: dict[str, str] = {}
    for function in (main, *functions):
        for parameter, text in read_parameters(function):
            rest = parameter.kind is parameter.VAR_KEYWORD
            word = not rest and parameter.default is parameter.empty
            # Words of a function that is passed on, and what is passed on, are no arguments.
            skipped = rest if function is main else word
            if parameter.name not in options and not skipped:
                options[parameter.name] = _add(parser, parameter, word, text)
    # A word such as -2,0 is no option.
    words = [f" {word}" if re.match(r"-[0-9.]", word) else word for word in words]
    values = vars(parser.parse_args(words))
    given = [values.pop(name) for name in options if options[name] == ""]
    given += [word for name in [*values] if options[name] == "*" for word in values.pop(name)]
    try:
        main(*given, **values)
    except ValueError as fault:
        name, colon, rest = str(fault).partition(":")
        if colon and options.get(name, "").startswith("--"):
            raise type(fault)(f"{options[name]}:{rest}") from None
        raise


def _split_sections(function: Callable[..., Any]) -> dict[str, str]:
    """Return the sections of a docstring by heading; the first has an empty one."""
    parts = re.split(r"\n\n(\w+)\n-+\n", f"{inspect.getdoc(function)}")
    return dict(zip(["", *parts[1::2]], parts[::2]))


def read_parameters(function: Callable[..., Any]) -> Iterator[tuple[inspect.Parameter, str]]:
    """Yield the parameters of a function, each with its text in the docstring."""
    section = _split_sections(function).get("Parameters", "")
    texts = dict(re.findall(r"^\**(\w+).*\n((?: {4}.*\n?)+)", section, re.MULTILINE))
    for name, parameter in inspect.signature(function, eval_str=True).parameters.items():
        yield parameter, " ".join(texts.get(name, "").split())


def _add(parser: ArgumentParser, parameter: inspect.Parameter, word: bool, text: str) -> str:
    """Add an argument to a parser. Return its option, a star for several words, or an empty text
    for one word.
    """
    annotation = Settings if parameter.kind is parameter.VAR_KEYWORD else parameter.annotation
    read = next(each for each in (annotation, *get_args(annotation), str) if each in READS)
    # argparse reads a percent sign as the beginning of a name to fill in.
    options: dict[str, Any] = {"help": text.replace("%", "%%")}
    if read is bool:
        options["action"] = "store_true"
    else:
        options["type"], options["metavar"] = READS[read]
    if word:
        star = "*" * (parameter.kind is parameter.VAR_POSITIONAL)
        parser.add_argument(parameter.name, **options, nargs=star or None)
        return star
    if get_origin(annotation) is Sequence:
        options["action"] = "append"
    # An underscore at the end keeps a parameter apart from Python's own words, such as `from_`.
    option = f"--{parameter.name.rstrip('_').replace('_', '-')}"
    parser.add_argument(option, dest=parameter.name, **options)
    return option


def _read_place(text: str) -> Place:
    """Return x and y from a word such as `2.5,10`."""
    try:
        x, y = map(float, text.split(","))
    except ValueError:
        raise ArgumentTypeError(f"{text}; expected X,Y, two numbers such as 2.5,10") from None
    return x, y


def _read_settings(text: str) -> Settings:
    """Return settings from a word in YAML."""
    settings = checked.parse(text, "--settings")
    if not isinstance(settings, dict):
        raise ArgumentTypeError(f"{text}: expected '{{name: value, ...}}'")
    return settings


def _read_out(text: str) -> Path:
    """Return a file to write from a word. A wrong folder is told before the work, not after it."""
    if not (folder := Path(text).parent).is_dir():
        raise ArgumentTypeError(f"{text}: {folder} is no folder")
    return Path(text)


def check_suffix(option: str, file: Path | None, suffixes: Collection[str]) -> None:
    """Raise Fault for an output file whose suffix is not among those that the option takes."""
    if file and file.suffix not in suffixes:
        raise Fault(f"{option}: {file}; expected a file that ends in {', '.join(suffixes)}")


READS: dict[Any, tuple[Callable[[str], Any], str]] = {
    Place: (_read_place, "X,Y"),
    Settings: (_read_settings, "'{NAME: VALUE, ...}'"),
    bool: (bool, ""),
    int: (int, "N"),
    float: (float, "NUMBER"),
    Path: (Path, "FILE"),
    OutFile: (_read_out, "FILE"),
    str: (str, "NAME"),
}
"""Type of a parameter -> the function that reads it from a word, and its name in the help."""
