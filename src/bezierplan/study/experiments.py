"""Models of `experiments.yaml`: methods, workspaces, problems, experiments."""

import re
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from bezierplan.machine.modules import find_code
from bezierplan.places import shorten_path
from bezierplan.planners import is_file, load_planner, read_settings
from bezierplan.running.descriptions import Descriptions
from bezierplan.running.simulation.policy import Policy
from bezierplan.schema import checked
from bezierplan.schema.checked import Fault
from bezierplan.schema.model import (
    Count,
    ExperimentName,
    Line,
    Model,
    Name,
    Positive,
    Setting,
    Whole,
    WorkspaceName,
    build_choice_type,
    build_error,
    build_list_type,
    build_mapping_type,
    build_name_type,
    build_number_type,
    build_text_type,
    build_whole_type,
    parse,
)
from bezierplan.workspaces.kinds import FileName, Workspace, build_numbers_type, kinds

SCALES = ("smoke", "full", "extended")

Settings = dict[Name, Setting]
SettingsByPlanner = dict[FileName, build_mapping_type(Settings, Setting)]
"""Settings of all planners, and under the name of a planner its own."""
PART = r"[A-Za-z0-9_.+-]+"
"""The form of a value that is part of the name of a run or of a folder."""
PART_EXPECTED = "a word of letters, digits, _, ., + and -"
Part = build_text_type(PART, PART_EXPECTED)
Scales = Annotated[dict[Literal[SCALES], Count], Field(min_length=len(SCALES))]
"""A number for each scale."""
ProblemName = build_text_type(r"[a-z0-9][a-z0-9_]*", "a name of lower-case letters, digits and _")
Problems = build_list_type(build_name_type("problem", ProblemName))
Point = build_numbers_type(2, "[x, y]")


class Method(Model):
    """A planner with its settings."""

    planner: FileName = Field(
        description="the name of a file in `src/bezierplan/planners`, or of a file `.py` in the "
        "study's folder"
    )
    settings: Settings = Field(
        {}, description="settings of this method alone, by name; they take precedence"
    )
    policy: build_name_type("policy") = Field(
        None,
        description="the name of a policy: needed in experiments in dynamic environments, refused "
        "in others",
    )
    variant_of: build_name_type("method") = Field(
        None, description="the method whose published numbers this one is compared with"
    )


class ProblemEntry(Model):
    """A workspace with a start and a target."""

    workspace: WorkspaceName = Field(description="the name of a workspace")
    start: Point = Field(None, description="[x, y] in units")
    target: Point = Field(None, description="[x, y] in units")
    start_cell: Whole = Field(
        None, description="on grids, the number of a cell: from 0, row by row from the bottom left"
    )
    target_cell: Whole = Field(None, description="the number of a cell, as `start_cell`")
    settings: Settings = Field(
        {},
        description="settings for this problem; they take precedence over the study's, a method's "
        "own over them",
    )
    reference: Positive = Field(
        None,
        description="the length of the best known path of the methods' own kind, a number above "
        "0; metric `gap_reference`",
    )
    layouts: Scales = Field(
        None,
        description="how many a workspace drawn at random has, for smoke, full and extended; "
        "column `layout`",
    )
    obstacles: build_list_type(build_whole_type(0, 100_000)) = Field(
        None,
        description="in a workspace drawn at random, a list of whole numbers: how many circles "
        "(of `random_circles` the first so many of a "
        "layout), or how many occupied cells (`random_blocks`), or how many cells change at a "
        "time (`random_changing_cells`); one problem "
        "for each of them and each layout; column `obstacles`",
    )
    side: build_whole_type(1, 5000) = Field(
        None,
        description="the side of a random field or of a map of blocks in cells, a whole "
        "number from 1 to 5000",
    )
    route: Part = Field(
        None,
        description="a name for start and target together, a column of the runs table: "
        f"{PART_EXPECTED}",
    )

    @model_validator(mode="after")
    def _check_ends(self) -> "ProblemEntry":
        """Refuse all but one pair of ends, and either layouts or obstacles alone."""
        ends = self.model_fields_set & {"start", "target", "start_cell", "target_cell"}
        if ends not in ({"start", "target"}, {"start_cell", "target_cell"}):
            given = " and ".join(sorted(ends)) or "neither"
            raise build_error(
                f"{given}: expected either start and target, or start_cell and target_cell"
            )
        if ("layouts" in self.model_fields_set) != ("obstacles" in self.model_fields_set):
            raise build_error("layouts and obstacles go together")
        return self


