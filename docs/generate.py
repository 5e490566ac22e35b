"""Pages of the documentation that follow from the code, the studies' files and the kept outcome:
one a method, one a paper; and the examples of all pages, which are run.

A Sphinx extension: the pages are written when a build begins, into folders that git ignores.
"""

from __future__ import annotations

import contextlib
import doctest
import inspect
import re
import tempfile
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pandas as pd

HERE = Path(__file__).parent
OUTCOME = HERE / "outcome"
MOST_NAMED = 4
"""Methods named beside a value; of more, their number."""


def setup(app: Any) -> dict[str, bool]:
    """Sphinx calls it once."""
    app.connect("builder-inited", lambda app: write(Path(app.srcdir)))
    app.connect("builder-inited", lambda app: try_examples(Path(app.srcdir)))
    return {"parallel_read_safe": True}


def write(folder: Path) -> None:
    """Write all generated pages below a folder."""
    from bezierplan.commands import studies_of
    from bezierplan.planners import known_planners

    studies = studies_of()
    claims, baseline_comparison = (
        pd.read_csv(OUTCOME / "claims.csv"),
        pd.read_csv(OUTCOME / "baseline_comparison.csv"),
    )
    numbers = pd.read_csv(OUTCOME / "numbers.csv")
    pages = {
        f"methods/{name}.md": method_page(name, studies, claims, baseline_comparison)
        for name in known_planners()
    }
    pages["methods/index.md"] = methods_index(studies)
    pages |= {
        f"papers/{key}.md": paper_page(study, claims, numbers) for key, study in studies.items()
    }
    pages |= {
        "papers/index.md": papers_index(studies),
        "verdicts.md": verdicts_page(claims, numbers),
    }
    for name, text in pages.items():
        file = folder / name
        file.parent.mkdir(exist_ok=True)
        if not file.is_file() or file.read_text(encoding="utf-8") != text:
            file.write_text(text, encoding="utf-8")


def try_examples(folder: Path) -> None:
    """Run the examples of all pages, each page in a folder of its own; what they print must be what
    stands there, or the build warns.
    """
    from sphinx.util.logging import getLogger

    for page in sorted(folder.rglob("*.md")):
        said = failures(page)
        if said:
            getLogger(__name__).warning(
                "an example prints something else\n%s", said, location=str(page.relative_to(folder))
            )


def failures(page: Path) -> str:
    """What the examples of a page print where that differs from what the page says; empty if
    nothing does.
    """
    blocks = re.findall(
        r"^```python\n(>>> .*?)^```$", page.read_text(encoding="utf-8"), flags=re.M | re.S
    )
    test = doctest.DocTestParser().get_doctest("".join(blocks), {}, page.name, str(page), 0)
    said: list[str] = []
    with tempfile.TemporaryDirectory() as place, contextlib.chdir(place):
        doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE).run(test, out=said.append)
    return "".join(said)


# --------------------------------------------------------------------------------------------------
# Markdown


def table(heads: list[str], rows: Iterable[Iterable[Any]]) -> str:
    """A table in Markdown; a bar in a cell would end it."""
    lines = ["| " + " | ".join(heads) + " |", "|" + " --- |" * len(heads)]
    lines += ["| " + " | ".join(escaped(cell) for cell in row) + " |" for row in rows]
    return "\n".join(lines) + "\n"


def escaped(value: Any) -> str:
    """A value as the text of a cell."""
    if isinstance(value, float):
        return "" if pd.isna(value) else f"{value:.4g}"
    return " ".join(str(value).replace("|", "\\|").split())


def prose(docstring: str | None) -> str:
    """A docstring as Markdown; its first line has no indent."""
    return inspect.cleandoc(docstring or "").replace("<", "&lt;")


# --------------------------------------------------------------------------------------------------
# Methods


