"""`python -m bezierplan verify`: results follow from studies and runs, and every edit of them is
named.
"""

import contextlib
import json
import random
import re
import shutil
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as parquet
import pytest
import starts
from chunks import CHUNK, CLAIMS, MADE
from commands import call
from test_recheck import edited
from trees import edit

from bezierplan.analysis.outcome import verification
from bezierplan.machine import digest
from bezierplan.places import TREE
from bezierplan.running import execution, recheck, table_files
from bezierplan.running.jobs.watchdog import PlannerFailure
from bezierplan.study import stored

pytestmark = pytest.mark.usefixtures("workflows_are_forks")

BEND = """
import numpy as np
from bezierplan.geometry import curves
from bezierplan.planners import Path, Plan
from place import MIDDLE

workspaces = ("circles",)

def plan(problem, rng):
    {seed}
    middle = [0.0, MIDDLE + rng.normal(0, 0.1)]
    path = Path("bezier", np.array([problem.start, middle, problem.target]))
    length = curves.length(path)
    return Plan(path, length, claimed_feasible=True, evaluations=1, history=np.array([length]),
                stop="one", extra={{}})
"""
STUDY = {
    "experiments.yaml": """
title: A bend round a disc
methods: {bend: {planner: bend.py}, line: {planner: straight_line}}
settings: {}
workspaces: {disc: {kind: circles, unit: m, bounds: [-5, 5, -5, 5], circles: [[0, 0, 1]]}}
problems: {across: {workspace: disc, start: [-4, 0], target: [4, 0]}}
experiments:
  bends: {problems: [across], methods: [bend, line], repeats: {smoke: 6, full: 6, extended: 6},
    chunk: {smoke: 3, full: 3, extended: 3}}
""",
    "artefacts.yaml": """
tables:
  table1: {title: Lengths, kind: pivot, experiment: bends, published: lengths.csv, index: [method],
    columns: [value], values: [{metric: length, statistic: mean, label: length, decimals: 2}]}
figures:
  figure1: {title: Lengths, columns: 1, panels: [
    {kind: boxes, experiment: bends, metric: length}]}
""",
    "claims.yaml": CLAIMS,
    "published/lengths.csv": "method,metric,statistic,n,unit,value\nbend,length,mean,6,m,10.0\n",
}
RUNS = "bend/runs/bends/bend/0.parquet"


@pytest.fixture(scope="module")
def original(tmp_path_factory):
    """The folder of the study `bend`, with its results."""
    folder = tmp_path_factory.mktemp("verified")
    study = folder / "bend"
    (study / "published").mkdir(parents=True)
    code = {"bend.py": BEND.format(seed=""), "place.py": "MIDDLE = 5.0\n"}
    for name, text in (STUDY | code).items():
        (study / name).write_text(text)
    done = starts.make(folder, "bend", "smoke")
    assert done.returncode == 0, done.stdout + done.stderr
    return folder


@pytest.fixture
def results(original, tmp_path):
    """The folder of a scale, as the workflow made it."""
    shutil.copytree(original, tmp_path, dirs_exist_ok=True)
    with contextlib.chdir(tmp_path):
        yield Path("results/smoke")


def verified(capsys, *words):
    """The status of the command, and the lines that it printed, and those about faults."""
    for known in vars(digest).values():
        getattr(known, "cache_clear", int)()  # as in a process of its own
    return call(capsys, "verify", *words, "--cores", 1)


def listed(folder, name):
    """Give the list of digests that of a file as it is now."""
    file = folder / "verified.json"
    content = json.loads(file.read_text())
    content["sha256"][name] = recheck.compute_sha256(folder / name)
    recheck.write(content, str(file))


def unlisted(folder):
    """Take the page away, and the list of digests that it needs."""
    for name in ("index.html", "verified.json"):
        (folder / name).unlink()


