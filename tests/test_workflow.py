"""The workflow itself, on a copy of the tree with a small song2016: what an edit re-runs, and that
results depend on names alone.
"""

import os
import pstats
import re
import shutil
import signal
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

import psutil
import pytest
import starts
import trees
import yaml
from trees import EXPERIMENTS, edit, small

from bezierplan.analysis.stored_runs import compute_table_digest, list_run_tables

ROOT = Path(__file__).parents[1]
# Those of the paper, and the baseline that all studies share.
GENETIC = ("nonsmooth", "smooth", "smooth_quadratic", "smooth_single")
METHODS = (*GENETIC, "rounded")
TRIGGERS = yaml.safe_load((ROOT / "profiles/default/profile.yaml").read_text())["rerun-triggers"]


def snakemake(tree, *words, check=True, **options):
    """Run snakemake in a tree, with the triggers alone of the default profile; returns what it
    printed.
    """
    done = starts.snakemake(
        tree,
        "--workflow-profile",
        "none",
        "--cores",
        "2",
        *words,
        "--rerun-triggers",
        *TRIGGERS,
        **options,
    )
    if check:
        assert done.returncode == 0, done.stderr
    return done.stdout + done.stderr


def digests(tree):
    """Digest of each run table of the tree's results at full scale, by name."""
    return {
        name: compute_table_digest(files)
        for name, files in list_run_tables(tree / "results/full").items()
    }


def planned(tree, *words):
    """Jobs of a dry run: how many of each rule, and the names of the artefacts and methods among
    them.
    """
    printed = snakemake(tree, "--dry-run", *words)
    jobs = re.findall(r"^rule (\w+):\n(.*?)(?=^rule |\Z)", printed, flags=re.M | re.S)
    names = Counter()
    for rule, body in jobs:
        wildcards = dict(
            re.findall(r"(\w+)=([\w.]+)", "".join(re.findall(r"wildcards: (.*)", body)))
        )
        name = wildcards.get("figure") or wildcards.get("table") or wildcards.get("method")
        if rule not in ("default", "all"):
            names[f"{rule} {name}" if name else rule] += 1
    return dict(names)


def runs(number, methods=METHODS):
    """Runs of methods, which are judged again before anything reads them; those of smooth_single
    with smooth_quadratic's, for what shows one shows both.
    """
    return {f"runs {method}": number for method in methods} | {
        f"judgement {method}": 1 for method in methods if method != "smooth_single"
    }


# Whatever the page shows is listed with its digest before.
PAGE = {"verified": 1, "page": 1}
SUMMARY = {"summary": 1} | PAGE
TABLES = {"table table1": 1, "latex table1": 1, "claims": 1, "methods": 1} | SUMMARY
OF_RUNS = TABLES | {"figure figure3": 1, "figure figure4": 1, "figure figure5": 1}
OF_PUBLISHED = {"table table1": 1, "latex table1": 1, "claims": 1, "audit": 1} | SUMMARY


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """A tree in which everything was made, kept as a snapshot."""
    tree = trees.copy(tmp_path_factory.mktemp("workflow") / "tree")
    (tree / ".venv").symlink_to(ROOT / ".venv")
    small(tree)
    snakemake(tree)
    # What it holds is named by content, so all copies may share it.
    (tree / ".cache").rename(tree.parent / "cache")
    (tree / ".cache").symlink_to(tree.parent / "cache")
    return shutil.copytree(tree, tree.parent / "snapshot", symlinks=True)


def changes(tree):
    """The files and links of a tree, each with the time of its last change, which nothing sets
    back.
    """
    found = {}
    for folder, folders, files in os.walk(tree):
        here = Path(folder)
        for file in map(here.joinpath, (*files, *folders)):
            if file.is_symlink() or not file.is_dir():
                found[file.relative_to(tree)] = file.lstat().st_ctime_ns
    return found


@pytest.fixture(scope="module")
def put_back(finished):
    """Makes the finished tree what it was before a test, and returns it. Only what has changed is
    copied: all of it takes as long as a dry run. It lies in the same place for every test, so that
    compiled kernels are found again.
    """
    place = finished.parent / "tree"
    kept = changes(place)

    def restored():
        found = changes(place)
        for name in sorted(found.keys() - kept.keys(), reverse=True):
            (place / name).unlink()
        changed = [name for name in sorted(kept) if kept[name] != found.get(name)]
        for name in changed:
            file = place / name
            file.parent.mkdir(parents=True, exist_ok=True)
            shutil.rmtree(file) if file.is_dir() and not file.is_symlink() else file.unlink(
                missing_ok=True
            )
            shutil.copy2(finished / name, file, follow_symlinks=False)
            kept[name] = file.lstat().st_ctime_ns
        return place

    return restored


@pytest.fixture
def tree(put_back):
    """The finished tree, to be edited."""
    return put_back()


def test_nothing_is_left_to_do(tree):
    assert planned(tree) == {}
    assert not list((tree / "results").rglob(".part-*"))


