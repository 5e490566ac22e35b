"""Random generators from names."""

import hashlib

import numpy as np


def generator(*parts: str | float) -> np.random.Generator:
    """The random generator that belongs to a name, given in parts, by the sha256 of its text: the
    same in every process and order.
    """
    name = "/".join(map(str, parts))
    return np.random.default_rng(int.from_bytes(hashlib.sha256(name.encode()).digest()))