def test_each_edit_of_one_byte_is_named(tmp_path):
    """Of files of each kind of the small subset, which `make test` makes before the tests, at any
    place; the page is no file of the list.
    """
    made = TREE / "results" / "smoke"
    assert (made / "verified.json").is_file(), "run snakemake smoke first"
    shutil.copytree(made, tmp_path / "smoke", ignore=shutil.ignore_patterns("logs"))
    folder = tmp_path / "smoke"
    named = json.loads((folder / "verified.json").read_text())["sha256"]
    draw = random.Random(1)
    kinds: dict[str, list[Path]] = {}
    for name in sorted(named):
        kinds.setdefault(name.partition(".")[2], []).append(folder / name)
    for file in [file for files in kinds.values() for file in draw.sample(files, 3)]:
        content = file.read_bytes()
        place = draw.randrange(len(content))
        other = draw.choice([byte for byte in range(256) if byte != content[place]])
        file.write_bytes(content[:place] + bytes([other]) + content[place + 1 :])
        listed = verification.read_list(folder)
        assert [fault.file for fault in verification.find_changed_files(folder, listed)] == [
            str(file)
        ], place
        file.write_bytes(content)
    assert verification.find_changed_files(folder, verification.read_list(folder)) == []


def test_a_study_of_ones_own_is_found_here_or_where_it_is_said_to_lie(results, tmp_path, capsys):
    Path("bend").rename(tmp_path / "away")
    status, _, told = verified(capsys, results)
    assert (status, told) == (
        2,
        [
            f"{results / 'bend'}: no study bend in config/config.yaml or here; say where it lies: "
            "--studies FOLDER/bend"
        ],
    )
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "away").rename(tmp_path / "elsewhere/bend")
    places = stored.read_places(results, {"studies": ["song2016"]}, ["elsewhere/bend"])
    assert places == {"bend": "elsewhere/bend"}


def test_a_list_that_is_none_and_a_missing_file_are_told_and_the_proof_goes_on(results, capsys):
    (results / RUNS).unlink()
    status, lines, _ = verified(capsys, results)
    assert (status, lines[0]) == (1, f"{results / RUNS}: is not there")
    assert lines[-1].endswith("; made by this code")
    (results / "verified.json").rename(results / "bend/kept.json")
    status, lines, _ = verified(capsys, results)
    assert (status, lines[0]) == (1, f"{results}/verified.json: is not there, though a page is")
    assert f"{results}/bend/kept.json: nothing makes it; delete it" in lines
    (results / "verified.json").write_text("{")
    status, lines, _ = verified(capsys, results)
    assert (status, lines[0]) == (1, f"{results}/verified.json: not a list of digests")


def test_a_claim_or_a_bound_that_was_edited_together_with_the_list_is_named(results, capsys):
    """And so are the list, of which the page has the digest, and the page, which no list has."""
    bounds, claims = "bend/problems/bends.bounds.parquet", "bend/claims.csv"
    edited(results / bounds, "bound", lambda value: value + 0.1)
    listed(results, bounds)
    edit(results / claims, "shorter", "longer")
    listed(results, claims)
    edit(results / "index.html", "numba", "number")
    status, lines, _ = verified(capsys, results)
    assert status == 1
    assert lines[0] == f"{results}/verified.json: not the list that index.html names"
    for name in (bounds, claims, "index.html"):
        assert f"{results / name}: made again, it is another one" in lines


def test_other_code_that_makes_the_same_is_told_and_sound(results, capsys):
    """Here of a module that the planner imports; code that makes other runs is not."""
    Path("bend/place.py").write_text("MIDDLE = 1 / 10 * 50\n")
    status, lines, _ = verified(capsys, results)
    assert status == 0
    assert lines[-1] == (
        "made by other code or libraries (code): 3 runs and 19 files made again, all equal"
    )
    Path("bend/place.py").write_text("MIDDLE = 4.9\n")
    status, lines, _ = verified(capsys, results)
    assert status == 1
    name = f"{results}/{RUNS}"
    assert any(line.startswith(f"{name}: bend/bends/across/bend/0: ") for line in lines)
    assert lines[-1] == "differs: 2 files; made by other code or libraries (code)"