EDITS = {
    "code of a planner": (
        "src/bezierplan/planners/binary_genetic.py",
        "history[generation] = best_objective",
        "history[generation] = best_objective + 0",
        runs(2, GENETIC) | OF_RUNS,
    ),
    "what a job does": (
        "src/bezierplan/analysis/jobs.py",
        "            compared = comparison.compare(\n",
        "            0\n            compared = comparison.compare(\n",
        dict.fromkeys(("table table1", "latex table1", *SUMMARY), 1),
    ),
    "a title": (
        "config/studies/song2016/artefacts.yaml",
        "title: ",
        "title: The same, ",
        {"latex table1": 1} | PAGE,
    ),
    "a kind of figure": (
        "src/bezierplan/figures/panels/convergence.py",
        "from __future__ import annotations",
        "from __future__ import annotations\n\nNEW = 1",
        {"figure figure4": 1} | PAGE,
    ),
    "a setting of one method": (
        EXPERIMENTS,
        "samples: 701}",
        "samples: 701, population: 202}",
        runs(2, ["nonsmooth"]) | TABLES,
    ),
    "a published number": (
        "config/studies/song2016/published/table1.csv",
        "225.4982",
        "225.5982",
        OF_PUBLISHED,
    ),
    "a map": (
        "config/studies/song2016/workspaces/figure2.txt",
        "....##....######\n",
        "....##.....#####\n",
        {"problems": 1, "bounds": 1, "figure figure2": 1, "audit": 1}
        | runs(2, GENETIC)
        | runs(1, ["rounded"])
        | OF_RUNS,
    ),
    "more repeats": (EXPERIMENTS, "full: 4,", "full: 6,", runs(1, GENETIC) | OF_RUNS),
    "fewer repeats": (EXPERIMENTS, "full: 4,", "full: 3,", OF_RUNS),
    "a label": (
        "config/studies/song2016/artefacts.yaml",
        "0_15: 0 to 15",
        "0_15: from 0 to 15",
        # Table 1 has labels of its own.
        {f"figure figure{number}": 1 for number in (3, 4, 5)} | {"claims": 1} | SUMMARY,
    ),
    "a claim": (
        "config/studies/song2016/claims.yaml",
        "margin: 0.1,",
        "margin: 0.2,",
        {"claims": 1} | SUMMARY,
    ),
    "an alternative": (
        "config/studies/song2016/assumptions.yaml",
        "[20, 50, 101, 401]",
        "[20, 50, 401]",
        {"verified": 1, "page": 1},
    ),
}


@pytest.mark.parametrize("name", EDITS)
def test_edit_reruns_exactly_what_it_changes(name, tree):
    """By its content: the file keeps the date of its last change."""
    file, old, new, expected = EDITS[name]
    dates = (tree / file).stat()
    edit(tree / file, old, new)
    os.utime(tree / file, ns=(dates.st_atime_ns, dates.st_mtime_ns))
    assert planned(tree) == expected


def test_what_changes_no_result_reruns_nothing(tree):
    """A docstring, how jobs are logged, a new planner, and dates of scripts and of sources."""
    planners = tree / "src/bezierplan/planners"
    edit(planners / "parts/genetic.py", '"""', '"""Once more. ')
    edit(
        tree / "src/bezierplan/running/jobs/log.py", 'LAST = "CRITICAL "', 'LAST = "CRITICAL " + ""'
    )
    shutil.copy(planners / "binary_genetic.py", planners / "another.py")
    for file in (tree / "workflow").rglob("*.*"):
        os.utime(file)
    os.utime(tree / "config/studies/song2016/published/table1.csv")
    assert planned(tree) == {}


def test_cut_off_table_of_runs_is_named_and_made_again(finished, tree):
    file = tree / "results/full/song2016/runs/routes/smooth/0.parquet"
    file.write_bytes(file.read_bytes()[:100])
    printed = snakemake(tree, "song2016_figure4", "--forcerun", "figure", check=False)
    assert (
        f"{file.relative_to(tree)}: not a whole Parquet file; delete it and start again: the "
        "workflow reproduces it" in printed
    )
    file.unlink()
    snakemake(tree, file.relative_to(tree))
    assert digests(tree) == digests(finished)


def test_deleted_figure_alone_is_made_again(tree):
    (tree / "results/full/song2016/paper/figure4.svg").unlink()
    assert planned(tree) == {"figure figure4": 1} | PAGE


def test_single_figure_needs_only_its_own_methods(tree):
    shutil.rmtree(tree / "results")
    expected = {
        "problems": 1,
        "bounds": 1,
        "figure figure4": 1,
        **runs(2, ["smooth"]),
    }
    assert {
        name: number
        for name, number in planned(tree, "song2016_figure4").items()
        if "song2016" not in name
    } == expected