def method_page(
    name: str, studies: dict, claims: pd.DataFrame, baseline_comparison: pd.DataFrame
) -> str:
    """The page of a planner: what it is, its settings, what it leaves open, what it achieves, and
    which claims rest on it.
    """
    from bezierplan.planners import planner_module

    module = planner_module(name)
    users = {
        key: [m for m in study.methods if study.planner(m) == name]
        for key, study in studies.items()
    }
    users = {key: methods for key, methods in users.items() if methods}
    title, _, rest = prose(module.__doc__).partition("\n\n")
    served = getattr(module, "workspaces", None)
    parts = [
        f"# {name}\n",
        f"{title}\n",
        f"{rest}\n",
        f"*Maps:* {', '.join(served) if served else 'every kind'}.\n",
    ]
    parts += [algorithm(name, studies)]
    parts += ["## Call it\n", call(name, users, studies)]
    parts += ["## Settings\n", settings_table(name, module, users, studies)]
    parts += [
        left_open(name, users, studies),
        achieved(users, studies, baseline_comparison),
        resting(users, studies, claims),
    ]
    parts += [
        "## Code\n",
        f"`src/bezierplan/planners/{name}.py`: {{py:func}}`bezierplan.planners.{name}.plan`\n",
    ]
    parts += [f"```{{eval-rst}}\n.. autofunction:: bezierplan.planners.{name}.plan\n```\n"]
    return "\n".join(part for part in parts if part)


def algorithm(name: str, studies: dict) -> str:
    """The algorithms of `docs/algorithms` that a planner's kernels compute."""
    shown = ""
    for key, study in studies.items():
        file = HERE / "algorithms" / f"{key}.py"
        method = re.search(rf'^METHOD = "{key}/(\w+)"$', file.read_text(encoding="utf-8"), re.M)
        if study.planner(method[1]) == name:
            shown += (
                "## The algorithm on one page\n\nThe default reading of the paper in plain Python; "
                f"a test compares its paths with those of `{key}/{method[1]}`, bit for bit.\n\n"
                f"```{{literalinclude}} ../algorithms/{key}.py\n:language: python\n```\n"
            )
    return shown


def call(name: str, users: dict[str, list[str]], studies: dict) -> str:
    """How to run a planner from Python and at the command line."""
    if not users:
        method = name
    else:
        key = next(iter(users))
        method = f"{key}/{users[key][0]}"
    return (
        f"```python\nimport bezierplan as bp\n\nanswer = bp.plan(problem, {method!r}, "
        "seed=1)\n```\n\n"
        f"```sh\nbezierplan plan map.yaml --start 1,1 --target 9,9 --method {method}\n```\n"
    )


def settings_table(name: str, module: Any, users: dict[str, list[str]], studies: dict) -> str:
    """Each setting with its meaning, range, unit and source, and its value in each study."""
    from bezierplan.planners import planner_settings

    accepted = planner_settings(module)
    if not accepted:
        return "It has none.\n"
    heads = ["setting", "meaning", "values", *(f"in {key}" for key in users)]
    rows = [
        [
            f"`{name}`",
            declared.meaning,
            str(declared),
            *(value_in(studies[key], users[key], name) for key in users),
        ]
        for name, declared in accepted.items()
    ]
    return table(heads, rows)


def value_in(study: Any, methods: list[str], setting: str) -> str:
    """The values of a setting in the methods of a study: one for all of them, or each with its
    methods.
    """
    given: dict[str, list[str]] = {}
    for method in methods:
        value = study.resolved(method).get(setting)
        if value is not None:
            given.setdefault(f"`{value}`", []).append(method)
    if len(given) == 1:
        return next(iter(given))
    commonest = sorted(given.items(), key=lambda item: -len(item[1]))
    return "; ".join(
        f"{value} ({', '.join(of) if len(of) <= MOST_NAMED else f'{len(of)} methods'})"
        for value, of in commonest
    )


def left_open(name: str, users: dict[str, list[str]], studies: dict) -> str:
    """The entries of `assumptions.yaml` about settings of a planner."""
    from bezierplan.planners import planner_module, planner_settings

    accepted = planner_settings(planner_module(name))
    rows = [
        [
            key,
            entry.id,
            entry.detail,
            f"`{entry.default}`",
            ", ".join(f"`{value}`" for value in entry.alternatives),
            entry.reason,
        ]
        for key in users
        for entry in studies[key].assumptions
        if entry.setting in accepted
    ]
    if not rows:
        return ""
    heads = ["study", "entry", "detail", "default", "alternatives", "reason"]
    return "## What the paper leaves open\n\n" + table(heads, rows)


