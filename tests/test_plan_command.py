"""`python -m bezierplan plan`: one path on a map of any kind, its examples, and every fault in one
line with status 2.
"""

import contextlib
import importlib.util
import json
import re
import shlex

import numpy as np
import pytest
import yaml
from fields import BENCHMARK_MAPS
from PIL import Image

import bezierplan as bp
from bezierplan.__main__ import main
from bezierplan.commands.plan import EXAMPLES
from bezierplan.geometry import shortest_paths

GAPS = str(BENCHMARK_MAPS / "gaps.geojson")
CELLS = str(BENCHMARK_MAPS.parents[1] / "song2016" / "workspaces" / "figure2.txt")
ENDS = ["--start", "2,10", "--target", "18,10"]
SHORTEST = 29.565803670


# Through the middle of each gap.
OWN = """
import numpy as np
from bezierplan.planners import Path, Plan

def plan(problem, rng):
    way = [problem.start, (5.0, 15.0), (10.0, 5.0), (15.0, 15.0), problem.target]
    return Plan.of_one(Path("polyline", np.array(way)), 1.0, "told")
"""


def planned(capsys, *words):
    main(["plan", *map(str, words)])
    lines = capsys.readouterr().out.splitlines()
    return {line[:16].strip().replace("shortest path", "shortest"): line[16:] for line in lines}


def refused(capsys, *words, status=2):
    with pytest.raises(SystemExit) as found:
        main(["plan", *map(str, words)])
    told = capsys.readouterr().err
    assert found.value.code == status
    assert told.count("\n") == 1
    return told


def test_without_a_planner_it_is_the_rounded_shortest_path(capsys):
    found = planned(capsys, GAPS, *ENDS)
    assert found["planner"] == "rounded_shortest_path"
    assert found["shortest"] == "29.5658 m"
    assert found["feasible"] == "yes"
    length, gap = re.fullmatch(
        r"([\d.]+) m, ([\d.e-]+) % above the shortest path", found["length"]
    ).groups()
    assert float(length) / SHORTEST - 1 == pytest.approx(float(gap) / 100, abs=1e-5)
    # One over the turning radius of 0.02 times 20 m.
    assert found["curvature"].startswith("at most 2.5")
    assert found["CPU time"].endswith(" s")


ASKED = {
    "nothing more": ([], {}),
    "a radius": (["--robot-radius", "0.3"], {"robot_radius": 0.3}),
    "way points": (
        ["--via", "2,15", "--via", "18,15"],
        {"via": [(2.0, 15.0), (18.0, 15.0)]},
    ),
    "a planner": (
        ["--planner", "chaotic_pso", "--seed", "2"],
        {"method": "chaotic_pso", "seed": 2},
    ),
    "a planner of cells": (
        ["--planner", "binary_genetic", "--cell", "1.25"],
        {"method": "binary_genetic"},
    ),
}


@pytest.mark.parametrize("asked", ASKED)
def test_the_command_and_the_function_plan_alike(asked, capsys, tmp_path):
    words, arguments = ASKED[asked]
    command = tmp_path / "command.csv"
    with contextlib.suppress(SystemExit):  # the straight line is not feasible
        main(["plan", GAPS, *ENDS, *words, "--out", str(command)])
    told = {line[:16].strip(): line[16:] for line in capsys.readouterr().out.splitlines()}
    cell = 1.25 if "--cell" in words else None
    problem = bp.Problem("", bp.read_map(GAPS, cell=cell), (2.0, 10.0), (18.0, 10.0))
    answer = bp.plan(problem, **arguments)
    answer.to_csv(tmp_path / "function.csv")
    assert command.read_bytes() == (tmp_path / "function.csv").read_bytes()
    settings = [
        f"{name} {'any' if value is None else value}" for name, value in answer.settings.items()
    ]
    assert told["settings"] == (", ".join(settings) or "none")
    assert told["length"].startswith(f"{answer.length:.6g} m")
    assert told["feasible"].startswith("yes") == answer.feasible


@pytest.mark.parametrize("name", ["rounded_shortest_path", "prm"])
def test_a_planner_of_one_s_own_may_have_any_name(name, capsys, tmp_path):
    """That of one of this package, whose settings and way points it does not have."""
    file = tmp_path / f"{name}.py"
    file.write_text(OWN)
    assert planned(capsys, GAPS, *ENDS, "--planner", file)["length"].startswith("34.0226 m")
    spec = importlib.util.spec_from_file_location(name, file)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    module.plan.__name__ = name
    problem = bp.Problem("", bp.read_map(GAPS), (2.0, 10.0), (18.0, 10.0))
    for method in (str(file), module, module.plan):
        assert bp.plan(problem, method).length == pytest.approx(2 * (34**0.5 + 125**0.5))
        with pytest.raises(ValueError, match="via: only for"):
            bp.plan(problem, method, via=[(2.0, 15.0)])


