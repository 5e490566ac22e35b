"""Speed of the inner loops: `make benchmark`, or of some of its parts: `make benchmark ARGS="least
runs"`. With the word small, each part at its smallest size.

A part is a module with `COLUMNS` and `rows`; its table is printed and written into
results/benchmark.
"""

import importlib
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "src"))

import frame

PARTS = ("runs", "least", "simulation", "limits", "growth", "start")


def main(words: list[str]) -> None:
    small, names = "small" in words, [word for word in words if word != "small"]
    for name in names:
        if name not in PARTS:
            sys.exit(f"make benchmark: ARGS: {name}: unknown; expected some of {', '.join(PARTS)}")
    for name in names or PARTS:
        part = importlib.import_module(name)
        frame.table(name, part.COLUMNS, part.rows(small))


if __name__ == "__main__":
    main(sys.argv[1:])
