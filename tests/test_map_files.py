"""Maps that people have: ROS map_server maps and images, and every fault in one line."""

import json

import numpy as np
import pytest
from PIL import Image
from test_workspace_files import closed, geojson

import bezierplan as bp
from bezierplan.workspaces import files, robot

YAML = (
    "image: room.png\nresolution: 0.5\norigin: [-1.0, 2.0, 0.0]\nnegate: 0\noccupied_thresh: "
    "0.65\nfree_thresh: 0.196\n"
)
# Grey values, the top row first: free, unknown and occupied.
PIXELS = np.array([[254, 254, 254, 254], [254, 205, 0, 254], [254, 254, 254, 254]], dtype=np.uint8)


def ros_map(folder, yaml=YAML, pixels=PIXELS, **options):
    Image.fromarray(pixels).save(folder / "room.png")
    (folder / "room.yaml").write_text(yaml)
    return files.load({"kind": "ros_map", "unit": "m", "file": "room.yaml", **options}, folder)


def test_a_ros_map(tmp_path):
    grid = ros_map(tmp_path)
    assert grid.occupied.tolist() == [[False] * 4, [False, True, True, False], [False] * 4]
    assert grid.bounds == (-1.0, 1.0, 2.0, 3.5)
    again = files.read_json(files.write_json(grid))
    assert np.array_equal(again.occupied, grid.occupied)
    assert again.bounds == grid.bounds


def test_colours_transparency_and_sixteen_bits_are_read(tmp_path):
    coloured = np.stack([PIXELS] * 3 + [np.where(PIXELS == 205, 0, 255)], axis=2).astype(np.uint8)
    coloured[1, 1, :3] = 254  # transparent, so unknown
    assert np.array_equal(ros_map(tmp_path, pixels=coloured).occupied, ros_map(tmp_path).occupied)
    assert np.array_equal(
        ros_map(tmp_path, pixels=coloured[..., :3]).occupied[1], [False, False, True, False]
    )
    assert np.array_equal(
        ros_map(tmp_path, pixels=PIXELS.astype(np.uint16) * 257).occupied,
        ros_map(tmp_path).occupied,
    )


def test_a_map_that_was_saved_on_another_machine(tmp_path):
    """Like TurtleBot3's: the image's path is that of its author, its header has a comment, all but
    a few pixels are unknown.
    """
    rows, columns = 12, 16
    pixels = np.full((rows, columns), 205, dtype=np.uint8)
    pixels[3:9, 2:13] = 0
    pixels[4:8, 3:12] = 254
    (tmp_path / "map.pgm").write_bytes(
        b"P5\n# CREATOR: map_saver.cpp 0.050 m/pix\n%d %d\n255\n" % (columns, rows)
        + pixels.tobytes()
    )
    (tmp_path / "map.yaml").write_text(
        "image: /home/somebody/map.pgm\nresolution: 0.050000\norigin: [-10.000000, -10.000000, "
        "0.000000]\nnegate: 0\n"
        "occupied_thresh: 0.65\nfree_thresh: 0.196\n\n"
    )
    described = {"kind": "ros_map", "unit": "m", "file": "map.yaml"}
    grid = files.load(described, tmp_path)
    assert np.array_equal(~grid.occupied, (pixels == 254)[::-1])
    assert grid.bounds == pytest.approx((-10.0, -9.2, -10.0, -9.4))
    assert files.sources(described, tmp_path)[1] == tmp_path / "map.pgm"
    (tmp_path / "map.pgm").unlink()
    with pytest.raises(ValueError, match=r"image: /home/somebody/map\.pgm: no such file"):
        files.load(described, tmp_path)


def test_negated_colours(tmp_path):
    assert np.array_equal(
        ros_map(tmp_path, YAML.replace("negate: 0", "negate: 1"), 255 - PIXELS).occupied,
        ros_map(tmp_path).occupied,
    )


GREY = np.array([[0, 60, 100, 101], [128, 205, 254, 255]], dtype=np.uint8)


@pytest.mark.parametrize(
    ("mode", "unknown", "free"),
    [
        ("trinary", "occupied", "......##"),
        ("trinary", "free", "..######"),
        ("scale", "occupied", "......##"),
        ("scale", "free", "......##"),
        ("raw", "occupied", "#......."),
        ("raw", "free", "#..#####"),
    ],
)
def test_modes_and_unknown_pixels(tmp_path, mode, unknown, free):
    """Of map_server's modes: in `raw` a pixel is its occupancy in percent; above 100 it is unknown,
    and so is a grey one in `trinary`.
    """
    grid = ros_map(tmp_path, f"{YAML}mode: {mode}\n", GREY, unknown=unknown)
    assert "".join(".#"[int(cell)] for cell in ~grid.occupied[::-1].ravel()) == free


@pytest.mark.parametrize("yaw", ["-nan", ".nan", "6.283185307179586", "1e-9"])
def test_a_yaw_that_is_none(tmp_path, yaw):
    """map_saver writes nan for an orientation that is not valid."""
    grid = ros_map(tmp_path, YAML.replace("2.0, 0.0]", f"2.0, {yaw}]"))
    assert grid.bounds == (-1.0, 1.0, 2.0, 3.5)