def achieved(users: dict[str, list[str]], studies: dict, baseline_comparison: pd.DataFrame) -> str:
    """How the methods of a planner compare with the rounded shortest path."""
    mine = baseline_comparison[
        [row.method in users.get(row.study, []) for row in baseline_comparison.itertuples()]
    ]
    if mine.empty:
        return ""
    rows = [
        [row.study, row.method, row.feasible, row.length, row.curvature, row.cpu]
        for row in mine.itertuples()
    ]
    heads = ["study", "method", "feasible runs", "length", "largest curvature", "CPU time"]
    return (
        "## What it achieves\n\nLength, curvature and CPU time are ratios to those of the "
        "baseline, the exact shortest path with rounded "
        "corners, in the median condition of its study.\n\n" + table(heads, rows)
    )


def resting(users: dict[str, list[str]], studies: dict, claims: pd.DataFrame) -> str:
    """The claims whose checks name a method of a planner."""
    rows = []
    for key, methods in users.items():
        verdicts = claims[(claims.study == key) & claims.primary].set_index("id")
        for claim in studies[key].claims:
            named = set(re.findall(r"\w+", repr(claim.checks)))
            if named & set(methods) and claim.id in verdicts.index:
                rows.append([key, claim.id, claim.statement, verdicts.loc[claim.id, "verdict"]])
    return (
        "## Claims about it\n\n" + table(["study", "claim", "sentence", "verdict"], rows)
        if rows
        else ""
    )


def methods_index(studies: dict) -> str:
    """The list of all planners, by what they are for."""
    from bezierplan.planners import known_planners, planner_module

    rows = []
    for name in known_planners():
        summary = prose(planner_module(name).__doc__).partition("\n\n")[0]
        used = [
            key
            for key, study in studies.items()
            if any(study.planner(m) == name for m in study.methods)
        ]
        rows.append(
            [
                f"[{name}]({name}.md)",
                summary,
                ", ".join(f"[{key}](../papers/{key}.md)" for key in used),
            ]
        )
    hidden = "\n".join(known_planners())
    return (
        "# Methods\n\nEach planner is one file of `src/bezierplan/planners`. A study's method is "
        "a planner with settings.\n\n"
        + table(["planner", "what it is", "used in"], rows)
        + f"\n```{{toctree}}\n:hidden:\n\n{hidden}\n```\n"
    )


# --------------------------------------------------------------------------------------------------
# Papers


def paper_page(study: Any, claims: pd.DataFrame, numbers: pd.DataFrame) -> str:
    """The page of a paper: its citation, its claims and numbers with their verdicts, and what it
    leaves open.
    """
    own = claims[(claims.study == study.key) & claims.primary]
    counted = numbers[(numbers.study == study.key) & numbers.counted]
    counts = counted.verdict.value_counts()
    parts = [f"# {study.key}\n", f"{study.title}.\n", citation(study.key)]
    parts += [
        "## Published numbers\n",
        "Compared at scale `extended`.\n",
        table(["verdict", "numbers"], counts.items()),
    ]
    rows = [
        [row.id, row.place, row.statement, row.verdict, row.holds]
        for row in own[~own.finding].itertuples()
    ]
    parts += [
        "## Claims\n",
        table(
            ["claim", "place", "sentence, in our words", "verdict", "comparisons that agree"], rows
        ),
    ]
    found = [[row.id, row.statement, row.verdict] for row in own[own.finding].itertuples()]
    if found:
        parts += ["## Findings of our own\n", table(["finding", "sentence", "verdict"], found)]
    open_details = [
        [e.id, e.detail, f"`{e.default}`", ", ".join(f"`{v}`" for v in e.alternatives), e.source]
        for e in study.assumptions
    ]
    parts += [
        "## What the paper leaves open\n",
        table(["entry", "detail", "default", "alternatives", "source"], open_details),
    ]
    parts += [
        "## Tables and figures\n",
        artefacts(study),
        "## Maps\n",
        maps(study),
    ]
    return "\n".join(parts)


def artefacts(study: Any) -> str:
    """Every table and figure with its target."""
    rows = [
        [f"`snakemake {study.key}_{name}`", item.title]
        for kind in (study.tables, study.figures)
        for name, item in kind.items()
    ]
    return table(["target", "title"], rows)


