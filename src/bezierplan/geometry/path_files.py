"""Files of a sampled path: csv, GeoJSON, and ROS's message of a path."""

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from bezierplan.geometry.samples import Samples


def write_csv(file: Path, samples: Samples, values: Mapping[str, Any]) -> None:
    """Write distance, x, y, heading and curvature of each sample, with nine digits, and a heading
    row.
    """
    np.savetxt(
        file,
        np.column_stack(samples),
        fmt="%.9g",
        delimiter=",",
        header=",".join(Samples._fields),
        comments="",
    )


def write_geojson(file: Path, samples: Samples, values: Mapping[str, Any]) -> None:
    """Write a feature of kind LineString, with the verdict among its properties."""
    properties = {name: values[name] for name in ("feasible", "length", "clearance")}
    line = {"type": "LineString", "coordinates": np.column_stack([samples.x, samples.y]).tolist()}
    write_json(file, {"type": "Feature", "properties": properties, "geometry": line})


def write_json(file: Path, values: Mapping[str, Any]) -> None:
    """Write values as JSON; nan and infinity, which it does not know, become null."""
    file.write_text(json.dumps(_convert_to_plain(values)) + "\n", encoding="utf-8")


def _convert_to_plain(value: Any) -> Any:
    """Convert a value, and all within it, to what JSON knows."""
    if isinstance(value, Mapping):
        return {name: _convert_to_plain(each) for name, each in value.items()}
    if hasattr(value, "_asdict"):
        return _convert_to_plain(value._asdict())
    if hasattr(value, "tolist"):  # of numpy
        return _convert_to_plain(value.tolist())
    if isinstance(value, list | tuple):
        return [_convert_to_plain(each) for each in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def write_ros(file: Path, samples: Samples, values: Mapping[str, Any]) -> None:
    """Write a `nav_msgs/Path` message as YAML.

    A pose's orientation is the heading as a quaternion about z.
    """
    import yaml

    poses = [
        {
            "header": {"frame_id": "map"},
            "pose": {
                "position": {"x": float(x), "y": float(y), "z": 0.0},
                "orientation": {
                    "x": 0.0,
                    "y": 0.0,
                    "z": math.sin(heading / 2),
                    "w": math.cos(heading / 2),
                },
            },
        }
        for x, y, heading in zip(samples.x, samples.y, samples.heading, strict=True)
    ]
    with file.open("w", encoding="utf-8") as lines:
        yaml.safe_dump({"header": {"frame_id": "map"}, "poses": poses}, lines, sort_keys=False)


WRITERS = {".csv": write_csv, ".geojson": write_geojson, ".yaml": write_ros}
"""Suffix -> what writes samples of a path, and values of its verdict."""
