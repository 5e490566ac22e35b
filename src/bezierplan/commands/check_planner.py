"""The contract tests of a planner (`contract`) on the command line."""

import sys
from argparse import ArgumentParser

from bezierplan.commands import of_study, settings_in
from bezierplan.running import contract


def main(parser: ArgumentParser, words: list[str]) -> None:
    """Print a planner's contract tests; exit with status 1 if one failed. Raises Fault."""
    parser.add_argument(
        "planner", help="its name, or the path of its file; with --study the name of a method"
    )
    source = parser.add_mutually_exclusive_group()
    source.add_argument(
        "--settings",
        default="{}",
        metavar="'{NAME: VALUE, ...}'",
        help="a value for each of its settings, as in a study",
    )
    source.add_argument(
        "--study",
        metavar="STUDY",
        help="a name in config/studies, or a path: planner and settings are those of its method",
    )
    words = parser.parse_args(words)
    planner, settings = (
        of_study(words.study, words.planner, f"{words.study}: methods")
        if words.study
        else (words.planner, settings_in(words.settings))
    )
    failed = total = 0
    for check in (contract.check_planner, contract.check_elsewhere):
        for finding in check(planner, settings):
            print(finding, flush=True)
            total += 1
            failed += not finding.passed
        if failed:
            break
    print(f"{total - failed} of {total} facts hold")
    if failed:
        sys.exit(1)
