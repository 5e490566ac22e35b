"""`python -m bezierplan plan`: one path on a map of any kind, its examples, and every fault in one
line with status 2.
"""

import importlib.util
import json
import re
import shlex

import numpy as np
import pytest
import yaml
from commands import call, refused
from fields import BENCHMARK_MAPS, CELLS
from PIL import Image

import bezierplan as bp
from bezierplan.__main__ import COMMANDS, main
from bezierplan.commands import plan
from bezierplan.geometry import shortest_paths

GAPS = str(BENCHMARK_MAPS / "gaps.geojson")
ENDS = ["--start", "2,10", "--target", "18,10"]
SHORTEST = 29.565803670

# Through the middle of each gap.
OWN = """
import numpy as np
from bezierplan.planners import Path, Plan

def plan(problem, rng):
    way = [problem.start, (5.0, 15.0), (10.0, 5.0), (15.0, 15.0), problem.target]
    return Plan.of_one(Path("polyline", np.array(way)), 1.0, "of one")
"""


def planned(capsys, *words, fails=False):
    """What is printed, by name, and the line of a failure, with which Python ends with status 1."""
    failure, lines, _ = call(capsys, "plan", *words)
    assert isinstance(failure, str) == fails
    return {line[:16].strip(): line[16:] for line in lines} | {"failure": failure}


def test_without_a_method_it_is_the_rounded_shortest_path(capsys):
    lines = planned(capsys, GAPS, *ENDS)
    assert lines["planner"] == "rounded_shortest_path"
    assert lines["shortest path"] == "29.5658 m"
    assert lines["feasible"] == "yes"
    numbers = re.fullmatch(r"([\d.]+) m, ([\d.e-]+) % above the shortest path", lines["length"])
    length, gap = map(float, numbers.groups())
    assert length / SHORTEST - 1 == pytest.approx(gap / 100, abs=1e-5)
    assert gap == pytest.approx(1, abs=0.05)
    radius = float(lines["turning radius"].removesuffix(" m"))
    assert lines["curvature"].startswith(f"at most {1 / radius:.3f}")
    assert lines["CPU time"].endswith(" s")


ASKED = {
    "nothing more": ([], {}),
    "a radius": (["--robot-radius", "0.3"], {"robot_radius": 0.3}),
    "way points": (["--via", "2,15", "--via", "18,15"], {"via": [(2.0, 15.0), (18.0, 15.0)]}),
    "a planner": (["--method", "chaotic_pso", "--seed", "2"], {"method": "chaotic_pso", "seed": 2}),
    "a planner of cells": (
        ["--method", "binary_genetic", "--cell", "1.25"],
        {"method": "binary_genetic"},
    ),
    "a study's method": (
        ["--method", "elhoseny2017/prm", "--cell", "0.5", "--settings", "{nodes: 300}"],
        {"method": "elhoseny2017/prm", "nodes": 300},
    ),
}


@pytest.mark.parametrize("asked", ASKED)
def test_the_command_and_the_function_plan_alike(asked, capsys, tmp_path):
    words, arguments = ASKED[asked]
    command = tmp_path / "command.csv"
    cell = float(words[words.index("--cell") + 1]) if "--cell" in words else None
    problem = bp.Problem("", bp.read_map(GAPS, cell=cell), (2.0, 10.0), (18.0, 10.0))
    answer = bp.plan(problem, **arguments)
    answer.save(tmp_path / "function.csv")
    lines = planned(capsys, GAPS, *ENDS, *words, "--out", command, fails=not answer.feasible)
    assert command.read_bytes() == (tmp_path / "function.csv").read_bytes()
    settings = ", ".join(f"{name} {value}" for name, value in answer.settings.items())
    assert lines["settings"] == settings or "none"
    assert lines["length"].startswith(f"{answer.length:.6g} m")
    assert lines["feasible"].startswith("yes") == answer.feasible


