"""A small page with every kind of content, hostile names among them, from files of results."""

import json
from pathlib import Path
from types import SimpleNamespace

import checks_of_claims
import pandas as pd
from pivots import pivot_of

from bezierplan.analysis.columns import COLUMNS_OF
from bezierplan.figures.caption import Caption, CaptionClaim
from bezierplan.figures.page import build
from bezierplan.figures.page.page_job import (
    MethodView,
    PageJob,
    StudyView,
)

HOSTILE = '</script><script>window.broken = 1</script><img src=x onerror="window.broken = 1">'
SVG = (
    '<svg xmlns="http://www.w3.org/2000/svg" width="144pt" height="72pt"><title>drawn</title></svg>'
)

NUMBER = {"statistic": "mean", "unit": "unit", "n_published": 10, "value_published": 10.51}
NUMBER |= {"n_ours": 10, "value_ours": 10.715, "value_ours_scaled": 10.715}
NUMBER |= {"low95_predicted": 10.1, "high95_predicted": 11.3, "wide": False, "reason": None}
NUMBER |= {"share_feasible": 0.9, "bound": 7.7, "primary": True, "position": "inside"}
NUMBERS = [
    {"method": "a", "metric": "length"},
    {"method": "b", "metric": "length", "position": "above"}
    | {"value_ours": 14.0, "value_ours_scaled": 14.0},
    {"method": "a", "metric": "objective", "wide": True, "reason": "the map is ours"},
    {"method": "c", "metric": "length", "position": None}
    | {"primary": False, "value_published": None},
]

CLAIM = {"study": "one", "variant": "metric=length", "primary": True, "own_criterion": False}
CLAIM |= {"main": False, "readings": "", "place": "IV, Table I", "holds": "1 of 2"}
CLAIM |= {"where_it_holds": "for a", "published": "2 of 2", "reason": HOSTILE, "artefact": "table1"}
OTHER = {"variant": "metric=objective", "primary": False, "holds": "0 of 2"}
CLAIMS = [
    {"id": identity, "statement": f"Method a is the best ({identity}).", "verdict": verdict}
    | {"finding": finding}
    | more
    for identity, verdict, finding in (
        ("C1", "supported", False),
        ("C2", "contradicted", False),
        ("C3", "undecided", True),
    )
    for more in ({"own_criterion": identity == "C2"}, OTHER | {"verdict": "contradicted"})
]

CHECK = {"variant": "metric=length", "check": 1, "primary": True, "decisive": True, "test": "lower"}
CHECK |= {
    "metric": "length",
    "statistic": "mean",
    "unit": "unit",
    "place": json.dumps({"problem": "p"}),
}
LEVEL = {
    "study": "one",
    "table": "table1",
    "place": json.dumps({"problem": HOSTILE}),
    "metric": "length",
}
LEVEL |= {"quantity": "level", "printed": 10.5, "position": "inside"}
ORDER = LEVEL | {"quantity": "order", "printed": -0.5, "position": "below"}
ORDER |= {"low95_predicted": 0, "high95_predicted": 1}
CHECK |= {"group": "b", "relation": "lower than", "other": "c", "together": None}
CHECK |= {"mark": "+", "mark_family": "+", "effect": -1.0}
CHECK |= {"low95": -2.0, "high95": -0.2, "margin": 0.5, "effect_published": -2.0, "counted": None}
OPEN = {"decisive": False, "mark": "?", "mark_family": "?", "effect": 0.4, "low95": None}
LOWER = {"test": "lower", "experiment": "e", "metric": "length", "groups": ["b"], "than": ["c"]}
LOWER |= {"margin": 0.5, "direction": "lower"}


OPEN_DETAIL = {"id": "O1", "detail": HOSTILE, "default": 5, "alternatives": [8]}
OPEN_DETAIL |= {"reason": "it fits", "source": "inferred", "setting": "genes"}