def maps(study: Any) -> str:
    """A study's workspaces, and the text on where they come from, if it has one."""
    text = table(
        ["workspace", "kind"],
        [[name, workspace.kind] for name, workspace in study.workspaces.items()],
    )
    origin = study.folder / "workspaces" / "README.md"
    return text + ("\n" + demoted(origin.read_text(encoding="utf-8")) if origin.is_file() else "")


def demoted(text: str) -> str:
    """A document whose headings are two levels lower, and whose relative links are words only."""
    lowered = re.sub(r"^(#+) ", r"##\1 ", text, flags=re.M)
    return re.sub(r"!?\[([^]]*)\]\((?!https?:)[^)]*\)", r"\1", lowered)


def citation(key: str) -> str:
    """A paper as CITATION.cff lists it."""
    import yaml

    content = yaml.safe_load((HERE.parent / "CITATION.cff").read_text(encoding="utf-8"))
    entry = next(
        (each for each in content["references"] if each.get("notes", "").startswith(key)), None
    )
    if entry is None:
        return ""
    names = ", ".join(
        f"{author['given-names']} {author['family-names']}" for author in entry["authors"]
    )
    where = "".join(f", {entry[name]}" for name in ("journal", "year") if name in entry)
    doi = f", [doi:{entry['doi']}](https://doi.org/{entry['doi']})" if "doi" in entry else ""
    return f"{names}: *{entry['title']}*{where}{doi}.\n"


def papers_index(studies: dict) -> str:
    """The list of the papers."""
    rows = [[f"[{key}]({key}.md)", study.title] for key, study in studies.items()]
    hidden = "\n".join(studies)
    return (
        "# Papers\n\n"
        + table(["study", "paper"], rows)
        + f"\n```{{toctree}}\n:hidden:\n\n{hidden}\n```\n"
    )


# --------------------------------------------------------------------------------------------------
# Verdicts


def numbers_example(numbers: pd.DataFrame, verdict: str) -> str:
    """A worked example of a verdict on a number: the first one counted whose interval is finite."""
    chosen = numbers[numbers.counted & (numbers.verdict == verdict)]
    chosen = chosen[chosen.low95_predicted.abs().lt(1e9) & chosen.high95_predicted.abs().lt(1e9)]
    if chosen.empty:
        return ""
    row = chosen.iloc[0]
    inside = row.low95_predicted <= row.value_published <= row.high95_predicted
    runs = "an unstated number of runs" if pd.isna(row.n_published) else f"{row.n_published:g} runs"
    return (
        f"*{row.study}, {row.table}, {row.method}, {row.metric} ({row.statistic}).* The paper "
        f"prints {row.value_published:g}, from {runs}. "
        f"Ours is {row.value_ours:.6g}, from {row.n_ours:g} runs. Experiments of the paper's size "
        f"would print {row.low95_predicted:.6g} to "
        f"{row.high95_predicted:.6g}: the printed number lies "
        f"{'inside' if inside else 'outside'}.\n"
    )


def claims_example(claims: pd.DataFrame, verdict: str) -> str:
    """A worked example of a verdict on a claim: the first one of a paper."""
    chosen = claims[claims.primary & ~claims.finding & (claims.verdict == verdict)]
    if chosen.empty:
        return ""
    row = chosen.iloc[0]
    effect = ""
    if not pd.isna(row.low95):
        effect = (
            f" The deciding comparison has an effect of {row.effect:.4g}, with a 95 % "
            f"interval from {row.low95:.4g} to {row.high95:.4g}."
        )
    holds = (
        f" {row.holds} comparisons "
        f"agree{'' if pd.isna(row.where_it_holds) else f': {row.where_it_holds}'}."
        if isinstance(row.holds, str)
        else ""
    )
    return f"*{row.study} {row.id}: {row.statement}*{holds}{effect}\n"


def verdicts_page(claims: pd.DataFrame, numbers: pd.DataFrame) -> str:
    """How verdicts are reached, each with an example from the kept outcome."""
    text = (HERE / "verdicts.in.md").read_text(encoding="utf-8")
    text = re.sub(r"\{number: ([^}]*)\}", lambda found: numbers_example(numbers, found[1]), text)
    return re.sub(r"\{claim: ([^}]*)\}", lambda found: claims_example(claims, found[1]), text)
