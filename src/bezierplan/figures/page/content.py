"""What the page holds, as frozen models: the page is drawn from them, and their JSON stands in it
with the schema that describes it.

An address names a place on the page, and is what follows `#` in a link to it. It reads like a path:
study, table, the keys that tell the row from others of the table's primary interpretation, metric,
statistic; study and claim; study and figure; the id of a run.
"""

from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field

FORMAT = 2
"""Number of the format; a change that breaks a reader of the JSON raises it."""

Address = Annotated[str, Field(description="what follows # in a link to this place of the page")]
Interval = tuple[float | None, float | None]
Cell = str | int | float | bool | None


class Record(BaseModel):
    """A frozen mapping; a key that is not described is an error."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class Part(Record):
    """A part of a sentence."""

    text: str
    address: Address | None = Field(None, description="the place that the words lead to")


class Extended(Record):
    """What the README's outcome, of scale extended, says of a published number or of a claim."""

    verdict: str
    n: float | None = Field(description="number of our runs that count")
    ours: float | None = Field(None, description="our number, for the paper's number of runs")
    holds: str = Field("", description="how many comparisons of a claim hold")


class Number(Record):
    """A cell of a table: a published number and ours."""

    address: Address
    keys: dict[str, Cell] = Field(
        description="column of the runs table -> value, as in the csv file"
    )
    row: str = Field(description="the keys as printed")
    column: str = Field(description="metric and statistic as printed")
    metric: str
    statistic: str
    unit: str
    published: float | None = Field(
        description="the published number; null if the paper prints none"
    )
    n_published: float | None = Field(description="number of runs behind it, if stated")
    ours: float | None
    scaled: float | None = Field(
        None,
        exclude_if=lambda scaled: scaled is None,
        description="ours as the published number of runs would print it: a count in proportion, "
        "a median extreme",
    )
    n: float | None = Field(description="number of our runs that count")
    interval: Interval = Field(description="95 % bootstrap interval of ours")
    predicted: Interval = Field(
        description="95 % prediction interval of an experiment of the published size"
    )
    verdict: str = Field(
        description="identified, agrees, disagrees or inconclusive; empty if not judged"
    )
    why: str = Field("", exclude_if=lambda why: not why, description="why it is inconclusive")
    primary: bool = Field(description="whether the row is the paper's interpretation")
    counted: bool = Field(description="whether it counts in the outcome")
    share_feasible: float | None = Field(
        description="share of all runs whose path the certified checker accepts"
    )
    bound: float | None = Field(
        description="exact shortest length of the problem, in the unit of length"
    )
    gap: float | None = Field(description="median over the feasible runs of length / bound - 1")
    extended: Extended | None = Field(None, exclude_if=lambda extended: extended is None)

    @property
    def beside(self) -> float | None:
        """Our number that is shown next to the published one."""
        return self.ours if self.scaled is None else self.scaled


class Table(Record):
    """A table: with `numbers` if it is compared with published ones, otherwise with `columns` and
    `rows` as in its csv file.
    """

    address: Address
    name: str
    title: str
    caption: str = Field(description="title, methods, their settings and repeats")
    csv: str = Field(description="its csv file, relative to the page")
    latex: str = Field(description="its LaTeX, relative to the page")
    numbers: list[Number] = []
    columns: list[str] = []
    rows: list[list[Cell]] = []


class Figure(Record):
    """A figure."""

    address: Address
    name: str
    title: str
    caption: str = Field(description="title, methods, their settings and repeats")
    told: str = Field(
        "", description="by panel, the run that it shows, and the runs that it counts"
    )
    seen: str = Field("", description="by panel, what is lowest and highest, if it compares")
    svg: str = Field(
        description="its picture, relative to the page; "
        "beside it lie others that end in .png and .pdf"
    )
    csv: str = Field(description="exactly the data that it shows, relative to the page")


class Comparison(Record):
    """A comparison of a claim in its primary variant."""

    check: int = Field(description="number of the check within the claim, from 1")
    deciding: bool = Field(description="whether the check decides the verdict, or is only reported")
    test: str
    metric: str
    statistic: str
    unit: str
    name: str = Field(description="what is compared, and where")
    mark: str = Field(
        description="+ holds, - the opposite holds, 0 neither, ? not known; in the family of all "
        "deciding comparisons"
    )
    effect: float | None
    interval: Interval = Field(description="95 % interval of the effect")
    margin: float | None = Field(description="the smallest effect that matters")
    reference: float = Field(
        0.0,
        description="the effect on whose other side the claim fails: 0, or the share that it needs",
    )
    effect_published: float | None = Field(description="the effect in the printed numbers")
    p: float | None
    n: float | None = Field(description="number of replicates")
    counted: str = Field(
        "", description="how many replicates of each group have a value, out of how many"
    )
    reason: str


