"""A Sphinx extension: before a build it writes the pages of the site that follow from code, studies
and results, into files that git ignores, and runs the examples of all pages.

A page is a template: `templates/method.md.jinja` for a planner, `templates/paper.md.jinja` for a
paper, and every `*.in.md`. What is said of a planner or paper by hand stands in `prose`.
"""

from __future__ import annotations

import contextlib
import doctest
import inspect
import re
import shutil
import tempfile
from collections.abc import Iterable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import content
import pandas as pd
from docutils.utils.math import latex2mathml

from bezierplan.figures.page import answer, build
from bezierplan.planners import known_planners, planner_module, planner_settings
from bezierplan.study.alternatives import default_of

HERE = Path(__file__).parent
MOST_NAMED = 4
"""Methods named beside a value; of more, their number."""
RESULTS = ("*.csv", "*.svg", "*.pdf", "*.tex", "*.html", "*.json", "summary.md")
"""Files of results that the site holds: what the page of results links to."""


def setup(app: Any) -> dict[str, bool]:
    """Sphinx calls it once."""
    app.connect("builder-inited", lambda app: write(Path(app.srcdir)))
    app.connect("builder-inited", lambda app: try_examples(Path(app.srcdir)))
    app.connect("build-finished", lambda app, fault: fault or copy_results(Path(app.outdir)))
    # MathML, which browsers draw by themselves.
    app.add_html_math_renderer("mathml", (inline_math, None), (block_math, None))
    return {"parallel_read_safe": True}


def inline_math(writer: Any, node: Any) -> None:
    """Write a formula of a sentence."""
    writer.body.append(latex2mathml.tex2mathml(node.astext()))
    raise_skip()


def block_math(writer: Any, node: Any) -> None:
    """Write a formula of its own."""
    formula = latex2mathml.tex2mathml(node.astext(), as_block=True)
    writer.body.append(f'<div class="equation" tabindex="0" role="group">{formula}</div>')
    raise_skip()


def raise_skip() -> None:
    """Tell Sphinx that nothing is left of a node."""
    from docutils.nodes import SkipNode

    raise SkipNode


def copy_results(site: Path) -> None:
    """Put the page of results into the site, with the files that it links to."""
    _, folder = content.results()
    shutil.rmtree(site / "results", ignore_errors=True)
    for depth in ("", "*/", "*/*/"):
        for file in (file for pattern in RESULTS for file in folder.glob(depth + pattern)):
            place = site / "results" / file.relative_to(folder)
            place.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(file, place)


def write(folder: Path) -> None:
    """Write all generated pages below a folder."""
    page, results = content.content()
    environment = build.environment(page, results, HERE / "templates", HERE)
    environment.filters |= {"cell": escaped, "prose": prose, "demoted": demoted, "words": in_words}
    references = {entry["key"]: entry for entry in content.citations()}
    environment.globals |= {
        "page": page,
        "papers": page.studies,
        "planners": {name: planner(name, page) for name in known_planners()},
        "references": references,
        "number_example": number_example,
        "claim_example": claim_example,
        "numbers": pd.read_csv(content.OUTCOME / "numbers.csv"),
        "table": table,
        "by_map": [of_map(row) for row in answer.by_map(page.studies, page.data)],
        "maze": in_mazes(page.studies["elhoseny2017"]),
        "relative": lambda figure: f"../../results/{page.scale}/{figure['stem']}.svg",
        "root": "../results/",
        "methods_shown": {},
        "scale_words": scale_words(page),
        "about": content.about,
        "first_sentence": content.first_sentence,
        "kinds_of_maps": kinds_of_maps,
        "origin_of_maps": origin_of_maps,
        "achieved": achieved,
    }
    pages = {
        f"methods/{name}.md": ("method.md.jinja", {"planner": own})
        for name, own in environment.globals["planners"].items()
    }
    pages |= {
        f"papers/{key}.md": ("paper.md.jinja", {"study": study, "key": key})
        for key, study in page.studies.items()
    }
    pages |= {
        str(file.relative_to(HERE)).replace(".in.md", ".md"): (str(file.relative_to(HERE)), {})
        for file in HERE.rglob("*.in.md")
    }
    pages |= {f"{kind}/index.md": (f"{kind}.md.jinja", {}) for kind in ("papers", "methods")}
    for name, (template, values) in pages.items():
        text, file = environment.get_template(template).render(values), folder / name
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
    """A table in Markdown."""
    lines = ["| " + " | ".join(heads) + " |", "|" + " --- |" * len(heads)]
    lines += ["| " + " | ".join(escaped(cell) for cell in row) + " |" for row in rows]
    return "\n".join(lines) + "\n"