class Experiment(Model):
    """Problems × varied values × methods × repeats."""

    problems: Problems = Field(description="a list of problems")
    methods: build_list_type(build_name_type("own method")) = Field(description="a list of methods")
    vary: dict[Name, build_list_type(Setting)] = Field(
        {}, description="setting → list of values; every combination is run"
    )
    seeds: Literal["own", "shared", "common"] = Field(
        "own",
        description="whether a run's seed is its `own`, `shared` by all methods, or `common` to "
        "all methods and conditions",
    )
    time_limit: build_number_type(ge=1, le=1_000_000) = Field(
        600,
        description="seconds after which a single run, compiling included, is ended with its job, "
        "a number from 1 to 1000000",
    )
    repeats: Scales = Field(
        description="runs of each method under each condition, for smoke, full and extended"
    )
    chunk: Scales = Field(
        description="how many repeats one job runs, for smoke, "
        "full and extended, at most all of them"
    )
    fewer: dict[Name, dict[Part, Count]] = Field(
        {},
        description="where fewer runs suffice at scale extended: `method`, `problem`, or a varied "
        "setting → value → repeats, a multiple of the chunk",
    )

    @model_validator(mode="after")
    def _check_size(self) -> "Experiment":
        """Refuse a chunk above the repeats, `fewer` that are no whole chunks or not fewer, and
        values that cannot be part of a name.
        """
        for scale in SCALES:
            if self.chunk[scale] > self.repeats[scale]:
                raise build_error(
                    f"chunk: {scale}: {self.chunk[scale]}: expected at most {self.repeats[scale]}, "
                    "the repeats, since a chunk always runs whole"
                )
        chunk, most = self.chunk["extended"], self.repeats["extended"]
        for factor, fewer in self.fewer.items():
            for name, count in fewer.items():
                if count % chunk or count >= most:
                    raise build_error(
                        f"fewer: {factor}: {name}: {count}: expected a multiple of {chunk}, the "
                        f"chunk, below {most}, the repeats"
                    )
        for setting, values in self.vary.items():
            if odd := [each for each in values if not re.fullmatch(PART, str(each))]:
                raise build_error(
                    f"vary: {setting}: {odd[0]!r}: is part of a run's name; expected "
                    f"{PART_EXPECTED}, or a number"
                )
        return self

    def runs_of(self, scale: str, factor: str, value: Any) -> int:
        """Return the most repeats that a method, a problem or a varied value has at a scale."""
        most = self.repeats[scale]
        # Keys of a mapping in YAML are read as text, also those that look like numbers.
        return self.fewer.get(factor, {}).get(str(value), most) if scale == "extended" else most

    @property
    def paired(self) -> bool:
        """Return whether runs with equal repeat numbers share a seed."""
        return self.seeds != "own"


class FamilyEntry(Model):
    """Problems that belong together in the table of methods."""

    experiment: ExperimentName = Field(description="one of `experiments`")
    problems: Problems = Field(
        [], description="names of its problems, by default all; not of drawn workspaces"
    )
    straight: Literal["free", "blocked"] = Field(
        None, description="only the problems whose straight line from start to target is so"
    )

    def has(self, experiment: str, problem: str, straight: bool) -> bool:
        """Return whether a problem belongs here. straight: whether its straight line is free."""
        return (
            self.experiment == experiment
            and (not self.problems or problem in self.problems)
            and self.straight in (None, "free" if straight else "blocked")
        )


class BaselineEntry(Model):
    """The baseline with which the summary compares a study's methods."""

    baseline: build_name_type("baseline") = Field(description="a baseline")
    proposed: build_name_type("own method") = Field(
        None, description="the method that the paper proposes"
    )
    experiments: build_list_type(ExperimentName) = Field(
        description="the experiments in which the methods are compared with it; "
        "it must join each of them"
    )
    families: dict[Line, FamilyEntry] = Field(
        {},
        description="name → problems of these experiments that belong together: a row of the table "
        "of methods for each method",
    )


