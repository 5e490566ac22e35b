"""Random generators from names."""

import hashlib

import numpy as np


def generator(*parts: str | float) -> np.random.Generator:
    """Return the random generator that belongs to a name, given in parts, by the sha256 of its
    text.

    It is the same in every process and order.

    >>> generator("study", 1).random() == generator("study", 1).random()
    True
    """
    name = "/".join(map(str, parts))
    # Python's own hash of a text differs between processes.
    return np.random.default_rng(int.from_bytes(hashlib.sha256(name.encode()).digest()))
