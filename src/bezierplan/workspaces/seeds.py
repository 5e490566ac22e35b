"""Random generators from names."""

import hashlib

import numpy as np


def generator(name: str) -> np.random.Generator:
    """The random generator that belongs to a name, by its sha256: the same in every process and
    order.
    """
    return np.random.default_rng(int.from_bytes(hashlib.sha256(name.encode()).digest()))
