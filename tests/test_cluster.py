"""The profiles for clusters: the tutorial's lines on a Slurm of one node, and the generic profile
on a stand-in for qsub.

Both must give the bits of a run without a cluster. The copy of the tree has an environment of its
own, to which `make cluster` can add.
"""

import graphlib
import os
import re
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest
import slurm
import starts
import trees
import yaml

pytestmark = pytest.mark.rare

ROOT = Path(__file__).parents[1]
(LINES,) = re.findall(
    r"^# From a laptop to a cluster$.*?^```sh\n(.*?)^```$",
    (ROOT / "docs" / "tutorials" / "cluster.md").read_text(),
    flags=re.M | re.S,
)
COMMANDS = [re.split(r"\s+# ", line)[0] for line in LINES.splitlines()]
PROFILES = {
    name: yaml.safe_load((ROOT / "profiles" / name / "profile.yaml").read_text())
    for name in ("default", "slurm", "cluster")
}
FIGURE = "results/smoke/song2016/paper/figure4.svg"
RUN = "results/smoke/song2016/runs/routes/smooth/0.parquet"


def linked(original, copied):
    """A file under another name, or, on another disk, a copy."""
    try:
        os.link(original, copied)
    except OSError:
        shutil.copy2(original, copied)


@pytest.fixture(scope="module")
def tree(tmp_path_factory):
    """A copy of the tree whose configuration names song2016 alone."""
    tree = trees.copy(tmp_path_factory.mktemp("cluster") / "tree")
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", tree / ".venv"], check=True)
    (site,) = (tree / ".venv").glob("lib/python*/site-packages")
    shutil.copytree(sysconfig.get_path("purelib"), site, dirs_exist_ok=True, copy_function=linked)
    linked(Path(sysconfig.get_path("scripts")) / "uv", tree / ".venv" / "bin" / "uv")
    (tree / ".venv" / "ready").touch()
    # pytest may run with modules of its own; the tree's programs stand in its environment as in any
    # other.
    (tree / ".venv" / "bin" / "snakemake").write_text(
        f'#!/bin/sh\nexec "{tree}/.venv/bin/python" -m snakemake "$@"\n'
    )
    (tree / ".venv" / "bin" / "snakemake").chmod(0o755)
    # A test need not wait as long between two looks as a cluster of many users.
    for name in (
        "slurm",
        "cluster",
    ):
        file = tree / "profiles" / name / "profile.yaml"
        file.write_text(re.sub(r"(checks|latency-wait): \d+", r"\1: 2", file.read_text()))
    done = executed(tree, "make cluster")
    assert done.returncode == 0, done.stderr
    return tree


def executed(tree, command, **environment):
    """What a command does in the tree's environment, within ten minutes."""
    own = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"} | environment
    words = ["timeout", "--kill-after=5", "600", "bash", "-c", f". .venv/bin/activate && {command}"]
    return subprocess.run(words, cwd=tree, env=own, capture_output=True, text=True, check=False)


def digests(tree):
    """Hash of each run table at scale smoke, by name."""
    command = [sys.executable, "-m", "bezierplan", "digest", "results/smoke"]
    printed = subprocess.run(command, cwd=tree, capture_output=True, text=True, check=True).stdout
    return {name: digest for digest, name in map(str.split, printed.splitlines())}


@pytest.fixture(scope="module")
def local():
    """Hashes of the runs made without a cluster, which `make test` makes before the tests."""
    assert (ROOT / RUN).is_file(), f"no {RUN}: run snakemake smoke first"
    found = digests(ROOT)
    return {
        name: found[name]
        for name in (
            "song2016/routes/smooth",
            "song2016/routes/smooth_quadratic",
            "song2016/routes/smooth_single",
        )
    }