def caption(title: str, says: str, *claims: str) -> Caption:
    """A caption with claims whose verdicts only the scale knows."""
    findings = [CaptionClaim(name, f"{HOSTILE} ({name})", "") for name in claims]
    return Caption(title, findings, says, "Ten runs")


def job() -> PageJob:
    """A study `one` with three claims, four numbers, three tables, a figure, an assumption."""
    values = [{"metric": metric, "statistic": "mean"} for metric in ("length", "objective")]
    table = pivot_of({"index": ["method"], "values": values, "published": "table1.csv"})
    claims = ("C1", "C2", "C3")
    study = StudyView(
        title=HOSTILE,
        paper=SimpleNamespace(title=HOSTILE, where="A journal, 2000", doi="10.1/x"),
        labels={"a": HOSTILE, "p": "the room"},
        methods={"a": MethodView("chaotic_pso", {"size": HOSTILE}, HOSTILE)},
        claims={
            name: SimpleNamespace(
                checks=[checks_of_claims.check_of(LOWER)],
                holds="any",
                variants={"metric": ["length", "objective"]},
                variant_names=[],
            )
            for name in claims
        },
        repeats=[2, 3],
        tables={
            "table1": (caption(HOSTILE, HOSTILE, "C1", "C2"), table),
            "more": (caption("more", ""), table.but(extends="table1")),
            "listed": (caption("a list", ""), SimpleNamespace()),
        },
        figures={"figure1": caption("Lengths", HOSTILE)},
        assumptions=[OPEN_DETAIL],
        files=["claims", "claim_checks", "audit"],
        experiments={},
        changes=[],
        answer=("One fails", HOSTILE),
    )
    return PageJob("smoke", {"one": study}, outcome=[])


def page(folder: Path) -> SimpleNamespace:
    """The page, from files that are written to a folder; with three runs and two drives."""
    for tree in ("paper", "beyond"):
        (folder / "one" / tree).mkdir(parents=True, exist_ok=True)
    numbers = pd.DataFrame([row | NUMBER | row for row in NUMBERS])
    printed, laid = numbers["value_published"].notna(), pd.DataFrame({"method": ["a", "b"]})
    claims = pd.DataFrame([CLAIM | row for row in CLAIMS])
    checks = [CHECK | {"id": f"C{n}"} | more for n in (1, 2, 3) for more in ({}, OPEN)]
    row = {"study": "one", "family": HOSTILE, "problem": "p", "runs": 10, "free": 0.9}
    row |= {"excess": 0.1, "round": 9, "cornered": 0, "cpu_ms": 20.0, "curvature": 1.25}
    row |= {"rounded": 0.05, "rounded_curvature": 1.25}
    audited = {"item": "table1", "place": HOSTILE, "rule": "sum", "printed": 4, "limit": 3.5}
    files = {
        "one/claims": claims,
        "one/claim_checks": pd.DataFrame(checks),
        "one/audit": pd.DataFrame([audited | {"consistent": False, "arithmetic": HOSTILE}]),
        "one/paper/table1.comparison": numbers[printed].assign(
            table_row=[0, 1, 0], table_column=[0, 0, 1], as_printed="10.51"
        ),
        "one/paper/table1": laid.assign(length=["10.715", "14.000"], objective=["10.715", ""]),
        "one/paper/table1.order_and_level": pd.DataFrame(
            [LEVEL, ORDER], columns=COLUMNS_OF["order_and_level"]
        ),
        "one/beyond/more.comparison": numbers,
        "one/beyond/listed": pd.DataFrame({"x": range(12), HOSTILE: HOSTILE}),
        "numbers": numbers[printed].assign(study="one", table="table1", counted=True),
        "claims": claims,
        "methods": pd.DataFrame(
            [
                row | {"method": "a", "proposed": True},
                row | {"method": "c", "proposed": False, "round": 0, "cornered": 9},
            ]
        ),
    }
    for name, table in files.items():
        table.to_csv(folder / f"{name}.csv", index=False)
    (folder / "one/paper/figure1.svg").write_text(SVG)
    (folder / "one/paper/figure1.txt").write_text(
        "Lengths.\n(a) run one/first/p/b/0.\n(a) lowest mean: b.\n"
    )
    summary = [str(folder / f"{name}.csv") for name in ("numbers", "claims", "methods")]
    made = build.gather_content(job(), folder, summary)
    made.data |= viewed()
    study = made.data["studies"]["one"]
    study["shown"] = made.studies["one"].shown = shown()
    return made


