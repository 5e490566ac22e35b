"""A Sphinx extension that writes pages of the site before a build, into files that git ignores.
Their content follows from code, studies and results.

A page is a template: `templates/method.md.jinja` for a planner, `templates/paper.md.jinja` for a
paper, and every `*.in.md`. Texts on a planner or paper that are written by hand stand in `prose`.
"""

from __future__ import annotations

import inspect
import re
import shutil
from collections.abc import Callable, Collection, Iterable
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import content
import outcome
import pandas as pd
from docutils.nodes import SkipNode
from docutils.utils.math import latex2mathml

import bezierplan as bp
from bezierplan.commands import list as names
from bezierplan.figures.page import build, reader
from bezierplan.places import OUTCOME
from bezierplan.planners import list_planners, load_planner, read_settings
from bezierplan.study.alternatives import describe_values

HERE = Path(__file__).parent
MOST_NAMED = 4
"""Methods named beside a value; of more, their number."""
RESULTS = ("*.csv", "*.svg", "*.pdf", "*.tex", "*.html", "*.json")
"""Files of results that the site holds: what the page of results links to."""


def setup(app: Any) -> dict[str, bool]:
    """Register writer, copier and renderer of formulas; Sphinx calls this once."""
    app.connect("builder-inited", lambda app: write(Path(app.srcdir)))
    app.connect("build-finished", lambda app, fault: fault or copy_results(Path(app.outdir)))
    # MathML, which browsers draw by themselves.
    inline, block = (
        partial(write_formula, "{}"),
        '<div class="equation" tabindex="0" role="group">{}</div>',
    )
    app.add_html_math_renderer("mathml", (inline, None), (partial(write_formula, block), None))
    return {"parallel_read_safe": True}


def write_formula(around: str, writer: Any, node: Any) -> None:
    """Write a formula as MathML, with html around it."""
    text = latex2mathml.tex2mathml(node.astext(), as_block=around != "{}")
    writer.body.append(around.format(text))
    raise SkipNode


def copy_results(site: Path) -> None:
    """Copy the page of results into the site, with the files that it links to."""
    _, folder = content.find_results()
    shutil.rmtree(site / "results", ignore_errors=True)
    for depth in ("", "*/", "*/*/"):
        for file in (file for pattern in RESULTS for file in folder.glob(depth + pattern)):
            place = site / "results" / file.relative_to(folder)
            place.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(file, place)


def write(folder: Path) -> None:
    """Write all generated pages below a folder."""
    page, results = content.read_content()
    environment = build.build_environment(page, results, HERE / "templates", HERE)
    environment.filters |= {
        "as_row": lambda found: [found[0].name, *found[1]],
        "cell": escape_cell,
        "words": describe_setting,
        "name": outcome.format_name,
    }
    planners = {name: describe_planner(name, page.studies, folder) for name in list_planners()}
    environment.globals |= {
        "page": page,
        "papers": page.studies,
        "planners": planners,
        "references": {entry["key"]: entry for entry in content.list_citations()},
        "numbers": reader.list_rows(pd.read_csv(OUTCOME / "numbers.csv")),
        "names": [(heading, [*rows]) for heading, rows in names.list_things([], [*names.NAMES])],
        "meaning": describe_values,
        "methods_by_family": outcome.build_methods_table(
            pd.read_csv(OUTCOME / "methods.csv"),
            {key: study.job.labels for key, study in page.studies.items()},
        ),
        "table": format_table,
        "about": content.read_prose,
        "page_of": read_page,
        "origin_of_maps": read_origin_of_maps,
        "root": "../results/",
    }
    pages = {
        **{f"methods/{n}.md": ("method.md.jinja", {"planner": own}) for n, own in planners.items()},
        **{
            f"papers/{key}.md": ("paper.md.jinja", {"study": study, "key": key})
            for key, study in page.studies.items()
        },
        **{f"{kind}/index.md": (f"{kind}.md.jinja", {}) for kind in ("papers", "methods")},
        **{file.name.replace(".in", ""): (file.name, {}) for file in HERE.glob("*.in.md")},
    }
    for name, (template, values) in pages.items():
        text, file = environment.get_template(template).render(values), folder / name
        file.parent.mkdir(exist_ok=True)
        if not file.is_file() or file.read_text(encoding="utf-8") != text:
            file.write_text(text, encoding="utf-8")


def format_table(heads: list[str], rows: Iterable[Iterable[Any]]) -> str:
    """Return a table in Markdown from its heads and rows."""
    lines = ["| " + " | ".join(heads) + " |", "|" + " --- |" * len(heads)]
    lines += ["| " + " | ".join(escape_cell(cell) for cell in row) + " |" for row in rows]
    return "\n".join(lines) + "\n"


def escape_cell(value: Any) -> str:
    """Return a value as the text of a cell, in which a bar would end it."""
    return " ".join(str(value).replace("|", "\\|").split())


def describe_setting(value: Any) -> str:
    """Return the value of a setting in words.

    >>> describe_setting({"smooth": "piecewise_quadratic"}), describe_setting(True)
    ('piecewise quadratic (smooth)', 'yes')
    """
    if isinstance(value, dict):
        return ", ".join(f"{describe_setting(each)} ({name})" for name, each in value.items())
    if isinstance(value, list | tuple):
        return ", ".join(map(describe_setting, value))
    if isinstance(value, bool):
        return "yes" if value else "no"
    return "none" if value is None else str(value).replace("_", " ")


def select_rows(study: SimpleNamespace, methods: set[str]) -> list[Any]:
    """Return the rows of some methods in the table of a study's methods, the label first."""
    if study.families is None:
        return []
    labels = {study.job.labels.get(name, name) for name in methods}
    return [row for row in study.families.itertuples() if row[0] in labels]