def test_slurm_gives_the_same_bits(tree, local, tmp_path_factory):
    """One figure with what it needs, for each job costs two starts of Snakemake; the tutorial's
    lines as dry runs.
    """
    # Slurm comes as Debian's packages, not from PyPI, and only root can start its daemons; a
    # machine that has a Slurm keeps its own. Continuous integration installs it (`.ci/run`).
    if slurm.obstacle():
        pytest.skip(f"no Slurm: {slurm.obstacle()}")
    assert COMMANDS[0] == "make cluster"
    with slurm.running(tmp_path_factory.mktemp("slurm")):
        done = executed(tree, f"snakemake {FIGURE} --workflow-profile profiles/slurm")
        assert done.returncode == 0, done.stdout + done.stderr
        assert digests(tree) == {"song2016/routes/smooth": local["song2016/routes/smooth"]}
        assert (tree / FIGURE).is_file()
        # The problems with their bounds, the runs, the judgement, the figure.
        assert len(re.findall("submitted with SLURM jobid", done.stdout + done.stderr)) == 4
        for command in filter(lambda command: command.startswith("snakemake"), COMMANDS):
            done = executed(tree, f"{command} --dry-run")
            assert done.returncode == 0, done.stdout + done.stderr


QSUB = """#!/bin/sh
# Runs the job's script as a scheduler would, later; its options are those of the profile.
echo "$@" >> asked.txt
for script; do :; done
nohup sh "$script" > /dev/null 2>&1 &
echo $!
"""


def test_generic_profile_gives_the_same_bits(tree, local):
    qsub = tree / ".venv" / "bin" / "qsub"
    qsub.write_text(QSUB)
    qsub.chmod(0o755)
    shutil.rmtree(tree / "results", ignore_errors=True)
    done = executed(tree, f"snakemake {RUN} --workflow-profile profiles/cluster")
    assert done.returncode == 0, done.stdout + done.stderr
    assert digests(tree) == {"song2016/routes/smooth": local["song2016/routes/smooth"]}
    asked = (tree / "asked.txt").read_text().splitlines()
    # The problems may take 5 minutes, the runs 20.
    asked_of = [re.findall("-l nodes=1:ppn=1,mem=1500mb,walltime=(.*?) ", line) for line in asked]
    assert asked_of == [["300"], ["1200"]]


@pytest.mark.parametrize("name", ["slurm", "cluster"])
def test_profile_keeps_what_the_default_one_says(name):
    own, default = PROFILES[name], PROFILES["default"]
    assert {key: own[key] for key in default if key != "cores"} == {
        key: value for key, value in default.items() if key != "cores"
    }


@pytest.mark.parametrize("name", ["slurm", "cluster"])
def test_every_rule_is_in_a_group(name):
    text = "".join(file.read_text() for file in sorted((ROOT / "workflow/rules").glob("*.smk")))
    rules = {
        rule
        for rule, body in re.findall(r"^rule (\w+):\n(.*?)(?=^\S|\Z)", text, flags=re.M | re.S)
        if "\n    script:" in body
    } | set(re.findall(r"^use rule \w+ as (\w+) with:", text, flags=re.M))
    assert PROFILES[name]["groups"].keys() == rules
    assert set(PROFILES[name]["groups"].values()) == PROFILES[name]["group-components"].keys()
    assert PROFILES[name]["groups"] == PROFILES["slurm"]["groups"]


def test_no_group_waits_for_a_group_that_waits_for_it():
    words = ("extended", "--rulegraph", "--forceall", "--workflow-profile", "none")
    drawn = starts.snakemake(ROOT, *words, "--config", "studies=[meledje]").stdout
    rules = dict(re.findall(r'(\d+)\[label = "(\w+)"', drawn))
    groups = {"extended": "extended"} | PROFILES["slurm"]["groups"]
    assert groups.keys() == set(rules.values()), "a study with every rule"
    needs = {group: set() for group in groups.values()}
    for before, after in re.findall(r"(\d+) -> (\d+)", drawn):
        one, other = (groups[rules[number]] for number in (before, after))
        if one != other:
            needs[other].add(one)
    graphlib.TopologicalSorter(needs).prepare()  # raises CycleError
