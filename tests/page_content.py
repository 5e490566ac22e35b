"""A small page with every kind of content, hostile names among them."""

from bezierplan.figures.page import answer, content

HOSTILE = '</script><script>window.broken = 1</script><img src=x onerror="window.broken = 1">'


def number(name: str, verdict: str, **more) -> content.Number:
    method, metric = name.split("/")
    given = {
        "address": f"one/table1/{name}/mean",
        "keys": {"method": method},
        "row": method,
        "column": metric,
        "metric": metric,
    }
    given |= {
        "statistic": "mean",
        "unit": "unit",
        "published": 10.51,
        "n_published": 10,
        "ours": 10.715,
        "n": 10,
    }
    given |= {
        "interval": (10.2, 11.1),
        "predicted": (10.1, 11.3),
        "verdict": verdict,
        "primary": True,
        "counted": True,
    }
    return content.Number(**given | {"share_feasible": 0.9, "bound": 7.7, "gap": 0.396} | more)


def comparison(
    effect: float | None, low: float | None, high: float | None, mark: str = "+"
) -> content.Comparison:
    given = {
        "check": 1,
        "deciding": True,
        "test": "lower",
        "metric": "length",
        "statistic": "mean",
        "unit": "unit",
        "name": "a lower than b",
    }
    given |= {
        "mark": mark,
        "effect": effect,
        "interval": (low, high),
        "margin": 0.5,
        "effect_published": -2.0,
        "p": 0.01,
        "n": 10,
    }
    return content.Comparison(**given, reason="")


def claim(identity: str, verdict: str, **more) -> content.Claim:
    given = {
        "address": f"one/{identity}",
        "id": identity,
        "place": "IV, Table I",
        "statement": f"Method a is the best ({identity}).",
        "finding": False,
    }
    given |= {
        "verdict": verdict,
        "holds": "1 of 2",
        "where": "for a",
        "published": "2 of 2",
        "reason": HOSTILE,
        "replication": 0.9,
    }
    given |= {
        "shown_in": ["one/table1"],
        "comparisons": [comparison(-1.0, -2.0, -0.2), comparison(0.4, None, None, "?")],
        "decisive": 0,
        "variant": "metric=length",
    }
    given |= {
        "interpretations": [
            content.Interpretation(
                variant="metric=objective", verdict="contradicted", holds="0 of 2"
            )
        ]
    }
    given |= {
        "choices": [
            content.Choice(
                assumption="O1", alternative="8", claim=identity, verdict="undecided", changed=True
            )
        ],
        "more": {"new_column": "text"},
    }
    return content.Claim(**given | more)


def study(claims: list[content.Claim], numbers: list[content.Number]) -> content.Study:
    words = {"title": HOSTILE, "caption": HOSTILE}
    table = content.Table(
        address="one/table1",
        name="table1",
        csv="one/paper/table1.comparison.csv",
        latex="one/paper/table1.tex",
        numbers=numbers,
        **words,
    )
    listing = content.Table(
        address="one/listed",
        name="listed",
        csv="one/beyond/listed.csv",
        latex="one/beyond/listed.tex",
        columns=["x", HOSTILE],
        rows=[[n, HOSTILE] for n in range(12)],
        **words,
    )
    shown = {
        "experiment": "first",
        "method": "a",
        "count": 3,
        "feasible": 2,
        "median": "one/first/p/a/0",
        "failed": ["one/first/p/a/2"],
    }
    open_choice = {
        "detail": HOSTILE,
        "default": "5",
        "alternatives": ["8"],
        "reason": "it fits",
        "source": "inferred",
        "setting": "genes",
    }
    return content.Study(
        address="one",
        title=HOSTILE,
        paper=content.Paper(title=HOSTILE, where="A journal, 2000", doi="10.1/x"),
        outcome={"numbers": 2, "agrees": 1, "supported": 1},
        methods=[
            content.Method(
                address="one/method/a",
                name="a",
                planner="swarm",
                about=["A swarm.", HOSTILE],
                settings={"size": HOSTILE},
            )
        ],
        claims=claims,
        tables=[table, listing],
        figures=[],
        audit=[
            content.Audited(
                item="table1",
                place=HOSTILE,
                rule="sum",
                printed=4,
                limit=3.5,
                consistent=False,
                arithmetic=HOSTILE,
            )
        ],
        assumptions=[
            content.Assumption(
                address="one/O1", id="O1", claims=["C1"], choices=claims[0].choices, **open_choice
            )
        ],
        shown=[
            content.Shown(problem="p", best="one/first/p/a/0", worst="one/first/p/a/1", **shown),
            *drives(),
        ],
        baseline_comparison=[baseline_comparison("a", 1.25), baseline_comparison("c", None)],
        baseline_comparison_in_words=HOSTILE,
        labels={"a": HOSTILE, "p": "the room"},
    )


