"""One account of what a file follows from: `verify` says `made by this code` exactly if no file was
edited by hand and `snakemake -n` names no job, whatever is edited.
"""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import starts
from chunks import CLAIMS
from trees import edit

from bezierplan.places import TREE

READS = "float(Path(__file__).parent.joinpath('{}').read_text())"
STUDY = {
    "experiments.yaml": """
title: A bend round a disc
methods: {bend: {planner: bend.py, settings: {up: 4.0}}, line: {planner: straight_line}}
settings: {}
workspaces:
  disc: {kind: drawn, function: disc, sees: circles, unit: m}
  room: {kind: grid, file: room.txt, cell: 1, unit: m}
problems:
  across: {workspace: disc, start: [-4, 0], target: [4, 0], obstacles: [1],
    layouts: {smoke: 1, full: 1, extended: 1}}
experiments:
  bends: {problems: [across], methods: [bend, line], repeats: {smoke: 2, full: 2, extended: 2},
    chunk: {smoke: 2, full: 2, extended: 2}}
""",
    "artefacts.yaml": """
labels: {bend: a bend}
tables:
  table1: {title: Lengths, kind: pivot, experiment: bends, published: lengths.csv, index: [method],
    columns: [value], values: [{metric: weighed, statistic: mean, label: length, decimals: 2}]}
  table2: {title: Terms, kind: function, function: terms}
figures:
  figure1: {title: Lengths, columns: 1, panels: [
    {kind: own, experiment: bends, function: dots, metrics: [length]}]}
  figure2: {title: The room, columns: 1, panels: [{kind: workspace, workspace: room}]}
""",
    "claims.yaml": CLAIMS,
    "published/lengths.csv": "method,metric,statistic,n,unit,value\nbend,weighed,mean,2,m,10.0\n",
    "room.txt": "..#\n...\n",
    "bend.py": f'''"""A bend of one control point."""

from pathlib import Path

import numpy as np
from bezierplan.geometry import curves
from bezierplan.planners import Path as Curve, Plan
from place import HEIGHT

workspaces = ("circles",)

def plan(problem, rng, *, up: float):
    """Plan one bend."""
    shift = {READS.format("data/shift.txt")} + {READS.format("../beside.txt")}
    middle = [shift, up + HEIGHT + rng.normal(0, 0.1)]
    path = Curve("bezier", np.array([problem.start, middle, problem.target]))
    length = curves.length(path)
    return Plan(path, length, True, 1, np.array([length]), "one", {{}})
''',
    "place.py": "HEIGHT = 1.0\n",
    "data/shift.txt": "0.1",
    "../beside.txt": "0.2",
    "metrics.py": f"""
from pathlib import Path
from bezierplan.analysis.metric import metric

@metric("u", "length times a weight")
def weighed(runs, problems):
    return runs["length"] * {READS.format("weight.txt")}
""",
    "weight.txt": "2",
    "functions.py": f"""
from pathlib import Path
import pandas as pd

def terms(published):
    return pd.DataFrame({{"term": [{READS.format("term.txt")}]}})
""",
    "term.txt": "3",
    "worlds.py": f"""
from pathlib import Path
import numpy as np
from bezierplan.workspaces.circles import Circles

def disc(rng, problem):
    radii = np.array([{READS.format("radius.txt")}])
    return Circles((-5.0, 5.0, -5.0, 5.0), np.zeros((1, 2)), radii, "m")
""",
    "radius.txt": "1",
    "panels.py": f"""
from pathlib import Path

def dots(axes, frame, looks):
    axes.plot(frame["length"], alpha={READS.format("alpha.txt")})
    return "dots"
""",
    "alpha.txt": "0.5",
    "notes.md": "What nobody reads.\n",
}

