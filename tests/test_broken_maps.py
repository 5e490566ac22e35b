"""Broken maps and command lines of `plan`: each is told in one line, with exit status 2, at once
and without a traceback.
"""

import json
import os
import subprocess
import sys
import time

import numpy as np
import pytest
from PIL import Image

from bezierplan.__main__ import main

SQUARE = [[4, 4], [6, 4], [6, 6], [4, 6], [4, 4]]
BORDER = [[0, 0], [10, 0], [10, 10], [0, 10], [0, 0]]
ROS = "image: room.png\nresolution: 0.5\norigin: [-1.0, 2.0, 0.0]\n"
CELLS = "....\n.##.\n....\n"
MOVING_AI = "type octile\nheight 3\nwidth 4\nmap\n....\n.@@.\n....\n"


def feature(rings, role="obstacle", **more):
    return {
        "type": "Feature",
        "properties": {"role": role},
        "geometry": {"type": "Polygon", "coordinates": rings},
    } | more


def geojson(*features, **more):
    return json.dumps(
        {"type": "FeatureCollection", "features": [feature([BORDER], "border"), *features]} | more
    )


ONE = geojson(feature([SQUARE]))


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The working folder, with a sound map of each kind, and an image outside of it."""
    home = tmp_path / "home"
    home.mkdir()
    for place in (home / "room.png", tmp_path / "outside.png"):
        Image.fromarray(np.full((3, 4), 254, dtype=np.uint8)).save(place)
    for name, text in {
        "room.yaml": ROS,
        "room.txt": CELLS,
        "room.map": MOVING_AI,
        "room.geojson": ONE,
        "line.py": "",
    }.items():
        (home / name).write_text(text)
    (home / "linked.png").symlink_to(tmp_path / "outside.png")
    (home / "folder.svg").mkdir()
    monkeypatch.chdir(home)
    return home


def refused(capsys, *words):
    """The line that `plan` ends with."""
    begun = time.process_time()
    with pytest.raises(SystemExit) as found:
        main(["plan", *words])
    assert time.process_time() - begun < 5
    told = capsys.readouterr().err
    assert found.value.code == 2
    assert told.count("\n") == 1
    assert len(told) < 1200
    assert told.isascii() or told.rstrip("\n").isprintable()
    return told


LONG = "a" * 5000
# A map's name, its text or bytes, and the line that tells what is wrong with it.
MAPS = {
    "an unknown cell of MovingAI": (
        "map",
        MOVING_AI.replace(".@@.", ".@ ."),
        "below the word map: line 2: unknown character ' '",
    ),
    "a width of words": ("map", MOVING_AI.replace("width 4", "width 0_4"), "3 x 4 cells follow"),
    # GeoJSON: what JSON allows, and a map must not.
    "a key twice": (
        "geojson",
        ONE.replace('"features"', '"features": [], "features"'),
        "'features': this key is given twice",
    ),
    "a role twice": (
        "geojson",
        ONE.replace('"role": "obstacle"', '"role": "start", "role": "obstacle"'),
        "'role': this key is given tw",
    ),
    "NaN": (
        "geojson",
        ONE.replace("[6, 4]", "[NaN, 4]"),
        "NaN is not a coordinate; expected finite numbers",
    ),
    "Infinity": ("geojson", ONE.replace("[6, 4]", "[Infinity, 4]"), "Infinity is not a coordinate"),
    "-Infinity": (
        "geojson",
        ONE.replace("[6, 4]", "[6, -Infinity]"),
        "-Infinity is not a coordinate",
    ),
    "beyond floats": ("geojson", ONE.replace("[6, 4]", "[1e999, 4]"), "inf is not a coordinate"),
    "1e308": (
        "geojson",
        ONE.replace("[6, 4]", "[1e308, 4]"),
        "1e+308 is not a coordinate; expected finite numbers of at most 100000",
    ),
    "a huge integer": (
        "geojson",
        ONE.replace("[6, 4]", f"[{'9' * 400}, 4]"),
        "a number is too large for a coordinate",
    ),
    "an endless integer": (
        "geojson",
        ONE.replace("[6, 4]", f"[{'9' * 5000}, 4]"),
        "not a GeoJSON feature collection",
    ),
    "a truth": (
        "geojson",
        ONE.replace("[6, 4]", "[true, 4]"),
        "position [True, 4]; expected [x, y]",
    ),
    "text": (
        "geojson",
        ONE.replace("[6, 4]", '["6", "4"]'),
        "position ['6', '4']; expected [x, y]",
    ),
    "null": ("geojson", ONE.replace("[6, 4]", "[null, 4]"), "position [None, 4]; expected [x, y]"),
    "a mapping": (
        "geojson",
        ONE.replace("[6, 4]", '{"x": 6}'),
        "position {'x': 6}; expected [x, y]",
    ),
    "one height": (
        "geojson",
        ONE.replace("[6, 4]", "[6, 4, 1]"),
        "position [6, 4, 1]; expected [x, y], or [x, y, height] throughout",
    ),
    "nested lists": ("geojson", ONE.replace("[6, 4]", "[" * 100_000), "nested too deeply"),
    "nested mappings": ("geojson", '{"features": ' + '{"a": ' * 100_000, "nested too deeply"),
    "longitudes": (
        "geojson",
        geojson(crs={"properties": {"name": "urn:ogc:def:crs:OGC:1.3:CRS84"}}),
        "crs: longitudes and latitudes",
    ),
    "an EPSG code": (
        "geojson",
        geojson(crs={"properties": {"name": "urn:ogc:def:crs:EPSG::4326"}}),
        "crs: longitudes and latitudes",
    ),
    "one feature": (
        "geojson",
        json.dumps(feature([BORDER])),
        "no border; expected a polygon with role border, a bbox, or a margin",
    ),
    "a geometry collection": (
        "geojson",
        geojson(type="GeometryCollection"),
        "type: GeometryCollection; expected FeatureCollection",
    ),
    "no feature": (
        "geojson",
        geojson(feature([SQUARE], type="Point")),
        "feature 1: type: Point; expected Feature",
    ),
    "a list": ("geojson", "[1, 2]", "expected an object with a list of features"),
    "a number": ("geojson", "7", "expected an object with a list of features"),
    "features a mapping": (
        "geojson",
        '{"features": {}}',
        "expected an object with a list of features",
    ),
    "empty GeoJSON": ("geojson", "", "not a GeoJSON feature collection"),
    "cut off": ("geojson", ONE[:-20], "not a GeoJSON feature collection"),
    "a long role": ("geojson", geojson(feature([SQUARE], LONG)), "properties: role: 'aaa"),
    "a role with an escape": (
        "geojson",
        geojson(feature([SQUARE], "a\n\x1b[31mb")),
        "role: 'a\\n\\x1b[31mb': unknown",
    ),
    "a ring of words": (
        "geojson",
        geojson(feature(["abcd"])),
        "ring 0: expected at least four positions",
    ),
    "bytes": ("geojson", b"\xff\xfe{\x00}\x00", "is not UTF-8"),
    # Texts of cells.
    "a vertical tab": ("txt", "....\n.\x0b#.\n", "line 2: unknown character '\\x0b'"),
    "a form feed": ("txt", "..\x0c..\n.....\n", "line 1: unknown character '\\x0c'"),
    "a line separator": ("txt", "..\u2028..\n", "line 1: unknown character '\\u2028'"),
    "a space before cells": ("txt", "....\n ....\n", "line 2: unknown character ' '"),
    "full-width dots": ("txt", "....\n．．．．\n", "line 2: unknown character"),
    "a blank line within": ("txt", "....\n\n....\n", "line 2 has 0 cells, the first line has 4"),
    "only blank lines": ("txt", "\n\n\n", "the map is empty"),
    "zeros and ones": ("txt", "0000\n0110\n", "line 1: unknown character '0'"),
    "a long line of words": ("txt", LONG + "\n", "line 1: unknown character 'a'"),
    # MovingAI.
    # ROS.
    "an image elsewhere": (
        "yaml",
        ROS.replace("room.png", "/etc/passwd"),
        "image: /etc/passwd: no such file in",
    ),
    "an image above": (
        "yaml",
        ROS.replace("room.png", "../outside.png"),
        "image: ../outside.png: no such file in",
    ),
    "an image through a link": (
        "yaml",
        ROS.replace("room.png", "linked.png"),
        "image: linked.png: no such file in",
    ),
    "an image far above": (
        "yaml",
        ROS.replace("room.png", "../" * 50 + "etc/passwd"),
        "no such file in",
    ),
    "an image of a long name": ("yaml", ROS.replace("room.png", LONG), "no such file in"),
    "an image with NUL": ("yaml", ROS.replace("room.png", '"a\\0b"'), "no such file in"),
    "an image with a newline": (
        "yaml",
        ROS.replace("room.png", '"a\\nb"'),
        "image: a\\nb: no such file in",
    ),
    "an image without a name": ("yaml", ROS.replace("room.png", '""'), "no such file in"),
    "an image that is a folder": ("yaml", ROS.replace("room.png", "folder.svg"), "no such file in"),
    "an image that is text": (
        "yaml",
        ROS.replace("room.png", "room.txt"),
        "cannot be read as an image",
    ),
    "images": ("yaml", ROS.replace("room.png", "[room.png]"), "expected the name of an image"),
    "a number for an image": (
        "yaml",
        ROS.replace("room.png", "7"),
        "image: 7; expected the name of an image",
    ),
    "a resolution of nan": (
        "yaml",
        ROS.replace("0.5", ".nan"),
        "resolution: nan; expected a number",
    ),
    "a resolution of inf": (
        "yaml",
        ROS.replace("0.5", ".inf"),
        "resolution: inf; expected a number",
    ),
    "a resolution of 1e308": ("yaml", ROS.replace("0.5", "1e308"), "is not a coordinate"),
    "a resolution of a truth": (
        "yaml",
        ROS.replace("0.5", "true"),
        "resolution: True; expected a number",
    ),
    "a huge resolution": ("yaml", ROS.replace("0.5", "9" * 5000), "expected a number"),
    "a resolution twice": ("yaml", ROS + "resolution: 1\n", "resolution: this key is given twice"),
    "a resolution in quotes": (
        "yaml",
        ROS.replace("resolution: 0.5", "resolution: '0.5'"),
        "resolution: '0.5'; expected a number",
    ),
    "an origin of one": ("yaml", ROS.replace("[-1.0, 2.0, 0.0]", "[1]"), "expected [x, y, yaw]"),
    "negate of two": ("yaml", ROS + "negate: 2\n", "negate: 2; expected 0 or 1"),
    "nested YAML": ("yaml", ROS + "other: " + "[" * 1000 + "\n", "nested more than 20 levels deep"),
    "a tag": ("yaml", ROS + "other: !!python/name:os.system\n", "tags are not read"),
}


@pytest.mark.parametrize("fault", MAPS)
def test_a_broken_map_is_told(folder, capsys, fault):
    ending, text, told = MAPS[fault]
    (folder / f"broken.{ending}").write_bytes(text if isinstance(text, bytes) else text.encode())
    found = refused(capsys, f"broken.{ending}", "--start", "0.5,0.5", "--target", "9.5,9.5")
    assert found.startswith(f"broken.{ending}: ")
    assert told in found


ENDS = ["--start", "0.5,0.5", "--target", "3.5,2.5"]
LINES = {
    "no cells": (["room.txt", *ENDS, "--cell", "0"], "--cell: 0; expected a number above 0"),
    "cells of nan": (
        ["room.txt", *ENDS, "--cell", "nan"],
        "--cell: nan; expected a number above 0",
    ),
    "cells of a MovingAI map": (
        ["room.map", *ENDS, "--cell", "2"],
        "--cell: only for cells of a text or polygons for a planner",
    ),
    "cells of polygons": (
        ["room.geojson", *ENDS, "--cell", "2"],
        "--cell: only for cells of a text or polygons for a planner",
    ),
    "cells of a ROS map": (["room.yaml", *ENDS, "--cell", "2"], "--cell: only for"),
    "cells of 0 for polygons": (
        ["room.geojson", *ENDS, "--cell", "0"],
        "--cell: 0; expected a number above 0",
    ),
    "a rule of cells": (
        ["room.txt", *ENDS, "--rule", "centre"],
        "only for polygons for a planner that needs cells; room.txt is",
    ),
    "a radius of nan": (
        ["room.txt", *ENDS, "--robot-radius", "nan"],
        "--robot-radius: nan; expected 0 or a number of at least 1e-06",
    ),
    "a radius below 0": (
        ["room.txt", *ENDS, "--robot-radius", "-1"],
        "--robot-radius: -1; expected 0 or a number of at least 1e-06",
    ),
    "pixels below 0": (
        ["room.yaml", *ENDS, "--most-pixels", "-5"],
        "--most-pixels: -5; expected a whole number of at least 1",
    ),
    "pixels of a text": (
        ["room.txt", *ENDS, "--most-pixels", "5"],
        "--most-pixels: only for a ROS map or an image; room.txt is cells of a text",
    ),
    "an endless radius": (
        ["room.txt", *ENDS, "--settings", "{turning_radius: .inf}"],
        "inf; expected a finite number from 0 to 100000",
    ),
    "an offset of nan": (
        ["room.txt", *ENDS, "--settings", "{offset: .nan}"],
        "offset: nan; expected a finite number from 0 to 100000",
    ),
    "a start twice": (["room.txt", "--start", "1,1", *ENDS], "--start: given twice; expected once"),
    "a target twice": (["room.txt", *ENDS, "--target=1,1"], "--target: given twice; expected once"),
    "a start below 0": (
        ["room.txt", "--start", "-9.9,-9.5", "--target", "3.5,2.5"],
        "start: (-9.9, -9.5): outside the workspace",
    ),
    "an endless start": (
        ["room.txt", "--start", "1e999,1", "--target", "3.5,2.5"],
        "outside the workspace",
    ),
    "a start of nan": (
        ["room.txt", "--start", "nan,1", "--target", "3.5,2.5"],
        "--start: nan,1; expected X,Y",
    ),
    "a start with an underscore": (
        ["room.txt", "--start", "1_0,1", "--target", "3.5,2.5"],
        "--start: 1_0,1; expected X,Y",
    ),
    "four numbers": (
        ["room.txt", "--start", "1,1,0,0", "--target", "3.5,2.5"],
        "--start: 1,1,0,0; expected X,Y",
    ),
    "a negative margin": (
        ["room.geojson", *ENDS, "--margin", "-1"],
        "--margin: -1; expected a number of at least 0",
    ),
    "a margin beside a border": (
        ["room.geojson", *ENDS, "--margin", "1"],
        "--margin: 1: the file has a border of its own; expected no",
    ),
    "a margin of cells": (
        ["room.txt", *ENDS, "--margin", "1"],
        "--margin: only for polygons; room.txt is cells",
    ),
    "a resolution of nan": (
        ["room.png", *ENDS, "--resolution", "nan"],
        "--resolution: nan; expected a number above 0",
    ),
    "a resolution of a map": (
        ["room.yaml", *ENDS, "--resolution", "1"],
        "only for an image; room.yaml is a ROS",
    ),
    "an image without a resolution": (
        ["room.png", *ENDS],
        "--resolution: missing; expected the length of a pixel's side, or the YAML",
    ),
    "unknown pixels of cells": (
        ["room.txt", *ENDS, "--unknown", "free"],
        "--unknown: only for a ROS map or an image; room.txt is cells",
    ),
    "unknown pixels of a colour": (
        ["room.yaml", *ENDS, "--unknown", "grey"],
        "argument --unknown: invalid choice: 'grey'",
    ),
    "an out that is a folder": (
        ["room.txt", *ENDS, "--out", "folder.svg"],
        "--out: folder.svg: cannot be written (Is a directory)",
    ),
    "an out in a file": (
        ["room.txt", *ENDS, "--out", "room.map/a.svg"],
        "--out: room.map/a.svg: no folder room.map",
    ),
    "an out of a long name": (
        ["room.txt", *ENDS, "--out", f"{LONG}.svg"],
        "cannot be written (File name too long)",
    ),
    "an out among processes": (
        ["room.txt", *ENDS, "--out", "/proc/path.svg"],
        "--out: /proc/path.svg: cannot be written (",
    ),
    "a unit of two lines": (
        ["room.txt", *ENDS, "--unit", "m\nm"],
        "--unit: 'm\\nm'; expected a name of one line",
    ),
    "a unit without a name": (
        ["room.txt", *ENDS, "--unit", ""],
        "--unit: ''; expected a name of one line",
    ),
    "an unknown option": (
        ["room.txt", *ENDS, "--radius", "1"],
        "unrecognized arguments: --radius 1; `python -m bezierplan plan --help`",
    ),
    "no map": (ENDS, "the following arguments are required: MAP"),
    "an option without a value": (
        ["room.txt", "--start"],
        "argument --start: expected one argument",
    ),
    "a seed in words": (
        ["room.txt", *ENDS, "--seed", "1e3"],
        "argument --seed: invalid int value: '1e3'",
    ),
    "a missing map in a folder": (
        ["no/room.geojson", *ENDS],
        "no/room.geojson: cannot be read (No such file or directory)",
    ),
    "a map of a long name": ([f"{LONG}.txt", *ENDS], "cannot be read (File name too long)"),
    "a map that is a folder": (["folder.svg/../../home/.", *ENDS], "unknown kind of map"),
}


@pytest.mark.parametrize("fault", LINES)
def test_a_wrong_command_line_is_told(folder, capsys, fault):
    words, told = LINES[fault]
    assert told in refused(capsys, *words)
    assert sorted(file.name for file in folder.iterdir() if file.suffix == ".svg") == ["folder.svg"]


def planned(capsys, *words):
    main(["plan", *words])
    return capsys.readouterr().out


def test_what_editors_and_windows_write_is_read(folder, capsys):
    """A byte order mark, blank lines at the end, line ends of Windows, suffixes in capitals, and a
    path of another machine.
    """
    (folder / "a.TXT").write_bytes(
        b"\xef\xbb\xbf" + CELLS.replace("\n", "\r\n").encode() + b"\r\n\r\n"
    )
    (folder / "a.map").write_bytes(b"\xef\xbb\xbf" + MOVING_AI.encode() + b"\n")
    (folder / "a.geojson").write_bytes(b"\xef\xbb\xbf" + ONE.encode())
    (folder / "a.yaml").write_bytes(
        b"\xef\xbb\xbf" + ROS.replace("room.png", "C:\\maps\\room.png").encode() + b"negate: no\n"
    )
    ends = ["--start", "0.5,2.5", "--target", "0.9,2.5"]
    for name in ("a.TXT", "a.map", "a.geojson", "a.yaml"):
        assert "feasible        yes" in planned(capsys, name, *ends)


def test_coordinates_may_begin_with_a_minus(folder, capsys):
    assert "feasible        yes" in planned(
        capsys, "room.yaml", "--start", "-0.9,2.5", "--target", "-.5,2.6"
    )


def test_a_full_disk_is_told(folder, capsys):
    (folder / "full.csv").symlink_to("/dev/full")
    told = refused(capsys, "room.txt", *ENDS, "--out", "full.csv")
    assert told == "--out: full.csv: cannot be written (No space left on device)\n"


def test_a_process_without_an_output_ends_well(folder):
    done = subprocess.run(
        ["sh", "-c", f"exec {sys.executable} -m bezierplan list --studies song2016 >&-"],
        stderr=subprocess.PIPE,
        text=True,
        check=False,
        env=os.environ,
    )
    assert (done.returncode, done.stderr) == (0, "")