def baseline_comparison(method: str, curvature: float | None) -> content.BaselineComparison:
    given = {
        "baseline": "rounded",
        "conditions": 3,
        "feasible": 0.9,
        "feasible_baseline": 1.0,
        "length": 1.1,
        "cpu": 20.0,
    }
    return content.BaselineComparison(
        address=f"one/baseline_comparison/{method}",
        method=method,
        curvature=curvature,
        cornered=curvature is None,
        **given,
    )


def drives() -> list[content.Shown]:
    """Two experiments in worlds that move: a drive among circles, and a failed one among cells that
    change.
    """
    given = {"problem": "p", "method": "a", "count": 1}
    return [
        content.Shown(
            experiment="circles",
            feasible=1,
            best="one/circles/p/a/0",
            median=None,
            worst=None,
            failed=[],
            **given,
        ),
        content.Shown(
            experiment="cells",
            feasible=0,
            best=None,
            median=None,
            worst=None,
            failed=["one/cells/p/a/0"],
            **given,
        ),
    ]


def drive(world: str, feasible: bool) -> content.Run:
    """Two units to the right and one up, in three and a half steps, the first of which is spent
    waiting.
    """
    more = {
        "problem": f"one/{world}/p",
        "path": [0.5, 0.5, 2.5, 0.5, 2.5, 1.0],
        "control": [],
        "curve": "polyline",
        "stop": "arrived",
    }
    more |= {
        "steps": 3.5,
        "driven": [0.0, 0.0, 1.0, 2.0, 2.5],
        "collision": None if feasible else (1.5, 0.5),
    }
    return run(feasible).model_copy(update=more | {"collision_step": None if feasible else 2.0})


def run(feasible: bool) -> content.Run:
    given = {
        "problem": "one/first/p",
        "feasible": feasible,
        "claimed": True,
        "length": 9.5,
        "clearance": 0.1,
        "depth": 0.0 if feasible else 0.4,
    }
    given |= {
        "collision": None if feasible else (2.0, 1.5),
        "evaluations": 100,
        "stop": "generations",
        "curve": "bezier",
    }
    return content.Run(
        **given,
        path=[0.5, 0.5, 2.0, 1.5, 3.5, 2.5],
        control=[0.5, 0.5, 3.5, 2.5],
        history=[(0, 20.0), (3, 9.5)],
    )


def page() -> content.Page:
    """A study `one` with three claims, four numbers, two tables, an open choice, a check, three
    runs and two drives.
    """
    numbers = [
        number("a/length", "agrees"),
        number("b/length", "disagrees"),
        number("a/objective", "inconclusive", why="interval without an end on that side"),
    ]
    numbers.append(number("c/length", "", published=None, primary=False, counted=False))
    own = {
        "one": study(
            [
                claim("C1", "supported"),
                claim("C2", "contradicted"),
                claim("C3", "undecided", finding=True),
            ],
            numbers,
        )
    }
    workspace = {
        "kind": "grid",
        "unit": "unit",
        "cell": 1,
        "rows": ["....", ".##.", "...."],
        "bounds": [0, 4, 0, 3],
    }
    ends = {"start": (0.5, 0.5), "target": (3.5, 2.5)}
    problem = content.Problem(
        workspace="one/first/p", bound=4.13, bound_path=[0.5, 0.5, 1, 2, 3.5, 2.5], **ends
    )
    round_things = {
        "kind": "circles",
        "unit": "unit",
        "circles": [[3.0, 1.0, 0.25]],
        "bounds": [0, 4, 0, 3],
    }
    worlds = {
        # Reflected at x = 3.5 after half a step.
        "circles": content.World(walls=[0.5, 3.5, 0.5, 2.5], circles=[[3.0, 1.0, 1.0, 0.0, 0.25]]),
        "cells": content.World(moments=[2.0], changed=[[5, 11]]),
    }
    moving = {
        f"one/{name}/p": problem.model_copy(update={"workspace": place, "world": worlds[name]})
        for name, place in (("circles", "one/circles/p"), ("cells", "one/first/p"))
    }
    runs = {f"one/first/p/a/{n}": run(feasible=n < 2) for n in range(3)}
    runs |= {"one/circles/p/a/0": drive("circles", True), "one/cells/p/a/0": drive("cells", False)}
    made = {
        "problems": {"one/first/p": problem} | moving,
        "workspaces": {"one/first/p": workspace, "one/circles/p": round_things},
    }
    row = ["One et al. (2000)", "1 / 1 / 1 of 3"]
    said = content.Headline(
        sentences=["Of 3 published numbers, 1 agrees."],
        columns=["paper", HOSTILE],
        rows={"one": row},
    )
    return content.Page(
        scale="smoke",
        about_scale=["Scale smoke is small."],
        headline=said,
        answer=answer.answer(own),
        studies=own,
        runs=runs,
        **made,
    )
