"""Check a study: all its faults at once, each in one line."""

from pathlib import Path


def main(folder: Path) -> None:
    """Print every fault of a study, as a command that runs it does; exit with status 2 if there is
    one.

    Parameters
    ----------
    folder : Path
        that of the study

    Examples
    --------
    check-study mystudy
    """
    from bezierplan.study import loading

    loading.check_names(loading.load([folder]))
    print(f"{folder}: no fault")
