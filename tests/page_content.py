"""A small page with every kind of content, hostile names among them, from files of results."""

import json
from pathlib import Path
from types import SimpleNamespace

import checks_of_claims
import pandas as pd
from pivots import pivot_of

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
    {"method": "a", "metric": "objective", "wide": True, "reason": "no exact map is printed"},
]

CLAIM = {"study": "one", "variant": "metric=length", "primary": True}
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
    for more in ({}, OTHER | {"verdict": "contradicted"})
]

CHECK = {"variant": "metric=length", "check": 1, "primary": True, "decisive": True, "test": "lower"}
CHECK |= {
    "metric": "length",
    "statistic": "mean",
    "unit": "unit",
    "place": json.dumps({"problem": "p"}),
}
CHECK |= {"group": "b", "relation": "lower than", "other": "c", "together": None}
CHECK |= {"mark": "+", "mark_family": "+", "effect": -1.0}
CHECK |= {
    "scale": "relative",
    "low95": -2.0,
    "high95": -0.2,
    "margin": 0.5,
    "effect_published": -2.0,
    "counted": None,
}
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
            "more": (caption("more", ""), table.but(published=None)),
            "listed": (caption("a list", ""), SimpleNamespace()),
        },
        figures={"figure1": caption("Lengths", HOSTILE)},
        assumptions=[OPEN_DETAIL],
        files=["claims", "claim_checks", "audit"],
        changes=[],
        answer=("One fails", HOSTILE),
    )
    return PageJob("smoke", {"one": study}, outcome=[])


def page(folder: Path) -> SimpleNamespace:
    """The page, from files that are written to a folder."""
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
        "one/beyond/more": laid,
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
    return build.gather_content(job(), folder, summary)
