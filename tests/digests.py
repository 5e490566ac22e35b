"""Digests of what the studies make: whatever a change makes of a scenario, a path, a table or a
figure shows. `make digests` writes them anew, in a commit that says why they change.

Times differ from machine to machine and are left out. Of derived numbers six digits stay: the last
bits of a library differ too.
"""

import hashlib
import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from studies import studies

from bezierplan.analysis.stored_runs import compute_table_digest, list_run_tables
from bezierplan.places import TREE
from bezierplan.running import execution, problems
from bezierplan.running.columns import DriveTimes, Times
from bezierplan.study import jobs
from bezierplan.study.definition import Study
from bezierplan.workspaces import files, worlds

SCALES = ("smoke", "full")
TIMES = {*Times._fields, *DriveTimes._fields} - {"id"}
DRAWN = ("value", "low95", "high95", "x")
"""Columns of a figure's data that hold its metric."""

Digests = dict[tuple[str, str, str], str]
"""By study, kind and name."""


def kept_file(scale: str) -> Path:
    """Return the file of the digests that the project keeps of a scale."""
    return Path(__file__).parent / "data" / f"digests_{scale}.csv"


def read_kept(scale: str) -> Digests:
    """Read the digests that the project keeps of a scale."""
    table = pd.read_csv(kept_file(scale), keep_default_na=False)
    return table.set_index(["study", "kind", "name"])["digest"].to_dict()


def digest(part: pd.DataFrame) -> str:
    """Return the digest of the text of a table."""
    text = part.to_csv(index=False, float_format="%.6g", lineterminator="\n")
    return hashlib.sha256(text.encode()).hexdigest()[:12]


def find(scale: str) -> Digests:
    """Return the digests of a scale: of scale smoke also of the scenarios, settings and first runs
    of all experiments, which no file of results holds; of another of all its runs, bounds and
    claims.
    """
    folder, found = TREE / "results" / scale, {}
    for key, study in studies().items():
        parts = {**tables(folder / key), **figures(study, folder / key)}
        parts |= scenarios(study) | settings(study) if scale == "smoke" else results(folder / key)
        found |= {(key, *name): digest(part) for name, part in parts.items()}
    if scale != "smoke":
        for name, chunks in list_run_tables(folder).items():
            key, _, table = name.partition("/")
            found[key, "runs", table] = compute_table_digest(chunks)
    return found


Parts = dict[tuple[str, str], pd.DataFrame]


def scenarios(study: Study) -> Parts:
    """Return the problems of each experiment of a study, and the settings of each of its methods
    under each condition with the path of its first run.
    """
    found: Parts = {}
    for name in study.experiments:
        described = jobs.build_problems_job(study, name, "smoke")
        made, moving = problems.build_all(described, study.folder)
        found["problems", name] = pd.DataFrame(
            [
                [key, *each.start, *each.target, files.write_json(each.workspace), drawn_world]
                for key, each in made.items()
                for drawn_world in [worlds.to_json(moving[key]) if moving else ""]
            ]
        )
        for method in study.methods_of(name):
            chunk = jobs.build_chunk(study, name, method, "smoke", 0)
            first, *others = ((each, chunk.repeats[0]) for each in chunk.conditions())
            (run,) = execution.make_rows_again(chunk, [first], made, moving)
            planned = [execution.identify_run(chunk, *each) for each in others]
            found["first run", f"{name}/{method}"] = _plain(pd.DataFrame([run, *planned]))
    return found


def settings(study: Study) -> Parts:
    """Return what a study's files say of experiments, of panels and of the baseline's comparison:
    some of it shows at another scale alone, or in no data of a figure.
    """
    said: dict[tuple[str, str], Any] = {
        ("settings", name): [each.plain(), [study.problems[key].plain() for key in each.problems]]
        for name, each in study.experiments.items()
    }
    for name, figure in study.figures.items():
        said["panels", name] = [panel.plain() for panel in figure.panels]
    if study.baseline_comparison:
        said["settings", "baseline_comparison"] = study.baseline_comparison.plain()
    return {
        place: pd.DataFrame([json.dumps(each, sort_keys=True, default=str)])
        for place, each in said.items()
    }


def tables(folder: Path) -> Parts:
    """Return the tables of a study's results, by metric where they stand beside printed numbers."""
    found: Parts = {}
    for file in sorted(folder.glob("*/*.comparison.csv")):
        table = pd.read_csv(file)
        keys = table.columns[: table.columns.get_loc("unit")]
        numbers = table.loc[~table["unit"].isin(["s", "ms"]), [*keys, "n_ours", "value_ours"]]
        for metric, rows in numbers.groupby("metric"):
            found["table", f"{file.name.partition('.')[0]}/{metric}"] = rows
    for file in sorted(folder.glob("*/table?.csv")):
        if not file.with_suffix(".comparison.csv").exists():
            found["table", file.stem] = pd.read_csv(file)
    return found


def figures(study: Study, folder: Path) -> Parts:
    """Return the data of the figures of a study's results."""
    found: Parts = {}
    for file in sorted(folder.glob("*/figure*.csv")):
        if (spec := study.figures.get(file.stem)) is None:
            continue
        table = pd.read_csv(file, low_memory=False)
        timed = [
            number
            for number, panel in enumerate(spec.panels)
            if any(isinstance(word, str) and word in TIMES for word in panel.plain().values())
        ]
        shown = [name for name in DRAWN if name in table]
        table[shown] = table[shown].mask(table["panel"].isin(timed))
        found["figure", file.stem] = table
    return found


def results(folder: Path) -> Parts:
    """Return the problems, bounds and claims of a study's results."""
    found: Parts = {}
    for file in sorted(folder.glob("problems/*.parquet")):
        name, _, kind = file.stem.partition(".")
        found[kind or "problems", name] = _plain(pd.read_parquet(file))
    for name in ("claims", "claim_checks"):
        table = pd.read_csv(folder / f"{name}.csv")
        found["claims", name] = table[~table["timed"]]
    return found


def _plain(table: pd.DataFrame) -> pd.DataFrame:
    """Give lists of numbers six digits as well."""
    return table.map(
        lambda cell: (
            " ".join(f"{number:.6g}" for number in cell)
            if isinstance(cell, list | np.ndarray)
            else cell
        )
    )


def main(scales: list[str]) -> None:
    """Write the digests of scales anew, and print which of them are others now."""
    for scale in scales or SCALES:
        kept, found = read_kept(scale) if kept_file(scale).exists() else {}, find(scale)
        rows = [(*place, each) for place, each in found.items()]
        table = pd.DataFrame(rows, columns=["study", "kind", "name", "digest"])
        table.to_csv(kept_file(scale), index=False, lineterminator="\n")
        others = sorted(place for place in kept | found if kept.get(place) != found.get(place))
        print(*(f"{scale}: {' '.join(place)}" for place in others), sep="\n")
        print(f"{scale}: {len(others)} of {len(found)} digests are others")


if __name__ == "__main__":
    main(sys.argv[1:])
