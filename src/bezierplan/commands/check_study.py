"""Check a study: all its faults at once, each in one line."""

import sys
from pathlib import Path

from bezierplan.schema import checked


def main(folder: Path) -> None:
    """Print every fault of a study; exit with status 1 if there is one.

    Parameters
    ----------
    folder : Path
        that of the study

    Examples
    --------
    check-study mystudy
    """
    from bezierplan.study import reading

    with checked.gathered() as faults:
        reading.load([folder])
    print("\n".join(faults) or f"{folder}: no fault")
    if faults:
        sys.exit(1)
