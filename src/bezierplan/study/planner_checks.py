"""Checks that a file is a planner and that settings fit it; every fault is reported in one line."""

from types import ModuleType

from bezierplan.planners import is_file, known_planners, planner_settings
from bezierplan.running.columns import TAKEN
from bezierplan.running.guard import interface
from bezierplan.schema.checked import Fault, closest
from bezierplan.study.definition import Study
from bezierplan.study.files import inside


def loaded(study: Study, method: str, location: str) -> ModuleType:
    """The module of a method's planner. Raises Fault, beginning with a location, unless it has the
    interface of a planner and no setting named like a column of the runs table.
    """
    name = study.methods[method].planner
    location = f"{location}: planner: {name}"
    if is_file(name):
        inside(study.folder, name, location)
    elif name not in known_planners():
        raise Fault(
            f"{location}: unknown{closest(name, known_planners())}; "
            f"one of your own is a file, {name}.py"
        )
    module = interface.loaded(study.planner(method), location)
    for setting in planner_settings(module):
        # The column `generations` holds the number actually performed, so a setting of that name
        # adds nothing.
        if setting in TAKEN and setting != "generations":
            raise Fault(
                f"{location}: its setting {setting} is a column of the runs table, or joined to "
                "it; give it another name"
            )
    return module


def check_complete(study: Study, location: str) -> None:
    """Every method has a value for each setting. Raises Fault, with all missing ones by planner."""
    missing: dict[str, dict[str, None]] = {}
    for method in study.methods:
        lacking = [name for name in study.accepted(method) if name not in study.resolved(method)]
        missing.setdefault(study.methods[method].planner, {}).update(dict.fromkeys(lacking))
    told = [
        f"{', '.join(names)}: missing; {planner} needs {'it' if len(names) == 1 else 'them'}"
        for planner, names in missing.items()
        if names
    ]
    if told:
        raise Fault(f"{location}: settings: {'; '.join(told)}")
