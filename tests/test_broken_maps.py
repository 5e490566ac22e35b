"""Broken maps of `plan`: each is told in one line, with exit status 2, at once and without a
traceback.
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
    """The working folder, with sound maps."""
    Image.fromarray(np.full((3, 4), 254, dtype=np.uint8)).save(tmp_path / "room.png")
    for name, text in {"room.yaml": ROS, "room.txt": CELLS}.items():
        (tmp_path / name).write_text(text)
    monkeypatch.chdir(tmp_path)
    return tmp_path


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
