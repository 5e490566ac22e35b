"""The wheel: built, installed into an environment of its own, and used away from the clone, with
the libraries of the tests, or without those of the extra.
"""

import os
import re
import shlex
import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest

import bezierplan
from bezierplan.places import EXTRA

ROOT = Path(__file__).parents[1]
PAGES = ["README.md", *(f"docs/{name}.md" for name in ("start", "python"))]
PAGES += [f"docs/tutorials/{name}.md" for name in ("map", "planner", "paper", "moving")]
# What needs the results of a clone.
IN_A_CLONE = re.compile(r"bezierplan (verify|digest) ")
MAP = "image: map.pgm\nresolution: 1\norigin: [0, 0, 0]\nnegate: 0\n"
MAP += "occupied_thresh: 0.65\nfree_thresh: 0.196\n"

EVERY_METHOD = """
import bezierplan as bp
from bezierplan.running.guard import contract
picture = ("......", ".S..T.", "..#...", "......")
kinds = ("grid", "circles", "polygons")
rooms = [contract.build_drawn_problem(kind, "room", picture) for kind in kinds]
for name in [*bp.methods(all=True), "prm"]:
    for problem in rooms:
        try:
            print(bp.plan(problem, name).method, "planned")
            break
        except ValueError as fault:
            assert "serve" in str(fault), fault
try:
    bp.plan(problem, "song2016/smoth")
except ValueError as fault:
    print(fault)
"""


@pytest.fixture(scope="module")
def away(tmp_path_factory):
    """A folder with an environment that has the wheel."""
    folder = tmp_path_factory.mktemp("wheel")
    hatch = ["hatchling", "build", "--target", "wheel", "--directory", str(folder)]
    done([sys.executable, "-m", *hatch], cwd=ROOT)
    (wheel,) = folder.glob("*.whl")
    done([sys.executable, "-m", "venv", "--without-pip", str(folder / "venv")])
    python = folder / "venv/bin/python"
    uv = [sys.executable, "-m", "uv", "pip", "install", "--quiet", "--no-deps", "--offline"]
    done([*uv, "--python", str(python), str(wheel)])
    paths = [sysconfig.get_path(name) for name in ("purelib", "platlib")]
    (packages,) = (folder / "venv/lib").glob("*/site-packages")
    (packages / "libraries.pth").write_text("\n".join(dict.fromkeys(paths)) + "\n")
    # Kernels are named by their code.
    (folder / "cache/bezierplan").mkdir(parents=True)
    (folder / "cache/bezierplan/kernels").symlink_to(ROOT / ".cache/kernels")
    (folder / "core").mkdir()
    for name in EXTRA:
        fault = f"raise ModuleNotFoundError('no {name}', name={name!r})\n"
        (folder / "core" / f"{name}.py").write_text(fault)
    return folder


def done(command, status=0, **options):
    """What a command prints, which must end with a status."""
    ended = subprocess.run(command, capture_output=True, text=True, check=False, **options)
    assert ended.returncode == status, ended.stdout + ended.stderr
    return ended.stdout + ended.stderr


def shell(away, command, place, core=False, status=0):
    """What a command line prints in a shell that knows nothing of the clone."""
    variables = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    variables["PATH"] = f"{away / 'venv/bin'}:{variables['PATH']}"
    if core:
        variables["PYTHONPATH"] = str(away / "core")
    place.mkdir(exist_ok=True)
    return done(["bash", "-c", command], status, cwd=place, env=variables)


def examples(page):
    """The command lines and the Python of a page that anybody can try."""
    blocks = re.findall(r"^```(\w*)\n(.*?)^```$", (ROOT / page).read_text(), flags=re.M | re.S)
    for language, block in blocks:
        if language == "sh":
            lines = [re.split(r"\s+# ", line)[0] for line in block.splitlines()]
            ours = [line for line in lines if re.match(r"(python -m )?bezierplan ", line)]
            yield from (line for line in ours if not IN_A_CLONE.search(line))
        elif language == "python" and not block.startswith((">>> ", "# Snakefile")):
            yield f"python -c {shlex.quote(block)}"
    session = "".join(block for language, block in blocks if block.startswith(">>> "))
    if session:
        code = f"import doctest; print(doctest.run_docstring_examples({session!r}, {{}}))"
        yield f"python -c {shlex.quote(code)}"


def prepared(place):
    """A folder with the map of one's own that pages speak of."""
    place.mkdir()
    (place / "map.yaml").write_text(MAP)
    (place / "map.pgm").write_bytes(b"P5 10 10 255 " + bytes([254]) * 100)
    return place


def test_the_core_plans_by_a_paper_s_method_and_says_what_it_lacks(away):
    place = prepared(away / "few")
    words = "--start 2,10 --target 18,10"
    said = shell(away, f"bezierplan plan gaps {words} --out path.svg", place, core=True)
    assert "feasible        yes" in said
    assert (place / "path.svg").read_text().startswith("<?xml")
    method = "--method song2016/smooth"
    said = shell(away, f"bezierplan plan gaps {words} {method}", place, core=True, status=2)
    assert "the map is polygons; read it with a cell" in said
    said = shell(away, "bezierplan digest results", place, core=True, status=2)
    assert said == (
        "digest: needs pyarrow, which is not installed; install it with: pip install "
        "'bezierplan[workflow]'\n"
    )


def test_the_core_plans_once_by_every_method(away):
    said = shell(away, f"python -c {shlex.quote(EVERY_METHOD)}", away / "every", core=True)
    planned = re.findall("^(.*) planned$", said, flags=re.M)
    assert planned == [*bezierplan.methods(all=True), "prm"]
    assert "song2016/smoth: unknown; did you mean song2016/smooth?" in said


def test_the_papers_can_be_run_by_name_in_any_folder(away):
    place = prepared(away / "names")
    assert "song2016, tables: " in shell(away, "bezierplan list", place)
    assert "song2016" in shell(away, "bezierplan run song2016_figure4 -n", place)
    said = shell(away, "bezierplan replay song2016/routes/15_240/smooth/2", place)
    assert "picture         results/replay/song2016/routes/15_240/smooth/2.svg" in said


@pytest.fixture(scope="module")
def tried(away):
    """What a command of a page prints, each executed once, as it stands on the first page that has
    it.
    """
    place, said = prepared(away / "pages"), {}

    def tried(command):
        words = command.removeprefix("python -m ")
        if words not in said:
            said[words] = shell(away, command, place)
        return said[words]

    return tried


@pytest.mark.rare
@pytest.mark.parametrize("page", PAGES)
def test_examples_of_a_page_run_away_from_the_clone(tried, page):
    commands = [*examples(page)]
    assert commands
    # A page may make a study twice: empty, and with a map of one's own.
    for command in commands:
        if "--from" in command:
            command = command.replace("new mystudy", "new another")
        assert "Failed example" not in tried(command), command