def test_a_planner_of_one_s_own_may_have_any_name(capsys, tmp_path):
    """That of one of this package, whose settings and way points it does not have."""
    name = "rounded_shortest_path"
    file = tmp_path / f"{name}.py"
    file.write_text(OWN)
    assert planned(capsys, GAPS, *ENDS, "--method", file)["length"].startswith("34.0226 m")
    spec = importlib.util.spec_from_file_location(name, file)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    module.plan.__name__ = name
    problem = bp.Problem("", bp.read_map(GAPS), (2.0, 10.0), (18.0, 10.0))
    for method in (str(file), module, module.plan):
        assert bp.plan(problem, method).length == pytest.approx(2 * (34**0.5 + 125**0.5))
        with pytest.raises(ValueError, match="via: only for"):
            bp.plan(problem, method, via=[(2.0, 15.0)])


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_explains_each_of_its_arguments(command, capsys):
    with pytest.raises(SystemExit) as end:
        main([command, "--help"])
    assert not end.value.code
    text = capsys.readouterr().out
    assert f"examples:\n{command} " in text or command in ("digest", "plan")
    arguments = text.partition("positional arguments:")[2] or text.partition("options:")[2]
    assert not re.findall(r"\n  (-?\w\S*)(?: [A-Z'{]\S*)*\n(?=  \S|\n)", arguments)


def test_examples_of_the_help_run(capsys, tmp_path):
    commands = re.findall(r"^ +(plan (?:.*\\\n)*.*)$", plan.main.__doc__, flags=re.MULTILINE)
    assert len(commands) == 3
    for command in commands:
        words = shlex.split(command.replace("\\\n", " "))
        out = tmp_path / words[words.index("--out") + 1]
        words[words.index("--out") + 1] = str(out)
        main(words)
        assert out.stat().st_size > 1000
        assert "feasible" in capsys.readouterr().out


def test_files_that_are_written(capsys, tmp_path):
    planned(capsys, GAPS, *ENDS, "--out", tmp_path / "path.csv")
    rows = np.loadtxt(tmp_path / "path.csv", delimiter=",", skiprows=1)
    assert rows[0, :3].tolist() == [0.0, 2.0, 10.0]
    assert rows[-1, 1:3] == pytest.approx([18.0, 10.0])
    assert np.ptp(np.diff(rows[:, 0])) < 1e-6
    assert np.abs(rows[:, 4]).max() == pytest.approx(1 / 0.743, rel=1e-3)
    planned(capsys, GAPS, *ENDS, "--out", tmp_path / "path.geojson")
    line = json.loads((tmp_path / "path.geojson").read_text())
    assert line["geometry"]["coordinates"][0] == [2.0, 10.0]
    assert line["properties"]["feasible"] is True
    planned(capsys, GAPS, *ENDS, "--out", tmp_path / "path.yaml", "--step", "5")
    poses = yaml.safe_load((tmp_path / "path.yaml").read_text())["poses"]
    assert len(poses) == 7
    assert poses[-1]["pose"]["position"] == {"x": 18.0, "y": 10.0, "z": 0.0}
    planned(capsys, GAPS, *ENDS, "--out", tmp_path / "path.svg")
    assert "</svg>" in (tmp_path / "path.svg").read_text()


@pytest.mark.parametrize("suffix", ["csv", "geojson", "yaml"])
def test_a_path_of_no_length_is_written_too(capsys, tmp_path, suffix):
    out = tmp_path / f"path.{suffix}"
    here = ["--start", "2,10", "--target", "2,10"]
    assert planned(capsys, GAPS, *here, "--out", out)["feasible"] == "yes"
    assert out.stat().st_size > 10


def test_a_path_that_collides_ends_with_status_1(capsys, tmp_path):
    out = tmp_path / "path.csv"
    lines = planned(capsys, GAPS, *ENDS, "--method", "straight_line", "--out", out, fails=True)
    assert re.match(r"no: enters an obstacle at 4\.75,10, ", lines["feasible"])
    assert lines["length"] == "16 m"  # which says nothing beside that of a free path
    assert lines["failure"] == "straight_line: its path is not feasible"
    assert out.is_file()