def read_page(key: str) -> str:
    """Read the page of a paper that the repository keeps, without its title.

    Links lead to the site's pages, or to files of results.
    """
    text = (OUTCOME / f"{key}.md").read_text(encoding="utf-8").partition("\n")[2]
    text = re.sub(r"\]\((?:claims|numbers)\.csv\)", "](../results/index.html#KEY){.external}", text)
    # Files that the site has not are named without a link.
    text = re.sub(r"\[([^]]*)\]\((?:\.\./\.\./config|identified)[^)]*\)", r"\1", text)
    return text.replace("#KEY", f"#{key}")


def read_origin_of_maps(study: SimpleNamespace) -> str:
    """Read the text on where the maps of a study come from, if it has one, as a part of a page."""
    file = study.definition.folder / "workspaces" / "README.md"
    text = file.read_text(encoding="utf-8") if file.is_file() else ""
    lowered = re.sub(r"^(#+) ", r"#\1 ", re.sub(r"^# .*\n", "", text), flags=re.M)
    return re.sub(r"!?\[([^]]*)\]\((?!https?:)[^)]*\)", r"\1", lowered)


# --------------------------------------------------------------------------------------------------
# Methods


def describe_planner(
    name: str, studies: dict[str, SimpleNamespace], folder: Path
) -> SimpleNamespace:
    """Return the content of the page of a planner, and draw one of its runs below a folder.

    users: study -> its methods. algorithms: the studies whose plain Python it is. settings: rows.
    open, achieved, resting: entries of assumptions, rows of the table of methods, and claims, each
    with its study.
    """
    module, text = load_planner(name), content.read_prose(name)
    accepted = read_settings(module)
    users = {key: methods for key, study in studies.items() if (methods := list_users(study, name))}

    def collect(rows: Callable[[SimpleNamespace, set[str]], Iterable[Any]]) -> list[Any]:
        found = ((studies[key], rows(studies[key], set(users[key]))) for key in users)
        return [(study, row) for study, some in found for row in some]

    (folder / "methods").mkdir(exist_ok=True)
    picture = folder / "methods" / f"{name}.svg"
    # First of the paper that proposes the method.
    order = sorted(users, key=lambda key: find_algorithm(key) not in users[key])
    drawn = (draw_run(studies[key], users[key], picture) for key in order)
    return SimpleNamespace(
        name=name,
        title=text.partition("\n")[0].removeprefix("# "),
        lead=text,
        details=inspect.cleandoc(module.__doc__).replace("<", "&lt;"),
        maps=getattr(module, "workspaces", None),
        users=users,
        algorithms=[key for key in users if find_algorithm(key) in users[key]],
        run=next(filter(None, drawn), None),
        settings=[
            [
                f"`{setting}`",
                f"{declared.meaning} ({declared})",
                "; ".join(describe_value(studies[key], users[key], setting) for key in users),
            ]
            for setting, declared in accepted.items()
        ],
        open=collect(
            lambda study, methods: [
                row
                for row in study.assumptions
                if row["setting"] in accepted and methods & set(row["methods"] or methods)
            ]
        ),
        achieved=collect(lambda study, methods: select_rows(study, methods)),
        resting=collect(select_claims),
    )


def list_users(study: SimpleNamespace, planner: str) -> list[str]:
    """List the methods of a study that use a planner."""
    return [name for name in study.definition.methods if study.definition.planner(name) == planner]


def find_algorithm(key: str) -> str:
    """Find the method of a study whose plain Python `algorithms` has."""
    text = (HERE / "algorithms" / f"{key}.py").read_text(encoding="utf-8")
    return re.search(rf'^METHOD = "{key}/(\w+)"$', text, re.M)[1]


def draw_run(
    study: SimpleNamespace, methods: Collection[str], file: Path
) -> tuple[str, bp.Answer] | None:
    """Draw the first run with a free path, on a map that is in a file and does not change, of the
    first of some methods that has one; return its name and the answer.
    """
    own = study.definition
    for name, experiment in own.experiments.items():
        places = [each for each in experiment.problems if not own.workspace_of(each).drawn_kind]
        used = [method for method in experiment.methods if method in methods]
        if used and places and not own.moves(name) and not experiment.vary:
            for repeat in range(experiment.repeats["full"]):
                run = f"{study.key}/{name}/{places[0]}/{used[0]}/{repeat}"
                if (answer := bp.replay(run)).feasible:
                    answer.save(file)
                    return run, answer
    return None


def describe_value(study: SimpleNamespace, methods: list[str], setting: str) -> str:
    """Return the values of a setting in the methods of a study: one for all, or each with its
    methods.
    """
    given: dict[str, list[str]] = {}
    for method in methods:
        resolved = study.definition.resolve_settings(method)
        if setting in resolved:
            label = study.job.labels.get(method, describe_setting(method))
            given.setdefault(describe_setting(resolved[setting]), []).append(label)
    values = ", ".join(
        value
        if len(given) == 1
        else f"{value} ({', '.join(of) if len(of) <= MOST_NAMED else f'{len(of)} methods'})"
        for value, of in sorted(given.items(), key=lambda item: -len(item[1]))
    )
    return f"{study.name}: {values}" if values else ""


def select_claims(study: SimpleNamespace, methods: set[str]) -> list[Any]:
    """Return the claims of a study whose checks name one of some methods."""
    checks = {claim.id: claim.checks for claim in study.definition.claims}
    named = {name: set(re.findall(r"\w+", repr(own))) for name, own in checks.items()}
    return [claim for claim in study.claims if named[claim["id"]] & methods]