def test_help_has_examples_that_run(capsys, monkeypatch, tmp_path):
    with pytest.raises(SystemExit) as found:
        main(["plan", "--help"])
    assert not found.value.code
    shown = capsys.readouterr().out
    assert EXAMPLES.strip() in shown
    commands = re.findall(r"python -m bezierplan (plan (?:.|\n)*?)\n(?:\n|$)", EXAMPLES)
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
    assert np.abs(rows[:, 4]).max() == pytest.approx(2.5, rel=1e-3)
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


def test_a_path_that_collides_is_told_with_the_place_and_by_the_status(capsys, tmp_path):
    with pytest.raises(SystemExit) as found:
        main(
            ["plan", GAPS, *ENDS, "--planner", "straight_line", "--out", str(tmp_path / "path.csv")]
        )
    assert found.value.code == 1
    told = capsys.readouterr()
    assert re.search(r"^feasible +no: enters an obstacle at 4\.75,10, ", told.out, re.MULTILINE)
    assert re.search(r"^length .* % below the shortest path$", told.out, re.MULTILINE)
    assert told.err == "--planner: straight_line: its path is not feasible\n"
    assert (tmp_path / "path.csv").is_file()


def test_a_planner_that_leaves_the_folder_does_not_take_the_file_along(
    capsys, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "leaves.py").write_text(
        "import os\nfrom bezierplan.planners import straight_line\n\n\n"
        "def plan(problem, rng):\n"
        '    os.chdir("elsewhere")\n'
        "    return straight_line.plan(problem, rng)\n"
    )
    (tmp_path / "room.txt").write_text("....\n")
    ends = ["--start", "0.5,0.5", "--target", "3.5,0.5"]
    planned(capsys, "room.txt", *ends, "--planner", "leaves.py", "--out", "path.csv")
    assert (tmp_path / "path.csv").is_file()


def test_without_a_path_the_status_is_1(capsys, tmp_path):
    (tmp_path / "none.py").write_text(
        "import numpy as np\nfrom bezierplan.planners import Plan\n\n\n"
        "def plan(problem, rng):\n"
        "    return Plan(None, 0.0, False, 1, np.zeros(1), 'tired', {})\n"
    )
    words = [GAPS, *ENDS, "--planner", tmp_path / "none.py"]
    told = f"--planner: {tmp_path / 'none.py'}: found no path"
    assert refused(capsys, *words, status=1) == told + "\n"
    out = tmp_path / "path.csv"
    assert refused(capsys, *words, "--out", out, status=1) == f"{told}; {out} is not written\n"
    assert not out.exists()


def test_a_planner_takes_its_settings_from_its_study_and_a_seed_decides(capsys):
    one, other, again = (
        planned(
            capsys,
            GAPS,
            *ENDS,
            "--planner",
            "prm",
            "--settings",
            "{nodes: 800}",
            "--cell",
            0.2,
            "--seed",
            seed,
        )
        for seed in (1, 2, 1)
    )
    assert "nodes 800, " in one["settings"]
    assert one["length"] == again["length"] != other["length"]


def test_other_kinds_of_map(capsys, tmp_path):
    (tmp_path / "room.txt").write_text("....\n.##.\n....\n")
    found = planned(capsys, tmp_path / "room.txt", "--start", "0.5,1.5", "--target", "3.5,1.5")
    assert found["shortest"] == "3.41421 cell"
    Image.fromarray(
        np.array([[254, 254, 254], [254, 0, 254], [254, 254, 254]], dtype=np.uint8)
    ).save(tmp_path / "room.pgm")
    (tmp_path / "room.yaml").write_text("image: room.pgm\nresolution: 2\norigin: [-3, -3, 0]\n")
    found = planned(
        capsys,
        tmp_path / "room.yaml",
        "--start=-2,0",
        "--target",
        "2,0",
        "--settings",
        "{turning_radius: 0}",
    )
    assert found["shortest"] == "4.82843 m"
    (tmp_path / "room.map").write_text("type octile\nheight 2\nwidth 3\nmap\n...\n.@.\n")
    found = planned(capsys, tmp_path / "room.map", "--start", "0.5,0.5", "--target", "2.5,0.5")
    assert found["shortest"] == "2.41421 cell"