def test_one_core_another_order_and_larger_chunks_give_the_same_content(finished, tree):
    """And Snakemake looks for jobs that could start no more often than jobs end."""
    shutil.rmtree(tree / "results")
    edit(tree / EXPERIMENTS, "full: 2,", "full: 4,")
    files = [
        f"results/full/song2016/runs/routes/{method}/0.parquet" for method in reversed(METHODS)
    ]
    printed = snakemake(tree, "--cores", "1", *files, calls=tree / "calls")
    assert digests(tree) == digests(finished)
    jobs = int(re.search(r"^total +(\d+)", printed, flags=re.M)[1])
    (looks,) = (
        counts[0]
        for (*_, name), counts in pstats.Stats(str(tree / "calls")).stats.items()
        if name == "job_selector"
    )
    assert 0 < looks <= jobs == len(files) + 1


def test_page_made_again_on_one_core_has_equal_bytes(tree):
    """Figures are compared at the end of the workflow that is killed."""
    file = tree / "results/full/index.html"
    before = file.read_bytes()
    file.unlink()
    snakemake(tree, "--cores", "1")
    assert file.read_bytes() == before


def pictures_of(text):
    """The pictures of a page by name."""
    return dict(re.findall(r'alt="(\w+): [^"]*" src="[^"]*" data-packed="([^"]*)"', text))


def processes_in(folder):
    """Ids of the processes that work in a folder."""
    found = []
    for entry in Path("/proc").glob("[0-9]*"):
        try:
            if Path(os.readlink(entry / "cwd")) == folder:
                found.append(int(entry.name))
        except OSError:
            pass
    return found


# The kernel of Linux ends a job whose workflow dies (PR_SET_PDEATHSIG, `jobs.watchdog`); macOS has
# no such call, and no /proc to look into.
@pytest.mark.skipif(
    sys.platform != "linux",
    reason="only the kernel of Linux ends a job with its parent, and has /proc to look into",
)
def test_workflow_that_is_killed_again_and_again_leaves_no_job_and_goes_on_to_the_same_end(
    finished, tree
):
    """Killed by itself or with its group, each time when a new file of a kind is there; at most so
    many chunks of runs are done by then.
    """
    shutil.rmtree(tree / "results")
    for kill, moment, runs in (
        (os.kill, "runs/*/*/*.parquet", 7),
        (os.killpg, "paper/*.csv", 16),
    ):
        before = set(tree.glob(f"results/full/song2016/{moment}"))
        make = subprocess.Popen(
            ["make", "reproduce"],
            cwd=tree,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )
        deadline = time.monotonic() + 120
        while set(tree.glob(f"results/full/song2016/{moment}")) <= before:
            assert time.monotonic() < deadline
            assert make.poll() is None
            time.sleep(0.05)
        (started,) = psutil.Process(make.pid).children()
        assert started.cmdline()[1:] == ["-m", "bezierplan", "run", "all"]
        kill(make.pid if kill is os.killpg else started.pid, signal.SIGKILL)
        assert make.wait() != 0
        # On a busy machine processes take seconds to die, and write meanwhile.
        deadline = time.monotonic() + 20
        while processes_in(tree) and time.monotonic() < deadline:
            time.sleep(0.05)
        assert processes_in(tree) == []
        assert len(list(tree.glob("results/full/song2016/runs/*/*/?.parquet"))) <= runs
        assert not (tree / "results/full/index.html").exists()
    subprocess.run(["make", "reproduce"], cwd=tree, check=True, capture_output=True)
    assert digests(tree) == digests(finished)
    pictures, drawn = (
        pictures_of((place / "results/full/index.html").read_text()) for place in (finished, tree)
    )
    assert {name for name, picture in pictures.items() if drawn[name] != picture} <= {"work"}
    assert not list((tree / "results").rglob(".part-*"))
    drawings, drawn_again = (
        {file.name: file.read_bytes() for file in place.glob("results/full/song2016/paper/figure*")}
        for place in (finished, tree)
    )
    assert drawings.keys() == drawn_again.keys()
    assert {name for name, content in drawings.items() if drawn_again[name] != content} == set()


# One kernel that calls another one of another module.
RUN_ONCE = """
from bezierplan.planners.parts import gene_lists
print(gene_lists.compute_q(2, 3, 3, 10))
"""


def test_edited_kernel_is_never_served_from_an_old_cache(tree):
    def run_once():
        return starts.python(RUN_ONCE, tree, tree / "src")

    before = run_once()
    assert run_once() == before
    edit(
        tree / "src/bezierplan/planners/parts/diversity.py",
        "return (agree - differ) / ",
        "return 2.0 * (agree - differ) / ",
    )
    after = run_once()
    (tree / ".cache").unlink()
    assert run_once() == after != before


def test_fault_stops_before_any_job_with_one_line(tree):
    shutil.rmtree(tree / "results")
    edit(tree / EXPERIMENTS, "population: 10", "population: 11")
    done = subprocess.run(
        [sys.executable, "-m", "snakemake"], cwd=tree, capture_output=True, text=True, check=False
    )
    told = [
        line for line in (done.stdout + done.stderr).splitlines() if line and "profile" not in line
    ]
    assert done.returncode != 0
    assert len(told) == 1
    assert "experiments.yaml: methods: nonsmooth: settings: population: 11" in told[0]
    assert not (tree / "results").exists()