def escaped(value: Any) -> str:
    """A value as the text of a cell; a bar would end it."""
    return " ".join(str(value).replace("|", "\\|").split())


def prose(docstring: str | None) -> str:
    """A docstring as Markdown; its first line has no indent."""
    return inspect.cleandoc(docstring or "").replace("<", "&lt;")


def demoted(text: str) -> str:
    """A document without its title, whose headings are a level lower, and whose relative links are
    words only.
    """
    lowered = re.sub(r"^(#+) ", r"#\1 ", re.sub(r"^# .*\n", "", text), flags=re.M)
    return re.sub(r"!?\[([^]]*)\]\((?!https?:)[^)]*\)", r"\1", lowered)


def in_words(value: Any) -> str:
    """The value of a setting.

    >>> in_words({"smooth": "piecewise_quadratic"}), in_words(True), in_words(0.5)
    ('piecewise quadratic (smooth)', 'yes', '0.5')
    """
    if isinstance(value, dict):
        return ", ".join(f"{in_words(each)} ({name})" for name, each in value.items())
    if isinstance(value, list | tuple):
        return ", ".join(map(in_words, value))
    if isinstance(value, bool):
        return "yes" if value else "no"
    return "none" if value is None else str(value).replace("_", " ")


# --------------------------------------------------------------------------------------------------
# Methods


def planner(name: str, page: SimpleNamespace) -> SimpleNamespace:
    """What the page of a planner shows.

    title, lead: what is said of it by hand. users: study -> its methods. run: that of the picture,
    with problem and workspace, if there is one. settings, achieved, open, resting: rows.
    """
    module, about = planner_module(name), content.about(name)
    users = {
        key: [m for m in study.definition.methods if study.definition.planner(m) == name]
        for key, study in page.studies.items()
    }
    users = {key: methods for key, methods in users.items() if methods}
    return SimpleNamespace(
        name=name,
        title=about.partition("\n")[0].removeprefix("# "),
        lead=about,
        details=prose(module.__doc__),
        maps=getattr(module, "workspaces", None),
        users=users,
        algorithms=[key for key in users if algorithm_of(key, users[key])],
        run=typical_run(users, page),
        settings=[
            [
                f"`{setting}`",
                f"{declared.meaning} ({declared})",
                "; ".join(value_in(page.studies[key], users[key], setting) for key in users),
            ]
            for setting, declared in planner_settings(module).items()
        ],
        open=[
            (key, entry, in_words(default_of(page.studies[key].definition, entry)))
            for key in users
            for entry in page.studies[key].definition.assumptions
            if entry.setting in planner_settings(module)
            and (not entry.methods or set(entry.methods) & set(users[key]))
        ],
        achieved=[
            (key, row)
            for key in users
            for row in page.studies[key].baseline
            if row["method"] in users[key]
        ],
        resting=[(key, claim) for key in users for claim in resting(page.studies[key], users[key])],
    )


def algorithm_of(key: str, methods: list[str]) -> bool:
    """Whether `algorithms` has the plain Python of one of some methods of a study."""
    file = HERE / "algorithms" / f"{key}.py"
    found = re.search(rf'^METHOD = "{key}/(\w+)"$', file.read_text(encoding="utf-8"), re.M)
    return found[1] in methods


def typical_run(users: dict[str, list[str]], page: SimpleNamespace) -> SimpleNamespace | None:
    """The median run of the first method that has one on a world that does not move."""
    for key, methods in users.items():
        for each in page.studies[key].shown:
            name = each["median"]
            if name and each["problem"] and each["method"] in methods:
                run = page.data["runs"][name]
                problem = page.data["problems"][run["problem"]]
                if problem["world"] is None and run["path"]:
                    label = page.studies[key].job.labels.get(each["method"], each["method"])
                    workspace = page.data["workspaces"][problem["workspace"]]
                    return SimpleNamespace(
                        name=name, label=label, run=run, problem=problem, workspace=workspace
                    )
    return None


def value_in(study: SimpleNamespace, methods: list[str], setting: str) -> str:
    """The values of a setting in the methods of a study: one for all of them, or each with its
    methods.
    """
    given: dict[str, list[str]] = {}
    for method in methods:
        resolved = study.definition.resolved(method)
        if setting in resolved:
            given.setdefault(in_words(resolved[setting]), []).append(method)
    commonest = sorted(given.items(), key=lambda item: -len(item[1]))
    values = ", ".join(
        value
        if len(given) == 1
        else f"{value} ({', '.join(of) if len(of) <= MOST_NAMED else f'{len(of)} methods'})"
        for value, of in commonest
    )
    return f"{study.name}: {values}" if values else ""