def test_without_a_path_the_status_is_1(capsys, tmp_path):
    (tmp_path / "none.py").write_text(
        "import numpy as np\nfrom bezierplan.planners import Plan\n\n\n"
        "def plan(problem, rng):\n"
        "    return Plan(None, 0.0, False, 1, np.zeros(1), 'tired', {})\n"
    )
    out = tmp_path / "path.csv"
    words = [GAPS, *ENDS, "--method", tmp_path / "none.py", "--out", out]
    lines = planned(capsys, *words, fails=True)
    assert lines["path"] == "none (tired)"
    assert lines["failure"] == f"{tmp_path / 'none.py'}: found no path; {out} is not written"
    assert not out.exists()


def test_a_target_that_cannot_be_reached_ends_with_status_1(capsys, tmp_path):
    (tmp_path / "room.txt").write_text("..#.\n..#.\n")
    ends = ["--start", "0.5,0.5", "--target", "3.5,0.5"]
    lines = planned(capsys, tmp_path / "room.txt", *ends, fails=True)
    assert lines["failure"] == "--target: 3.5,0.5: no free way leads there from the start"


def test_what_editors_and_windows_write_is_read(capsys, tmp_path):
    """A byte order mark, blank lines at the end, line ends of Windows, suffixes in capitals, and a
    path of another machine.
    """
    Image.fromarray(np.full((3, 4), 254, dtype=np.uint8)).save(tmp_path / "room.png")
    room = "image: C:\\maps\\room.png\nresolution: 0.5\norigin: [-1.0, 2.0, 0.0]\n"
    for name, text in {
        "a.TXT": "....\r\n.##.\r\n....\r\n\r\n",
        "a.geojson": (BENCHMARK_MAPS / "gaps.geojson").read_text(),
        "a.yaml": room,
    }.items():
        (tmp_path / name).write_bytes(b"\xef\xbb\xbf" + text.encode())
        ends = ["--start", "-0.9,2.5"] if name == "a.yaml" else ["--start", "0.5,2.5"]
        found = planned(capsys, tmp_path / name, *ends, "--target", "0.9,2.5")
        assert found["feasible"] == "yes"