def test_an_experiment_that_is_another_one_now_is_named_by_its_file(results, capsys):
    file = Path("bend/experiments.yaml")
    edit(file, "start: [-4, 0]", "start: [-4, 1]")
    status, lines, _ = verified(capsys, results)
    assert status == 1
    assert any(line.startswith(f"{results}/bend/problems/bends.parquet: ") for line in lines)
    file.write_text(file.read_text().replace("across", "along"))
    status, lines, _ = verified(capsys, results)
    assert lines[0] == (
        "bend/experiments.yaml: experiment bends is another one than that of these runs: "
        f"{results}/bend/runs/bends"
    )
    assert status == 1


def test_all_but_files_that_nothing_makes_are_proven(results, capsys):
    """Of a table, a figure, an experiment, a method and a chunk that are no more, and of nothing;
    and all runs can be made again.
    """
    named = json.loads((results / "verified.json").read_text())["sha256"]
    unnamed = {str(file.relative_to(results)) for file in results.rglob("*.*")} - named.keys()
    assert {name for name in unnamed if "log" not in name} == {"index.html", "verified.json"}
    assert recheck.compute_sha256(results / "verified.json") in (results / "index.html").read_text()
    shutil.copytree(results / "bend/runs/bends/line", results / "bend/runs/bends/old")
    left = [
        *("summary.md", "bend/old.csv", "bend/notes/x.csv", "bend/problems/old.parquet"),
        *("bend/paper/old.csv", "bend/paper/table1.svg", "bend/beyond/figure9.png"),
        "bend/runs/bends/line/2.parquet",
    ]
    for name in left:
        (results / name).parent.mkdir(exist_ok=True)
        shutil.copy(results / "bend/claims.csv", results / name)
    old = results / "bend/runs/bends/old"
    left += [f"bend/runs/bends/old/{file.name}" for file in old.iterdir()]
    status, lines, _ = verified(capsys, results, "--all")
    told = {f"{results}/{name}: nothing makes it; delete it" for name in left}
    assert {*lines[: len(left)]} == told
    assert lines[len(left)].startswith("7 runs in 3 files: 7 different paths judged again; ")
    assert status == 1
    told = f"nothing makes {len(left)} files; the others: made by this code: "
    assert lines[-1] == f"{told}7 runs and 19 files made again, all equal"


def test_runs_that_are_missing_without_a_list_are_named(results, capsys):
    unlisted(results)
    shutil.rmtree(results / "bend/runs/bends/line")
    status, lines, _ = verified(capsys, results)
    assert status == 1
    assert lines[0].startswith(f"{results}/bend/runs/bends/line/")
    assert lines[-1].endswith("made by other code or libraries (no verified.json says by which)")


def test_what_another_program_wrote_is_one_line_also_in_the_workflow(results, capsys):
    table = table_files.read(str(results / RUNS)).replace_schema_metadata()
    names = table.column_names
    for name in ("id", "path_curve"):
        table = table.set_column(names.index(name), name, table[name].cast(pa.large_string()))
    parquet.write_table(table, results / RUNS)
    unlisted(results)
    status, lines, _ = verified(capsys, results)
    assert status == 1
    assert lines[0] == f"{results / RUNS}: other rows than were written"


SLIPS = {
    "the best of all runs": (
        "best = globals().setdefault('kept', []); best.append(rng.normal())\n"
        "    rng = type('', (), {'normal': lambda *_: min(best)})",
        "nothing kept from an earlier run",
    ),
    "an order of words": (
        "rng = np.random.default_rng(abs(hash('word')))",
        "no id() or hash()",
    ),
}


@pytest.mark.parametrize("case", SLIPS)
def test_a_slip_of_a_planner_is_told(case, tmp_path, planners_are_read_here):
    line, told = SLIPS[case]
    (tmp_path / "bend.py").write_text(BEND.format(seed=line))
    (tmp_path / "place.py").write_text("MIDDLE = 5.0\n")
    chunk = CHUNK._replace(planner=str(tmp_path / "bend.py"), repeats=[0, 6])
    with pytest.raises(PlannerFailure, match=re.escape(told)):
        execution.run_chunk(MADE, chunk)


def test_wrong_input_is_one_line_with_status_2(tmp_path, capsys):
    nowhere = tmp_path / "nowhere"
    line = f"{nowhere}: no runs here; expected a folder of results, such as results/full"
    assert verified(capsys, nowhere) == (2, [], [line])
