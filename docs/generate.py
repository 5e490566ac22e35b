"""A Sphinx extension that writes pages of the site before a build, into files that git ignores.
Their content follows from code, studies and results.

A page is a template: `templates/method.md.jinja` for a planner, `templates/paper.md.jinja` for a
paper, and every `*.in.md`. Texts on a planner or paper that are written by hand stand in `prose`.
"""

from __future__ import annotations

import inspect
import re
import shutil
from collections.abc import Collection
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
from bezierplan.schema import checked
from bezierplan.study.alternatives import describe_values

HERE = Path(__file__).parent
MOST_NAMED = 4
"""Methods named beside a value; of more, their number."""
BEHIND = ("alternatives", "logs", "problems", "readings", "runs", "*.log", "*.png", "*.txt")
"""Results that the site does not hold: the page of results has no link to them."""


def setup(app: Any) -> dict[str, bool]:
    """Register writer, copier and renderer of formulas; Sphinx calls this once."""
    app.connect("builder-inited", lambda app: write(Path(app.srcdir)))
    app.connect("build-finished", lambda app, fault: fault or copy_results(Path(app.outdir)))
    # MathML, which browsers draw by themselves.
    block = '<div class="equation" tabindex="0" role="group">{}</div>'
    app.add_html_math_renderer(
        "mathml", (partial(write_formula, "{}"), None), (partial(write_formula, block), None)
    )
    return {"parallel_read_safe": True}


def write_formula(around: str, writer: Any, node: Any) -> None:
    """Write a formula as MathML, with html around it."""
    text = latex2mathml.tex2mathml(node.astext(), as_block=around != "{}")
    writer.body.append(around.format(text))
    raise SkipNode


def copy_results(site: Path) -> None:
    """Copy the page of results into the site, with the files that it links to."""
    away = site / "results"
    shutil.rmtree(away, ignore_errors=True)
    shutil.copytree(content.find_results(), away, ignore=shutil.ignore_patterns(*BEHIND))


def write(folder: Path) -> None:
    """Write all generated pages below a folder."""
    page = content.read_content()
    environment = build.build_environment(content.find_results(), HERE / "templates", HERE)
    environment.filters |= {"cell": outcome.escape_cell, "words": describe_setting}
    planners = {name: describe_planner(name, page.studies, folder) for name in list_planners()}
    environment.globals |= {
        "page": page,
        "papers": page.studies,
        "planners": planners,
        "software": checked.read(content.CITATION),
        "numbers": reader.list_rows(pd.read_csv(OUTCOME / "numbers.csv")),
        "names": [*names.list_things((), names.NAMES)],
        "meaning": describe_values,
        "methods_by_family": outcome.build_methods_table(
            pd.read_csv(OUTCOME / "methods.csv"),
            {key: study.job for key, study in page.studies.items()},
        ),
        "value_of": describe_value,
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
        file = folder / name
        file.parent.mkdir(exist_ok=True)
        file.write_text(environment.get_template(template).render(values), encoding="utf-8")


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

    users: studies with their methods. papers: those whose proposed method it is. open, achieved,
    resting: entries of assumptions, rows of the table of methods, and claims, each with its study.
    """
    module, text = load_planner(name), content.read_prose(name)
    settings = read_settings(module)
    users = [(study, own) for study in studies.values() if (own := list_users(study, name))]
    papers = [each for each in users if each[0].definition.baseline_comparison.proposed in each[1]]
    (folder / "methods").mkdir(exist_ok=True)
    # First of the paper that proposes the method.
    drawn = (draw_run(*each, folder / "methods" / f"{name}.svg") for each in papers + users)
    return SimpleNamespace(
        name=name,
        title=text.partition("\n")[0].removeprefix("# "),
        lead=text,
        details=inspect.cleandoc(module.__doc__).replace("<", "&lt;"),
        maps=getattr(module, "workspaces", None),
        users=users,
        papers=papers,
        run=next(filter(None, drawn), None),
        settings=settings,
        open=[
            (study, row)
            for study, own in users
            for row in study.assumptions
            if row["setting"] in settings and {*own} & {*(row["methods"] or own)}
        ],
        achieved=[
            (study, row)
            for study, own in users
            for row in study.families.itertuples()
            if row[0] in {study.job.labels.get(each, each) for each in own}
        ],
        resting=[(study, claim) for study, own in users for claim in select_claims(study, own)],
    )


def list_users(study: SimpleNamespace, planner: str) -> list[str]:
    """List the methods of a study that use a planner."""
    return [name for name in study.definition.methods if study.definition.planner(name) == planner]


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


def select_claims(study: SimpleNamespace, methods: Collection[str]) -> list[Any]:
    """Return the claims of a study whose checks name one of some methods."""
    checks = {claim.id: repr(claim.checks) for claim in study.definition.claims}
    named = re.compile(rf"\b({'|'.join(methods)})\b")
    return [claim for claim in study.claims if named.search(checks[claim["id"]])]