FAULTS = {
    "start in an obstacle": (
        [GAPS, "--start", "5,10", "--target", "18,10"],
        "--start: .*in an obstacle; expected a free place",
    ),
    "target outside": (
        [GAPS, "--start", "2,10", "--target", "99,10"],
        "--target: .*outside the workspace; expected x from 0 to 20",
    ),
    "no target": ([GAPS, "--start", "2,10"], "--target: None; expected x and y"),
    "words": ([GAPS, "--start", "here", "--target", "18,10"], "--start: here; expected X,Y"),
    "no map": (["nowhere.geojson", *ENDS], "nowhere.geojson: cannot be read"),
    "kind of map": (
        ["room.dwg", *ENDS],
        "room.dwg: unknown kind of map; expected a file that ends in .geojson",
    ),
    "planner": ([GAPS, *ENDS, "--method", "pmr"], "--method: pmr: unknown; did you mean prm"),
    "method of a study": (
        [GAPS, *ENDS, "--method", "song2016/smoth"],
        "--method: song2016/smoth: unknown; did you mean song2016/smooth",
    ),
    "study": ([GAPS, *ENDS, "--method", "meledje"], "--method: meledje: unknown.*meledje/proposed"),
    "planner of circles": (
        [CELLS, "--start", "0.5,0.5", "--target", "15.5,0.5", "--method", "chaotic_pso"],
        "--method: chaotic_pso: serves workspaces of kind circles, polygons, and the map is grid",
    ),
    "planner of cells": (
        [GAPS, *ENDS, "--method", "binary_genetic"],
        "--method: binary_genetic: .*the map is polygons; read it with a cell to have a grid",
    ),
    "setting": ([GAPS, *ENDS, "--settings", "{radius: 1}"], "--settings: radius: unknown"),
    "value": (
        [GAPS, *ENDS, "--settings", "{turning_radius: -1}"],
        "--settings: turning_radius: -1; expected a number at least 0",
    ),
    "settings": (
        [GAPS, *ENDS, "--settings", "fast"],
        "--settings: fast: expected '{name: value, ...}'",
    ),
    "out": (
        [GAPS, *ENDS, "--out", "path.pdf"],
        "--out: path.pdf; expected a file that ends in .svg, .png",
    ),
    "the map itself": ([GAPS, *ENDS, "--out", GAPS], "--out: .*with the map's name"),
    "cell": ([GAPS, *ENDS, "--cell", "inf"], "--cell: inf: expected the side of a cell"),
    "folder": (
        [GAPS, *ENDS, "--out", "nowhere/path.svg"],
        "--out: nowhere/path.svg: nowhere is no folder",
    ),
    "step": ([GAPS, *ENDS, "--out", "path.csv", "--step", "1e-9"], "--step: .*expected at most"),
    "a radius below 0": (
        [GAPS, *ENDS, "--robot-radius", "-1"],
        "--robot-radius: -1; expected 0 or a number of at least 1e-06",
    ),
    "rule": ([GAPS, *ENDS, "--cell", "1", "--rule", "some"], "--rule: some: unknown"),
    "unknown option": ([GAPS, *ENDS, "--fast"], "unrecognized arguments: --fast"),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_fault_is_one_line(capsys, fault):
    words, message = FAULTS[fault]
    assert re.search(message, refused(capsys, "plan", *words))


def test_a_straight_path_is_no_longer_than_the_shortest(capsys, tmp_path):
    """No rounding error is printed as a length, a curvature or a clearance."""
    (tmp_path / "room.txt").write_text("...\n...\n...\n")
    lines = planned(capsys, tmp_path / "room.txt", "--start", "0.1,0.3", "--target", "2.7,2.3")
    assert lines["length"].endswith(", 0 % above the shortest path")
    assert lines["curvature"] == "at most 0 / cell at samples"


def test_a_large_map_shows_free_and_occupied_cells_apart(capsys, tmp_path):
    rows, out = 120, tmp_path / "path.png"
    lines = ["." * rows] * rows
    lines[30:60] = ["." * 40 + "#" * 40 + "." * 40] * 30
    (tmp_path / "room.txt").write_text("\n".join(lines) + "\n")
    ends = ["--start", "1,1", "--target", "119,119"]
    planned(capsys, tmp_path / "room.txt", *ends, "--out", out)
    shades = np.asarray(Image.open(out).convert("L"))
    # Lines around cells would darken the free ones. The middle of the map's lower half is free.
    middle = shades[shades.shape[0] // 2 :, shades.shape[1] // 2 - 100 : shades.shape[1] // 2 + 100]
    assert np.mean(middle > 250) > 0.5


def test_answer_of_a_planner_comes_through_the_door(capsys, tmp_path):
    planner = tmp_path / "own.py"
    planner.write_text(OWN.replace("problem.target]", "(18.0, 9.0)]"))
    line = refused(capsys, "plan", GAPS, *ENDS, "--method", planner)
    told = "its answer: path: target: (18.0, 9.0); expected exactly (18.0, 10.0)"
    assert line == f"--method: {planner}: {told}"


def test_a_feasible_path_shorter_than_the_bound_is_no_answer(capsys, monkeypatch, tmp_path):
    """If the bound is wrong, or the checker, no negative gap is printed."""
    (tmp_path / "room.txt").write_text("...\n...\n")
    shortest_path = shortest_paths.shortest_path

    def longer(problem, **options):
        bound = shortest_path(problem, **options)
        return bound._replace(length=bound.length + 1)

    monkeypatch.setattr(shortest_paths, "shortest_path", longer)
    ends = ["--start", "0.5,0.5", "--target", "2.5,0.5"]
    line = refused(capsys, "plan", tmp_path / "room.txt", *ends, "--method", "straight_line")
    assert line.startswith("--method: straight_line: its path is 2 long")
