"""The wheel: built, installed without the extra into a fresh environment, and used away from the
clone.
"""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
MAP = ROOT / "config/studies/elhoseny2017/workspaces/gaps.geojson"
FIVE_LINES = """
import bezierplan as bp
room = bp.read_map("gaps.geojson")
answer = bp.plan(bp.Problem("room", room, (2.0, 10.0), (18.0, 10.0)), turning_radius=0.5)
print(round(answer.length, 3), answer.feasible)
cells = bp.read_map("gaps.geojson", cell=0.5)
problem = bp.Problem("room", cells, (2.0, 10.0), (18.0, 10.0))
print(bp.plan(problem, "song2016/smooth", generations=5).evaluations)
"""


def done(command, **options):
    ended = subprocess.run(command, capture_output=True, text=True, check=False, **options)
    assert ended.returncode == 0, ended.stdout + ended.stderr
    return ended.stdout


@pytest.fixture(scope="module")
def away(tmp_path_factory):
    """A fresh environment with the wheel and nothing else, and beside it a folder with a map."""
    folder = tmp_path_factory.mktemp("wheel")
    done(
        [
            sys.executable,
            "-m",
            "hatchling",
            "build",
            "--target",
            "wheel",
            "--directory",
            str(folder / "dist"),
        ],
        cwd=ROOT,
    )
    (wheel,) = (folder / "dist").glob("*.whl")
    done(
        [
            sys.executable,
            "-m",
            "uv",
            "venv",
            "--quiet",
            "--python",
            sys.executable,
            str(folder / "venv"),
        ]
    )
    python = folder / "venv/bin/python"
    constraints = folder / "constraints.txt"
    constraints.write_text(
        "".join(
            f"{line.split(' ')[0]}\n"
            for line in (ROOT / "environment.txt").read_text().splitlines()
            if "==" in line[:60]
        )
    )
    # Where no package index can be reached, this test says so.
    install = [sys.executable, "-m", "uv", "pip", "install", "--quiet"]
    got = subprocess.run(
        [*install, "--python", str(python), "--constraint", str(constraints), str(wheel)],
        capture_output=True,
        text=True,
        check=False,
    )
    if got.returncode and "error sending request" in got.stderr.lower():
        pytest.skip("no package index can be reached")
    assert got.returncode == 0, got.stderr
    (folder / "gaps.geojson").write_bytes(MAP.read_bytes())
    return folder


def environment(folder):
    """The variables of a shell that knows nothing of the clone."""
    return {name: value for name, value in os.environ.items() if name != "PYTHONPATH"} | {
        "XDG_CACHE_HOME": str(folder / "cache")
    }


def test_wheel_plans_away_from_the_clone_without_the_extra(away):
    said = done(
        [str(away / "venv/bin/python"), "-c", FIVE_LINES], cwd=away, env=environment(away)
    ).split()
    assert said[1] == "True"
    assert (away / "cache/bezierplan").is_dir()
    installed = done(
        [sys.executable, "-m", "uv", "pip", "list", "--python", str(away / "venv/bin/python")]
    )
    assert "snakemake" not in installed
    assert "pyarrow" not in installed


def test_console_command_plans_and_writes_a_picture(away):
    words = ["plan", "gaps.geojson", "--start", "2,10", "--target", "18,10", "--out", "path.svg"]
    said = done([str(away / "venv/bin/bezierplan"), *words], cwd=away, env=environment(away))
    assert "feasible        yes" in said
    assert (away / "path.svg").read_text().startswith("<?xml")


def test_command_that_needs_the_extra_says_which(away):
    ended = subprocess.run(
        [str(away / "venv/bin/bezierplan"), "digest", "results"],
        cwd=away,
        env=environment(away),
        capture_output=True,
        text=True,
        check=False,
    )
    assert ended.returncode == 2
    assert (
        ended.stderr
        == "digest: needs pyarrow, which is not installed; install it with: pip install "
        "'bezierplan[workflow]'\n"
    )
