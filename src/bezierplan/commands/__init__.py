"""The commands of `python -m bezierplan`, one file each: `main` adds the arguments to a parser, reads the words, and does it."""

from argparse import ArgumentParser


def add_studies(parser: ArgumentParser) -> None:
    """Let a command take other studies than those of config/config.yaml."""
    text = "studies instead of those of config/config.yaml: names of folders in config/studies, or paths"
    parser.add_argument("--studies", nargs="+", metavar="STUDY", help=text)