def test_blanks_at_the_end_of_lines_of_cells_say_nothing(capsys, tmp_path):
    ends = ("--start", "0.5,0.5", "--target", "3.5,2.5")
    head = "type octile\nheight 3\nwidth 4\nmap\n"
    for name, text in {
        "room.txt": "....  \n.##.\t\n....\n  \n",
        "room.map": f"{head}....  \n.@@.\n.... \n \n\n",
    }.items():
        (tmp_path / name).write_text(text)
        assert planned(capsys, tmp_path / name, *ends)["shortest"] == "4.13065 cell"


@pytest.mark.parametrize("suffix", ["csv", "geojson", "yaml"])
def test_a_path_of_no_length_is_written_too(capsys, tmp_path, suffix):
    out = tmp_path / f"path.{suffix}"
    here = ["--start", "2,10", "--target", "2,10"]
    assert planned(capsys, GAPS, *here, "--out", out)["feasible"] == "yes"
    if suffix == "csv":
        rows = np.loadtxt(out, delimiter=",", skiprows=1)
        assert rows[:, :3].tolist() == [[0.0, 2.0, 10.0]] * 2


def test_a_step_of_0_in_python_is_refused_like_that_of_the_command(tmp_path):
    room = bp.Grid(np.zeros((4, 4), dtype=bool), cell=1.0, unit="m")
    answer = bp.plan(bp.Problem("room", room, (0.5, 0.5), (3.5, 3.5)))
    with pytest.raises(ValueError, match=r"step: 0; expected a number above 0"):
        answer.to_csv(tmp_path / "path.csv", step=0)