class Interpretation(Record):
    """A claim judged with other values than the primary ones."""

    variant: str
    verdict: str
    holds: str


class Choice(Record):
    """What becomes of a claim with an alternative of an assumption."""

    assumption: str = Field(description="id of the assumption")
    alternative: str
    claim: str = Field(description="id of the claim")
    verdict: str = Field(description="under that alternative")
    changed: bool = Field(
        description="whether this differs from the verdict with the default, both being decided"
    )


class Claim(Record):
    """A sentence of the paper, or a finding of our own."""

    address: Address
    id: str
    place: str = Field(description="where the paper says it")
    statement: str
    finding: bool = Field(description="our own finding rather than a sentence of the paper")
    own_criterion: bool = Field(
        False,
        description="the paper gives no number, and the threshold or margin that decides is ours",
    )
    verdict: str
    holds: str = Field(description="how many comparisons hold")
    where: str = Field(description="where it holds, in words")
    published: str = Field(description="how many of those with printed numbers hold in these")
    reason: str
    replication: float | None = Field(
        description="share of experiments of the paper's size, "
        "drawn from our runs, in which it holds"
    )
    shown_in: list[Address] = Field(description="the tables and figures that show it")
    comparisons: list[Comparison]
    why: str = Field("", description="the decisive comparison in a plain sentence")
    decisive: int | None = Field(
        None, description="index in `comparisons` of the one that determines the verdict"
    )
    variant: str = Field(description="the primary values")
    interpretations: list[Interpretation]
    choices: list[Choice]
    more: dict[str, Cell] = Field(description="further columns of claims.csv")
    extended: Extended | None = None


class Assumption(Record):
    """What the paper leaves open, and the default."""

    address: Address
    id: str
    detail: str
    default: str
    alternatives: list[str]
    reason: str
    source: str = Field(
        description="where the default comes from: published, inferred, fitted or assumed"
    )
    setting: str = Field(description="the planner's setting that it governs; empty if none")
    claims: list[str] = Field(description="ids of the claims on which the alternatives are tried")
    choices: list[Choice]


class Audited(Record):
    """A printed number, checked against others or against an exact bound."""

    item: str
    place: str
    rule: str
    printed: Cell
    limit: Cell
    consistent: bool | None
    arithmetic: str = Field(
        description="how it was checked, for rules that hold for any paper; otherwise empty"
    )


class Method(Record):
    """A method: a planner with its settings."""

    address: Address
    name: str
    planner: str = Field(description="name of the planner, or its file")
    about: list[str] = Field(
        description="paragraphs that say what the planner does, and what of the paper it follows"
    )
    settings: dict[str, str] = Field(
        description="its settings in this study as text, by name; the planner's own defaults hold "
        "for the others"
    )


class BaselineComparison(Record):
    """A method compared with a baseline that needs no search: medians over conditions of its median
    over the baseline's.
    """

    address: Address
    method: str
    baseline: str
    conditions: int = Field(description="conditions under which both have runs")
    feasible: float = Field(
        description="share of its runs whose path the certified checker accepts"
    )
    feasible_baseline: float
    length: float | None = Field(description="length over the baseline's, feasible runs only")
    curvature: float | None = Field(
        description="largest curvature over the baseline's; null also for paths with corners"
    )
    cornered: bool = Field(
        description="whether its paths have corners, where the curvature is infinite"
    )
    cpu: float | None = Field(description="CPU time over the baseline's")


class Shown(Record):
    """Runs of a method in the viewer, by their ids in `runs`: on one problem, or on all of an
    experiment.
    """

    experiment: str
    problem: str = Field(description="empty for all problems of the experiment together")
    method: str
    count: int = Field(description="number of runs")
    feasible: int = Field(description="number of feasible runs")
    best: str | None = Field(
        description="the feasible run with the least length over the exact bound"
    )
    median: str | None
    worst: str | None
    failed: list[str] = Field(description="runs without a feasible path, the first few")


class Paper(Record):
    """A paper as it is cited."""

    title: str
    where: str = Field(description="journal and year, as far as known")
    doi: str | None


