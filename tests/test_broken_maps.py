"""Broken maps and command lines of `plan`: each is told in one line, with exit status 2, at once
and without a traceback.
"""

import json
import time

import numpy as np
import pytest
from PIL import Image

from bezierplan.__main__ import main

SQUARE = [[4, 4], [6, 4], [6, 6], [4, 6], [4, 4]]
BORDER = [[0, 0], [10, 0], [10, 10], [0, 10], [0, 0]]
ROS = "image: room.png\nresolution: 0.5\norigin: [-1.0, 2.0, 0.0]\n"
CELLS = "....\n.##.\n....\n"


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


# A map's name, its text or bytes, and the line that tells what is wrong with it.
MAPS = {
    "cut off": ("geojson", ONE[:-20], "not GeoJSON (Expecting"),
    "bytes": ("geojson", b"\xff\xfe{\x00}\x00", "is not UTF-8"),
    "zeros and ones": ("txt", "0000\n0110\n", "line 1: unknown character '0'"),
    "an image elsewhere": (
        "yaml",
        ROS.replace("room.png", "/etc/passwd"),
        "image: /etc/passwd: no such file in",
    ),
    "an image that is text": (
        "yaml",
        ROS.replace("room.png", "room.txt"),
        "cannot be read as an image",
    ),
    "a resolution twice": ("yaml", ROS + "resolution: 1\n", "resolution: this key is given twice"),
    "a tag": (
        "yaml",
        ROS + "other: !!python/name:os.system\n",
        "could not determine a constructor for the tag",
    ),
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
    "no cells": (["room.txt", *ENDS, "--cell", "0"], "--cell: 0.0: expected the side of a cell"),
    "cells of a ROS map": (
        ["room.yaml", *ENDS, "--cell", "2"],
        "--cell: not for maps of kind ros_map, as room.yaml is",
    ),
    "a radius below 0": (
        ["room.txt", *ENDS, "--robot-radius", "-1"],
        "--robot-radius: -1; expected 0 or a number of at least 1e-06",
    ),
    "a start below 0": (
        ["room.txt", "--start", "-9.9,-9.5", "--target", "3.5,2.5"],
        "start: (-9.9, -9.5): outside the workspace",
    ),
    "three numbers": (
        ["room.txt", "--start", "1,1,0", "--target", "3.5,2.5"],
        "--start: 1,1,0; expected X,Y",
    ),
    "an out in a file": (
        ["room.txt", *ENDS, "--out", "room.txt/a.svg"],
        "room.txt/a.svg: Not a directory",
    ),
    "an unknown option": (
        ["room.txt", *ENDS, "--radius", "1"],
        "unrecognized arguments: --radius 1; `python -m bezierplan plan --help`",
    ),
    "a missing map": (
        ["no/room.geojson", *ENDS],
        "no/room.geojson: cannot be read (No such file or directory)",
    ),
    "a map of an unknown kind": (["room.dxf", *ENDS], "room.dxf: unknown kind of map"),
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
    (folder / "a.geojson").write_bytes(b"\xef\xbb\xbf" + ONE.encode())
    (folder / "a.yaml").write_bytes(
        b"\xef\xbb\xbf" + ROS.replace("room.png", "C:\\maps\\room.png").encode()
    )
    ends = ["--start", "0.5,2.5", "--target", "0.9,2.5"]
    for name in ("a.TXT", "a.geojson", "a.yaml"):
        assert "feasible        yes" in planned(capsys, name, *ends)


def test_coordinates_may_begin_with_a_minus(folder, capsys):
    assert "feasible        yes" in planned(
        capsys, "room.yaml", "--start", "-0.9,2.5", "--target", "-.5,2.6"
    )