def achieved(planner: SimpleNamespace) -> list[list[str]]:
    """How the methods of a planner compare with the rounded shortest path, in words."""

    def times(value: float | None) -> str:
        return "" if value is None else f"{value:.3g}"

    return [
        [
            content.name_of(key),
            f"`{row['method']}`",
            f"{100 * row['feasible']:.1f} %",
            times(row["length"]),
            "corners" if row["cornered"] else times(row["curvature"]),
            times(row["cpu"]),
        ]
        for key, row in planner.achieved
    ]


def resting(study: SimpleNamespace, methods: list[str]) -> list[dict[str, Any]]:
    """The claims of a study whose checks name one of some methods."""
    checks = {claim.id: claim.checks for claim in study.definition.claims}
    return [
        claim
        for claim in study.claims
        if set(re.findall(r"\w+", repr(checks[claim["id"]]))) & set(methods)
    ]


# --------------------------------------------------------------------------------------------------
# Papers and maps


def scale_words(page: SimpleNamespace) -> str:
    """Which runs stand behind what a paper's page shows."""
    if page.scale == content.SCALES[0]:
        return "Everything here is of scale extended, many runs of each method."
    return (
        "Numbers and verdicts are of scale extended, many runs of each method; figures, and why a "
        f"claim fails, of scale {page.scale}, with fewer."
    )


def kinds_of_maps(study: SimpleNamespace) -> list[list[str]]:
    """The workspaces of a study, each with its kind."""
    spaces = study.definition.workspaces
    return [[name, in_words(workspace.kind)] for name, workspace in spaces.items()]


def origin_of_maps(study: SimpleNamespace) -> str:
    """The text on where the maps of a study come from, if it has one."""
    origin = study.definition.folder / "workspaces" / "README.md"
    return demoted(origin.read_text(encoding="utf-8")) if origin.is_file() else ""


def of_map(row: dict[str, Any]) -> list[str]:
    """What to use on a kind of map (`answer.by_map`), in words."""
    best = row["best"]
    study, method = best["study"], best["method"]
    page = study.definition.planner(method)
    label = study.job.labels.get(method, method)
    return [
        f"{row['map']} ({', '.join(map(content.name_of, row['studies']))})",
        f"[{label}](methods/{page}.md), {study.name}",
        f"{100 * best['feasible']:.0f} %",
        "no free path" if best["gap"] > 1e9 else f"{100 * best['gap']:.1f} % above",
        "" if best["cpu"] is None else f"{best['cpu']:.2g} times",
    ]


def in_mazes(study: SimpleNamespace) -> str:
    """On how many of its six maps the proposed method of Elhoseny 2017 finds a free path."""
    rows = [
        row
        for row in study.shown
        if row["method"] == "mga" and row["experiment"] == "maps" and row["problem"]
    ]
    found = sum(row["feasible"] > 0 for row in rows)
    return f"MGA, for one, finds a free path on {found} of {len(rows)} of them"


# --------------------------------------------------------------------------------------------------
# Verdicts


def number_example(numbers: pd.DataFrame, verdict: str) -> str:
    """A verdict on a real number: the first one counted whose interval is finite."""
    chosen = numbers[numbers.counted & (numbers.verdict == verdict)]
    chosen = chosen[chosen.low95_predicted.abs().lt(1e9) & chosen.high95_predicted.abs().lt(1e9)]
    if chosen.empty:
        return "No number has this verdict."
    row = chosen.iloc[0]
    inside = row.low95_predicted <= row.value_published <= row.high95_predicted
    runs = "an unstated number of runs" if pd.isna(row.n_published) else f"{row.n_published:g} runs"
    return (
        f"*{content.name_of(row.study)}, {row.table}, {row.method}, {row.metric} "
        f"({row.statistic}).* The paper prints {row.value_published:g}, from {runs}. "
        f"Ours is {row.value_ours:.6g}, from {row.n_ours:g} runs. Experiments of the paper's size "
        f"would print {row.low95_predicted:.6g} to {row.high95_predicted:.6g}: the printed number "
        f"lies {'inside' if inside else 'outside'}."
    )


def claim_example(papers: dict[str, SimpleNamespace], verdict: str) -> str:
    """A verdict on a real claim: the first one of a paper, if possible one that says why."""
    chosen = [
        (study, claim)
        for study in papers.values()
        for claim in answer.sentences_of_paper(study)
        if claim["verdict"] == verdict
    ]
    if not chosen:
        return "No claim has this verdict."
    study, claim = min(chosen, key=lambda each: not each[1]["why"])
    told = " ".join(filter(None, [claim["why"], claim["reason"]]))
    return (
        f"*[{study.name} {claim['id']}](papers/{study.key}.md): {claim['statement']}* "
        f"{claim['rule'] or ''}. {told}"
    )