class Paper(Model):
    """The paper that a study repeats."""

    title: Line = Field(description="one line")
    authors: build_list_type(Line) = Field(description="a list of names")
    year: build_whole_type(1800, 2200) = Field(None, description="a whole number")
    journal: Line = Field(None, description="where it appeared")
    doi: Line = Field(None, description="its DOI, such as 10.1609/aiide.v11i1.12808")
    link: Line = Field(None, description="where it can be read")

    @property
    def where(self) -> str:
        """Return authors, journal, year and link, as far as they are known."""
        parts = [*self.authors, self.journal, self.year, self.link]
        return ", ".join(map(str, filter(None, parts)))


class ExperimentsFile(Model):
    """The content of `experiments.yaml`."""

    title: Line = Field(description="one line that names the study")
    paper: Paper = Field(
        None, description="the paper: title, authors, year, journal, doi, link; the page cites it"
    )
    methods: dict[Name, Method] = Field(description="name → planner and settings", min_length=1)
    baselines: dict[Name, Method] = Field(
        {},
        description="the same; each joins every experiment whose workspaces its planner serves, "
        "unless the experiment "
        "varies one of its settings. "
        "Baselines appear in comparisons, not in the tables laid out like the paper's",
    )
    settings: SettingsByPlanner = Field(
        description="settings of all methods. A planner's settings are the keyword-only arguments "
        "of its function `plan`; each "
        "needs a value, there "
        "are no defaults. Under the name of a planner: settings of its methods alone, which take "
        "precedence over the others, such as `prm: {samples: 50}`"
    )
    policies: dict[Name, Policy] = Field(
        {}, description="name → replanning policy of a robot in a dynamic environment"
    )
    workspaces: dict[Name, Annotated[Workspace, build_choice_type("kind", kinds())]] = Field(
        description="name → kind, unit, and the keys of the kind"
    )
    problems: dict[ProblemName, ProblemEntry] = Field(
        description="name → workspace, start and target", min_length=1
    )
    experiments: dict[Name, Experiment] = Field(
        description="name → problems × varied settings × methods × repeats", min_length=1
    )
    baseline_comparison: BaselineEntry = Field(
        None,
        description="the baseline beside which the summary measures the study's methods: a row of "
        "`methods.csv` for each method and problem",
    )