# Asks what `snakemake -n` and `verify` say in a fork of a process that has imported both; what
# `verify` makes again is left to `test_verify`.
ASKED = """
import os, sys
import snakemake.cli, snakemake.dag, snakemake.executors.dryrun, snakemake.scheduling.greedy
from bezierplan.analysis.outcome import verification
from bezierplan.commands import verify
from bezierplan.machine import digest
from bezierplan.running import recheck
from bezierplan.running.guard import process
from bezierplan.study import checks
process.run_function = lambda work, *given: [*work(str)]
checks.Checks.check = lambda self: []
recheck.verify = recheck.run_again = lambda *given: recheck.RunsVerdict()
# Set where it is not, it would help nothing, and every question would make all files again.
assert callable(verification.find_differences)
verification.find_differences = lambda *given: (0, [])

def ended(main, *given):
    try:
        main(*given)
    except SystemExit:
        pass
    print(flush=True)

for line in sys.stdin:
    child = os.fork()
    if not child:
        for number in (1, 2):
            os.dup2(os.open(line.strip(), os.O_WRONLY | os.O_CREAT | os.O_APPEND), number)
        for known in vars(digest).values():
            getattr(known, "cache_clear", int)()
        sys.argv = ["snakemake", *sys.argv[1:]]
        ended(snakemake.cli.main, sys.argv[1:])
        ended(verify.main, verification.Path("results/smoke"))
        os._exit(0)
    os.waitpid(child, 0)
    print(flush=True)
"""


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A folder with the study and its results, and a copy of the tree beside it."""
    folder = tmp_path_factory.mktemp("account")
    shutil.copytree(TREE / "src", folder / "tree" / "src")
    for name in ("workflow", "config", "profiles", "Snakefile", "docs/outcome"):
        copy = shutil.copytree if (TREE / name).is_dir() else shutil.copy
        (folder / "tree" / name).parent.mkdir(exist_ok=True)
        copy(TREE / name, folder / "tree" / name)
    for name, text in STUDY.items():
        file = folder / "reads" / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
    done = starts.snakemake(folder, *WORDS)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder


WORDS = (
    *("smoke", "--snakefile", "tree/Snakefile", "--config", 'studies=["./reads"]'),
    *("--workflow-profile", "none", "--cores", "2", "--rerun-triggers", "mtime", "input", "params"),
)


@pytest.fixture(scope="module")
def ask(made):
    """A function that gives whether `snakemake -n` names a job, and the answer of `verify`."""
    path = os.pathsep.join([str(made / "tree/src"), os.environ["PYTHONPATH"]])
    with subprocess.Popen(
        [sys.executable, "-c", ASKED, *WORDS, "--dry-run"],
        cwd=made,
        env=os.environ | {"PYTHONPATH": path},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    ) as process:

        def asked():
            said = made / "said.txt"
            said.unlink(missing_ok=True)
            print(said, file=process.stdin, flush=True)
            process.stdout.readline()
            text = said.read_text()
            assert "Traceback" not in text, text
            return "Nothing to be done" not in text, text.strip().splitlines()[-1]

        yield asked
        process.stdin.close()


def append(text):
    return lambda file: file.write_text(file.read_text() + text)


def put(old, new):
    return lambda file: edit(file, old, new)


def turn(file):
    """Change one bit in the middle."""
    content = bytearray(file.read_bytes())
    content[len(content) // 2] ^= 1
    file.write_bytes(content)


COMMENT, CODE, DOCSTRING = append("\n# words\n"), append("\nNEW = 1\n"), put('"""', '"""Words. ')
OWN = ("metrics", "functions", "worlds", "panels")
SRC = "tree/src/bezierplan/"
# What is edited, and how: what changes results, and what changes none.
EDITS = [
    ("reads/experiments.yaml", put("up: 4.0", "up: 4.5")),
    ("reads/experiments.yaml", put("smoke: 2", "smoke: 3")),
    ("reads/experiments.yaml", put("[-4, 0]", "[-4, 1]")),
    ("reads/experiments.yaml", put("methods: [bend,", "time_limit: 9, methods: [bend,")),
    ("reads/artefacts.yaml", put("a bend", "the bend")),
    ("reads/artefacts.yaml", put("title: Terms", "title: All terms")),
    ("reads/artefacts.yaml", put("decimals: 2", "decimals: 3")),
    ("reads/claims.yaml", put("0.01", "0.02")),
    ("reads/claims.yaml", put("is shorter", "is the shorter one")),
    ("reads/published/lengths.csv", put("10.0", "10.1")),
    ("reads/room.txt", put("#", ".")),
    ("reads/bend.py", CODE),
    ("reads/bend.py", DOCSTRING),
    ("reads/place.py", put("1.0", "1.1")),
    ("reads/data/shift.txt", append("1")),
    ("beside.txt", append("1")),
    ("reads/weight.txt", append("1")),
    ("reads/term.txt", append("1")),
    ("reads/radius.txt", append(".5")),
    ("reads/alpha.txt", Path.unlink),
    *((f"reads/{name}.py", CODE) for name in OWN),
    (f"{SRC}planners/straight_line.py", DOCSTRING),
    (f"{SRC}planners/straight_line.py", CODE),
    (f"{SRC}running/execution.py", CODE),
    (f"{SRC}running/columns.csv", put("least distance", "distance")),
    (f"{SRC}geometry/region.py", CODE),
    (f"{SRC}analysis/claims/kinds/lower.py", CODE),
    (f"{SRC}analysis/jobs.py", put("published is not None:", "None is not published:")),
    (f"{SRC}figures/panels/own.py", CODE),
    (f"{SRC}figures/page/static/page.js", append("\n")),
]
HARMLESS = [
    ("reads/experiments.yaml", COMMENT),
    ("reads/artefacts.yaml", append("\n\n")),
    ("reads/published/lengths.csv", os.utime),
    ("reads/notes.md", COMMENT),
    ("reads/bend.py", COMMENT),
    ("reads/bend.py", os.utime),
    ("reads/bend.py", put("Plan one bend", "Plan a bend")),
    ("beside.txt", os.utime),
    *((f"reads/{name}.py", COMMENT) for name in OWN),
    (f"{SRC}planners/straight_line.py", COMMENT),
    (f"{SRC}planners/bca.py", CODE),
    (f"{SRC}running/execution.py", DOCSTRING),
    (f"{SRC}running/jobs/log.py", CODE),
    (f"{SRC}machine/opened_files.py", CODE),
    (f"{SRC}analysis/claims/kinds/untestable.py", CODE),
    (f"{SRC}analysis/jobs.py", put('"""Make the table and', '"""Make a table and')),
    (f"{SRC}figures/panels/boxes.py", CODE),
    ("tree/workflow/scripts/job.py", os.utime),
]
HANDS = [
    *("reads/paper/table1.csv", "reads/paper/table1.tex", "reads/paper/figure1.png"),
    *("reads/claims.csv", "reads/problems/bends.parquet", "reads/runs/bends/bend/0.parquet"),
    *("reads/runs/bends/bend/0.times.parquet", "numbers.csv"),
]


@pytest.fixture
def edited(made):
    """A function that edits a file, which afterwards is what it was."""
    kept = []

    def edit(name, change):
        file = made / name
        kept.append((file, file.read_bytes(), file.stat()))
        change(file)

    yield edit
    for file, content, dates in reversed(kept):
        file.write_bytes(content)
        os.utime(file, ns=(dates.st_atime_ns, dates.st_mtime_ns))


@pytest.mark.parametrize(("name", "change"), EDITS)
def test_verify_says_other_code_if_a_job_is_to_run(ask, edited, name, change):
    edited(name, change)
    named, answer = ask()
    assert named
    assert not answer.startswith("made by this code")


def test_verify_says_made_by_this_code_after_edits_that_make_no_job_run(ask, edited):
    for name, change in HARMLESS:
        edited(name, change)
    named, answer = ask()
    assert not named
    assert answer.startswith("made by this code")


def test_verify_names_the_files_that_were_edited_by_hand(ask, edited, made):
    for name in HANDS:
        edited(f"results/smoke/{name}", turn)
    assert ask()[1] == f"differs: {len(HANDS)} files; made by this code"
    said = (made / "said.txt").read_text()
    assert all(f"results/smoke/{name}: " in said for name in HANDS)
