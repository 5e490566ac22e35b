"""Run the contract tests of a planner on small and degenerate problems."""

import sys

from bezierplan import api
from bezierplan.commands.arguments import Settings
from bezierplan.running.guard import contract


def main(method: str, *, settings: Settings | None = None) -> None:
    """Print the contract tests of a method's planner; exit with status 1 if one fails.

    Parameters
    ----------
    method : str
        a planner's name or file, or STUDY/METHOD, where STUDY may be a folder
    settings : dict
        settings in place of the method's own

    Examples
    --------
    check-planner ma2020/bca
    check-planner mystudy/walk.py --settings '{tries: 200}'
    """
    planner, preset = api.find_method(method)
    passed = []
    for finding in contract.check_planner(planner, preset | (settings or {})):
        print(finding, flush=True)
        passed.append(finding.passed)
    print(f"{sum(passed)} of {len(passed)} facts hold")
    if not all(passed):
        sys.exit(1)