class Experiments(ExperimentsFile):
    """A study as far as `experiments.yaml` defines it; to plan by one of its methods needs no more.

    key: the name of the study. folder: its location. methods: those of the file, and its baselines.
    """

    key: str
    folder: Path

    @classmethod
    def build(cls, folder: Path, content: dict[str, Any]) -> Self:
        """Build the study in a folder from the checked content of its files; its baselines join its
        methods. Raises Fault for a baseline with the name of a method.
        """
        for name in content["baselines"].keys() & content["methods"]:
            raise Fault(
                f"{shorten_path(folder / 'experiments.yaml')}: baselines: {name}: a method has "
                "this name already"
            )
        content = content | {"methods": content["methods"] | content["baselines"]}
        # The content is of checked models already.
        return cls.model_construct(key=folder.resolve().name, folder=folder, **content)

    def read_accepted_settings(self, method: str) -> dict[str, Any]:
        """Return the declarations of the settings that a method's planner accepts, by name."""
        return read_settings(load_planner(self.planner(method)))

    @property
    def of_planners(self) -> dict[str, dict[str, Any]]:
        """Return the settings that only one planner's methods have, by planner."""
        return {name: each for name, each in self.settings.items() if isinstance(each, dict)}

    def resolve_settings(self, method: str) -> dict[str, Any]:
        """Return all settings of a method, by name.

        Later ones take precedence: the study's that its planner accepts, those of its planner, the
        method's own, and those that other values of assumptions change.
        """
        accepted = self.read_accepted_settings(method)
        common = {name: value for name, value in self.settings.items() if name in accepted}
        return (
            common
            | self.of_planners.get(self.methods[method].planner, {})
            | self.methods[method].settings
            | self.find_changed_settings(method)
        )

    def find_changed_settings(self, method: str, problem: str = "") -> dict[str, Any]:
        """Return no settings: `Study`, which knows the assumptions, overrides this with those that
        their chosen values change.
        """
        return {}

    def planner(self, method: str) -> str:
        """Return the planner of a method: a name, or the path of a file relative to the working
        folder.
        """
        planner = self.methods[method].planner
        return shorten_path(self.folder / planner) if is_file(planner) else planner

    def draws(self, method: str) -> bool:
        """Return whether a method draws random numbers. If not, one run stands for all repeats."""
        return not getattr(load_planner(self.planner(method)), "deterministic", False)

    def methods_of(self, experiment: str) -> list[str]:
        """Return the methods of an experiment, followed by the baselines that join it.

        A baseline joins if its planner serves all workspaces of the experiment and has none of the
        settings that this varies.
        """
        content, moves = self.experiments[experiment], self.moves(experiment)
        # Without `workspaces`, a planner serves all kinds.
        kinds, methods = {self.kind_of(problem) for problem in content.problems}, [*content.methods]
        for name, baseline in self.baselines.items():
            module = load_planner(self.planner(name))
            varied = content.vary.keys() & self.read_accepted_settings(name)
            served = kinds <= set(getattr(module, "workspaces", kinds))
            if served and not varied and moves == bool(baseline.policy):
                methods.append(name)
        return methods

    def workspace_of(self, problem: str) -> Workspace:
        """Return the workspace of a problem."""
        return self.workspaces[self.problems[problem].workspace]

    def moves(self, experiment: str) -> bool:
        """Return whether the runs of an experiment are simulated drives."""
        return any(
            self.workspace_of(problem).moves for problem in self.experiments[experiment].problems
        )

    def kind_of(self, problem: str) -> str:
        """Return the kind of workspace that planners see in a problem."""
        workspace = self.workspace_of(problem)
        # Planners see what is drawn, or what a file of another format is converted to.
        return workspace.drawn_kind or workspace.given_kind or workspace.kind

    def problems_of(self, experiment: str, scale: str, repeat: int = 0) -> dict[str, dict]:
        """Return the descriptions, as plain values, of an experiment's problems that have a repeat;
        by name.
        """
        content, described = self.experiments[experiment], {}
        for name in content.problems:
            if content.runs_of(scale, "problem", name) > repeat:
                described |= self.layouts_of(name, scale)
        return described

    def layouts_of(self, problem: str, scale: str) -> dict[str, dict]:
        """Return the descriptions of a problem, as plain values, by name: several if it has
        layouts, one for each layout and number of obstacles.
        """
        content = self.problems[problem]
        if content.layouts is None:
            return {problem: content.plain()}
        same = content.plain("layouts", "obstacles")
        return {
            f"{problem}_{layout}_{obstacles}": same | {"layout": layout, "obstacles": obstacles}
            for layout in range(content.layouts[scale])
            for obstacles in content.obstacles
        }

    def every_problem(self) -> dict[str, dict]:
        """Return the descriptions of all problems at scale full, by name."""
        return {
            name: described
            for problem in self.problems
            for name, described in self.layouts_of(problem, "full").items()
        }

    def describe_workspace(self, workspace: str) -> dict[str, Any]:
        """Return the description of a workspace as plain values, with the file of the function that
        draws it, if there is one.
        """
        plain = self.workspaces[workspace].plain()
        return plain | {"file": self.code_for("worlds")[0]} if "function" in plain else plain

    def code_for(self, *parts: str) -> list[str]:
        """Return the modules of the study's code for some parts (`machine.modules.PARTS`), if it
        has them.
        """
        code = find_code(self.key, shorten_path(self.folder))
        return [code[part] for part in parts if part in code]


def read(folder: Path) -> Experiments:
    """Read and check a study's `experiments.yaml` alone. Raises Fault."""
    file = folder / "experiments.yaml"
    content = parse(ExperimentsFile, checked.read(file, shorten_path(file)), shorten_path(file))
    return Experiments.build(folder, dict(content))


def build_problems_job(study: Experiments, experiment: str, scale: str) -> Descriptions:
    """Return what the problems of an experiment depend on, except the content of map files."""
    return build_descriptions(study, study.problems_of(experiment, scale))


def build_descriptions(study: Experiments, problems: dict[str, dict]) -> Descriptions:
    """Return what problems, given as plain values, depend on, except the content of map files."""
    homes = sorted({problem["workspace"] for problem in problems.values()})
    return Descriptions(
        study.key,
        {
            # Settings belong to runs (`Chunk.problems`): a change of one must not build the
            # problems again.
            name: {key: value for key, value in problem.items() if key != "settings"}
            for name, problem in problems.items()
        },
        {name: study.describe_workspace(name) for name in homes},
    )
