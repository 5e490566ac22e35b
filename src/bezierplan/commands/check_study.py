"""Check a study: all its faults at once, each in one line."""

from pathlib import Path

from bezierplan.commands import is_study
from bezierplan.places import STUDIES
from bezierplan.schema.checked import Fault


def main(folder: Path) -> None:
    """Print every fault of a study, as a command that runs it does; exit with status 2 if there is
    one.

    Parameters
    ----------
    folder : Path
        of the study, or the name of one of the project's

    Examples
    --------
    check-study mystudy
    """
    from bezierplan.study import loading

    found = folder if is_study(str(folder)) else STUDIES / folder
    if not is_study(str(found)):
        raise Fault(f"{folder}: expected a folder with a file experiments.yaml")
    loading.check_names(loading.load([found]))
    print(f"{folder}: no fault")