FAULTS = {
    "start in an obstacle": (
        [GAPS, "--start", "5,10", "--target", "18,10"],
        "start: .*in an obstacle; expected a free place",
    ),
    "target outside": (
        [GAPS, "--start", "2,10", "--target", "99,10"],
        "target: .*outside the workspace; expected x from 0 to 20",
    ),
    "no target": ([GAPS, "--start", "2,10"], "--target: missing; expected X,Y"),
    "words": ([GAPS, "--start", "here", "--target", "18,10"], "--start: here; expected X,Y"),
    "no map": (["nowhere.geojson", *ENDS], "nowhere.geojson: cannot be read"),
    "kind of map": (
        ["room.dwg", *ENDS],
        "room.dwg: unknown kind of map; expected a file that ends in .geojson",
    ),
    "planner": ([GAPS, *ENDS, "--planner", "pmr"], "--planner: pmr: unknown; did you mean prm"),
    "planner of circles": (
        [CELLS, "--start", "0.5,0.5", "--target", "15.5,0.5", "--planner", "chaotic_pso"],
        "serves workspaces of kind circles, polygons, and a map is grid",
    ),
    "setting": ([GAPS, *ENDS, "--settings", "{radius: 1}"], "--settings: radius: unknown"),
    "value": (
        [GAPS, *ENDS, "--settings", "{turning_radius: -1}"],
        "--settings: turning_radius: -1; expected a number from 0 to 100000",
    ),
    "settings": (
        [GAPS, *ENDS, "--settings", "fast"],
        "--settings: fast: expected '{name: value, ...}'",
    ),
    "out": (
        [GAPS, *ENDS, "--out", "path.pdf"],
        "--out: path.pdf; expected a file that ends in .svg, .png",
    ),
    "like": ([GAPS, *ENDS, "--like", "smooth"], "--like: smooth; expected STUDY/METHOD"),
    "cell": (
        [GAPS, *ENDS, "--planner", "prm", "--cell", "0"],
        "--cell: 0; expected a number above 0",
    ),
    "endless cell": (
        [GAPS, *ENDS, "--planner", "prm", "--cell", "inf"],
        "--cell: inf; expected a number above 0",
    ),
    "folder": (
        [GAPS, *ENDS, "--out", "nowhere/path.svg"],
        "--out: nowhere/path.svg: no folder nowhere; expected one that exists",
    ),
    "seed": ([GAPS, *ENDS, "--seed", "-1"], "--seed: -1; expected a whole number of at least 0"),
    "radius": (
        ["a.yaml", *ENDS, "--robot-radius", "-1"],
        "--robot-radius: -1; expected 0 or a number of at least 1e-06",
    ),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_fault_is_one_line(capsys, fault):
    words, told = FAULTS[fault]
    assert re.search(told, refused(capsys, *words))


def test_a_planner_has_its_settings_away_from_the_projects_folder(capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    assert planned(capsys, GAPS, *ENDS, "--planner", "prm", "--cell", 0.5)["planner"] == "prm"


def test_a_straight_path_is_no_longer_than_the_shortest(capsys, tmp_path):
    """No rounding error is printed as a length, a curvature or a clearance."""
    (tmp_path / "room.txt").write_text("...\n...\n...\n")
    found = planned(capsys, tmp_path / "room.txt", "--start", "0.1,0.3", "--target", "2.7,2.3")
    assert found["length"].endswith(", 0 % above the shortest path")
    assert found["curvature"] == "at most 0 / cell"


def test_a_large_map_shows_free_and_occupied_cells_apart(capsys, tmp_path):
    rows = 120
    lines = ["." * rows] * rows
    lines[30:60] = ["." * 40 + "#" * 40 + "." * 40] * 30
    (tmp_path / "room.txt").write_text("\n".join(lines) + "\n")
    planned(
        capsys,
        tmp_path / "room.txt",
        "--start",
        "1,1",
        "--target",
        "119,119",
        "--out",
        tmp_path / "path.png",
    )
    shades = np.asarray(Image.open(tmp_path / "path.png").convert("L"))
    # Lines around cells would darken the free ones. The middle of the map's lower half is free.
    middle = shades[shades.shape[0] // 2 :, shades.shape[1] // 2 - 100 : shades.shape[1] // 2 + 100]
    assert np.mean(middle > 250) > 0.5


def test_a_target_that_cannot_be_reached_is_told(capsys, tmp_path):
    (tmp_path / "room.txt").write_text("..#.\n..#.\n")
    words = ["--start", "0.5,0.5", "--target", "3.5,0.5"]
    told = refused(capsys, tmp_path / "room.txt", *words, status=1)
    assert (
        told
        == "--target: 3.5,0.5: no free way leads there from the start; expected one that can be "
        "reached\n"
    )


# What a planner answers, or does before it does, and what is told of it. The room has a wall
# between start and target.
ANSWERS = {
    "elsewhere": (
        "line[1] = (1.5, 0.5)",
        "answer",
        "its answer: path: target: (1.5, 0.5); expected exactly (3.5, 0.5)",
    ),
    "nothing": ("", "None", "its answer: is a NoneType; expected a Plan"),
    "an error": ("{}[1]", "answer", "KeyError: 1"),
    "an error of two lines": ('raise ValueError("a\\nb")', "answer", "ValueError: a b"),
    "an exit": ("raise SystemExit(0)", "answer", "sys.exit: 0"),
    "an empty map": (
        "problem.workspace.occupied[:] = False",
        "answer",
        "ValueError: assignment destination is read-only",
    ),
    "another map": (
        'object.__setattr__(problem.workspace, "occupied", ~problem.workspace.occupied)',
        "answer",
        "problem: : workspace: occupied: is another after the run; "
        "a planner copies what it changes",
    ),
}


@pytest.mark.parametrize("name", ANSWERS)
def test_answer_of_a_planner_comes_through_the_door(capsys, tmp_path, name):
    code, given, told = ANSWERS[name]
    (tmp_path / "room.txt").write_text("....\n.#..\n.#..\n")
    planner = tmp_path / "own.py"
    planner.write_text(
        "import numpy as np\nfrom bezierplan.planners import Path, Plan\n\n\ndef plan(problem, "
        "rng):\n"
        f"    line = np.array([problem.start, problem.target])\n    {code}\n"
        '    answer = Plan(Path("polyline", line), 1.0, True, 1, np.array([1.0]), "done", {})\n'
        f"    return {given}\n"
    )
    words = [
        tmp_path / "room.txt",
        "--start",
        "0.5,0.5",
        "--target",
        "3.5,0.5",
        "--planner",
        planner,
    ]
    assert refused(capsys, *words) == f"--planner: {planner}: {told}\n"


def test_a_feasible_path_shorter_than_the_bound_is_no_answer(capsys, monkeypatch, tmp_path):
    """If the bound is wrong, or the checker, no negative gap is printed."""
    (tmp_path / "room.txt").write_text("...\n...\n")
    found = shortest_paths.shortest_path
    monkeypatch.setattr(
        shortest_paths,
        "shortest_path",
        lambda problem, **known: (bound := found(problem, **known))._replace(
            length=bound.length + 1
        ),
    )
    told = refused(
        capsys,
        tmp_path / "room.txt",
        "--start",
        "0.5,0.5",
        "--target",
        "2.5,0.5",
        "--planner",
        "straight_line",
    )
    assert told.startswith(
        "--planner: straight_line: "
        "its path is 2 long and feasible, but no free path is shorter than 3: "
    )
