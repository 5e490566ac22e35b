"""Arrays that nobody can change, such as planners get and results are judged by."""

import numpy as np
from numpy.typing import ArrayLike, DTypeLike


def read_only(values: ArrayLike, dtype: DTypeLike) -> np.ndarray:
    """Return values as an array in rows whose memory is immutable, so that no flag makes it
    writable again; a copy, unless it is one already.

    >>> centres = read_only([[1, 2]], float)
    >>> centres[0, 0] = 3
    Traceback (most recent call last):
    ...
    ValueError: assignment destination is read-only
    """
    if (
        type(values) is np.ndarray
        and values.dtype == dtype
        and isinstance(values.base, bytes)
        and values.flags.c_contiguous
    ):
        return values
    found = np.ascontiguousarray(values, dtype)
    # Memory of bytes: an array of its own could be made writable again.
    return np.ndarray(np.shape(values), found.dtype, found.tobytes())


def freeze(of: object, *names: str) -> None:
    """Make fields of a frozen dataclass read-only arrays of floats."""
    for name in names:
        object.__setattr__(of, name, read_only(getattr(of, name), float))