class Study(Record):
    """A paper, or a study of a reader's own."""

    address: Address
    title: str
    paper: Paper | None = Field(None, description="null for a study that is no paper")
    outcome: dict[str, int] = Field(description="how many numbers and claims there are, by verdict")
    methods: list[Method] = []
    claims: list[Claim]
    tables: list[Table]
    figures: list[Figure]
    audit: list[Audited]
    assumptions: list[Assumption]
    gap: float | None = Field(
        None, description="median gap of the numbers that count in the outcome"
    )
    baseline_comparison: list[BaselineComparison] = []
    baseline_comparison_in_words: str = Field(
        "", description="what follows from `baseline_comparison`"
    )
    shown: list[Shown]
    labels: dict[str, str] = Field(description="name -> how it is printed")


class World(Record):
    """How obstacles move while a robot drives: circles, or cells that change. Time is counted in
    steps.
    """

    walls: list[float] = Field(
        [],
        description="lowest and highest x, lowest and highest y of centres, "
        "which are reflected there",
    )
    circles: list[list[float]] = Field(
        [],
        description="x, y, velocity in x and in y per step, radius; a straight line within a step",
    )
    moments: list[float] = Field([], description="when cells change, in steps")
    changed: list[list[int]] = Field(
        [], description="the cells that change at each moment, row by row from the top left one"
    )


class Problem(Record):
    """A workspace with start, target and the exact shortest path."""

    workspace: str = Field(
        description="key in `workspaces`; of a world that moves, the workspace at its beginning"
    )
    world: World | None = Field(None, description="motion of the obstacles; null if they stand")
    start: tuple[float, float]
    target: tuple[float, float]
    bound: float | None = Field(description="length of the exact shortest path")
    bound_path: list[float] = Field(description="x0, y0, x1, y1, ...")


class Run(Record):
    """A run. Points are rounded to what a picture shows; the parquet files have them to the last
    bit.
    """

    problem: str = Field(description="key in `problems`")
    feasible: bool
    claimed: bool = Field(description="the planner's own verdict")
    length: float | None
    clearance: float | None
    collision: tuple[float, float] | None = Field(
        description="where the path first meets an obstacle or leaves the border"
    )
    depth: float | None = Field(description="depth of the path in obstacles or beyond the border")
    evaluations: int
    stop: str
    curve: str
    path: list[float] = Field(description="x0, y0, x1, y1, ... along the path")
    control: list[float] = Field(description="control points; empty if some are tangents")
    history: list[tuple[int, float]] = Field(
        description="generation and best objective, where it changes; of a drive, each plan's"
    )
    steps: float | None = Field(None, description="of a drive: time until its end, in steps")
    driven: list[float] = Field(
        [],
        description="of a drive: distance along `path` at step 0, 1, ... and at the end",
    )
    collision_step: float | None = Field(
        None, description="of a drive: time of the first collision, in steps"
    )


class Verified(Record):
    """What was judged again from stored points when the page was made, all of it without a
    difference.
    """

    files: int = Field(description="files of runs")
    runs: int
    paths: int = Field(description="different paths among those of the runs")
    bounds: int = Field(description="exact bounds that were computed again")
    digest: str = Field(description="of all runs")
    versions: dict[str, str] = Field(description="library that computes -> its version")


class Headline(Record):
    """The outcome of all studies: a few sentences, and a table with a row for each study."""

    sentences: list[str]
    columns: list[str] = Field(description="headings")
    rows: dict[str, list[str]] = Field(description="study -> its cells, one for each column")


class Page(Record):
    """All results of a scale."""

    format: int = FORMAT
    scale: str
    about_scale: list[str] = Field(
        [], description="sentences: how many runs there are, and what the README's numbers rest on"
    )
    made_by: str = Field("bezierplan", description="version and commit")
    headline: Headline | None = Field(
        None, description="the outcome; null at a scale that judges nothing"
    )
    headline_extended: list[str] = Field(
        [], description="sentences: the README's headline, of scale extended"
    )
    answer: list[list[Part]] = Field(description="further sentences, each in parts")
    verified: Verified | None = Field(None, description="the check of the runs that the page shows")
    studies: dict[str, Study]
    workspaces: dict[str, dict[str, Any]] = Field(
        description="kind, unit, bounds and shapes, by the first problem in each"
    )
    problems: dict[str, Problem]
    runs: dict[str, Run]