def test_an_image_without_a_yaml_file(tmp_path):
    Image.fromarray(PIXELS).save(tmp_path / "room.PNG")
    grid = bp.read_map(tmp_path / "room.PNG", resolution=0.5)
    assert grid.occupied.tolist() == [[False] * 4, [False, True, True, False], [False] * 4]
    assert grid.bounds == (0.0, 2.0, 0.0, 1.5)
    assert bp.read_map(tmp_path / "room.PNG", resolution=0.5, unknown="free").occupied.sum() == 1
    large = np.kron(PIXELS, np.ones((16, 16), dtype=np.uint8))  # whole blocks of a JPEG
    for name in ("room.jpg", "room.JPEG", "room.tif", "room.tiff", "room.bmp", "room.pgm"):
        Image.fromarray(large).save(tmp_path / name)
        read = bp.read_map(tmp_path / name, resolution=0.5 / 16)
        assert np.array_equal(read.occupied[::16, ::16], grid.occupied)
        assert read.bounds == grid.bounds
    with pytest.raises(ValueError, match="resolution: missing key; the side of a pixel"):
        bp.read_map(tmp_path / "room.PNG")
    with pytest.raises(ValueError, match=r"nowhere\.png: image: nowhere.png: cannot be read"):
        bp.read_map(tmp_path / "nowhere.png", resolution=1.0)


# Two walls, and a room of 20 x 10 m.
WALLS = [
    [closed((8, 0), (9, 0), (9, 7), (8, 7))],
    [closed((14, 3), (15, 3), (15, 10), (14, 10))],
]
ROOM = closed((0, 0), (20, 0), (20, 10), (0, 10))


def test_a_margin_is_for_files_without_a_border(tmp_path):
    court = json.dumps({"type": "MultiPolygon", "coordinates": WALLS})
    (tmp_path / "court.geojson").write_text(court)
    assert bp.read_map(tmp_path / "court.geojson", margin=2).bounds == (6, 17, -2, 12)
    assert bp.read_map(tmp_path / "court.geojson", margin=2, cell=0.5).bounds[0] == 5.75
    (tmp_path / "room.geojson").write_text(geojson(*WALLS, border=ROOM))
    for file, options, told in (
        (
            "court.geojson",
            {},
            "court.geojson: no border; expected a polygon with role border",
        ),
        ("room.geojson", {"margin": 2}, "^margin: 2: the file has a border of its own"),
        (
            "court.geojson",
            {"margin": -1},
            "^margin: -1: expected in a file without a border",
        ),
        ("court.geojson", {"resolution": 1.0}, "^resolution: not for maps of kind polygons"),
        ("court.geojson", {"unknown": "free"}, "^unknown: not for maps of kind polygons"),
    ):
        with pytest.raises(ValueError, match=told):
            bp.read_map(tmp_path / file, **options)


ROS_FAULTS = {
    "resolution of 0": (("resolution: 0.5", "resolution: 0"), "resolution: 0: expected units per"),
    "no image": (("image: room.png", "image: hall.png"), "image: hall.png: no such file"),
    "no key image": (("image: room.png\n", ""), "image: missing key; the name of an image"),
    "turned": (("2.0, 0.0]", "2.0, 0.3]"), "origin: .*: expected .x, y, 0."),
    "origin": (("[-1.0, 2.0, 0.0]", "here"), "origin: 'here': expected .x, y, 0."),
    "mode": (("negate: 0", "negate: 0\nmode: Raw"), "mode: Raw: unknown; did you mean raw"),
    "misspelt": (("negate: 0", "occupied_threshold: 1"), "occupied_threshold: unknown key; did"),
    "no mapping": ((YAML, "just a word\n"), "'just a word': expected a mapping with image"),
    "an image elsewhere": (("room.png", "/etc/passwd"), "image: /etc/passwd: no such file in"),
    "an image that is text": (("room.png", "room.yaml"), ".*cannot be read as an image"),
    "a resolution twice": (
        ("negate: 0", "resolution: 1"),
        "room.yaml: line 4: resolution: this key",
    ),
}


@pytest.mark.parametrize("fault", ROS_FAULTS)
def test_ros_fault_is_one_line(tmp_path, fault):
    (old, new), told = ROS_FAULTS[fault]
    with pytest.raises(ValueError, match=f"^room.yaml: {told}") as found:
        ros_map(tmp_path, YAML.replace(old, new))
    assert "\n" not in str(found.value)


def test_a_huge_image_is_refused_before_it_is_read(tmp_path):
    (tmp_path / "huge.pgm").write_bytes(b"P5\n5000 4000\n255\n")
    with pytest.raises(ValueError, match="4,000 x 5,000 cells; expected at most 16,000,000"):
        bp.read_map(tmp_path / "huge.pgm", resolution=1.0)


def test_a_robots_radius_leaves_cells_free_that_are_as_far():
    wide = np.zeros((11, 11), dtype=bool)
    wide[5, 5] = True
    # The eight cells around an occupied one touch it; those beyond are 0.5 m away from it, as are
    # those beside the border from that.
    for radius, occupied in {0.5: 9 + 40, 0.5 + 1e-6: 9 + 12 + 40 + 32}.items():
        assert robot.by_cells(bp.Grid(wide, 0.5, "m"), radius).occupied.sum() == occupied
