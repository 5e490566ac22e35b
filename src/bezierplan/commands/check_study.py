"""Check a study: all its faults at once, each in one line."""

import sys
from pathlib import Path

from bezierplan.schema.checked import Fault


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

    try:
        reading.load([folder])
    except Fault as fault:
        print("\n".join(fault.lines))
        sys.exit(1)
    print(f"{folder}: no fault")
