"""The old place of `study.reading`, until all who read studies name that."""

from bezierplan.study.reading import load, read_config

__all__ = ["load", "read_config"]