def shown() -> list[dict]:
    """On a room; and in worlds that move, a drive among circles and a failed one among cells."""
    given = {"problem": "p", "method": "a", "count": 1, "feasible": 1, "gap": 0.1, "failed": []}
    given |= dict.fromkeys(("best", "median", "worst"))
    first = {f: f"one/first/p/a/{n}" for n, f in enumerate(("best", "worst"))}
    first |= {"count": 3, "feasible": 2, "median": first["best"], "failed": ["one/first/p/a/2"]}
    return [
        given | {"experiment": "first"} | first,
        given | {"experiment": "circles", "best": "one/circles/p/a/0"},
        given | {"experiment": "cells", "feasible": 0, "gap": None, "failed": ["one/cells/p/a/0"]},
    ]


def viewed() -> dict[str, dict]:
    """Runs, problems and workspaces."""
    run = {"problem": "one/first/p", "feasible": True, "claimed": True, "length": 9.5}
    run |= {"clearance": 0.1, "depth": 0.0, "collision": None, "evaluations": 100, "steps": None}
    run |= {"stop": "generations", "curve": "bezier", "path": [0.5, 0.5, 2.0, 1.5, 3.5, 2.5]}
    run |= {"control": [0.5, 0.5, 3.5, 2.5], "history": [(0, 20.0), (3, 9.5)]}
    failed = {"feasible": False, "depth": 0.4, "collision": (2.0, 1.5)}
    # Two units to the right and one up, in three and a half steps, the first of which is waiting.
    drive = {"path": [0.5, 0.5, 2.5, 0.5, 2.5, 1.0], "control": [], "stop": "arrived"}
    drive |= {"steps": 3.5, "driven": [0.0, 0.0, 1.0, 2.0, 2.5], "collision_step": None}
    struck = failed | {"collision": (1.5, 0.5), "collision_step": 2.0}
    room = {"workspace": "one/first/p", "world": None, "bound": 4.13}
    room |= {"start": (0.5, 0.5), "target": (3.5, 2.5), "bound_path": [0.5, 0.5, 1, 2, 3.5, 2.5]}
    # Reflected at x = 3.5 after half a step.
    circles = {"walls": [0.5, 3.5, 0.5, 2.5], "circles": [[3.0, 1.0, 1.0, 0.0, 0.25]]}
    cells = {"circles": [], "moments": [2.0], "changed": [[5, 11]]}
    kind = {"unit": "unit", "bounds": [0, 4, 0, 3]}
    return {
        "runs": {
            "one/first/p/a/0": run,
            "one/first/p/a/1": run,
            "one/first/p/a/2": run | failed,
            "one/circles/p/a/0": run | drive | {"problem": "one/circles/p"},
            "one/cells/p/a/0": run | drive | struck | {"problem": "one/cells/p"},
        },
        "problems": {
            "one/first/p": room,
            "one/circles/p": room | {"workspace": "one/circles/p", "world": circles},
            "one/cells/p": room | {"world": cells},
        },
        "workspaces": {
            "one/first/p": kind | {"kind": "grid", "cell": 1, "rows": ["....", ".##.", "...."]},
            "one/circles/p": kind | {"kind": "circles", "circles": [[3.0, 1.0, 0.25]]},
        },
    }
