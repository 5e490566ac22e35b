"""Random integers in kernels are those of numpy's generator."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from bezierplan.planners.parts.random_integers import draw_below, draw_integer


@given(
    st.integers(0, 2**32),
    st.lists(
        st.tuples(st.integers(-(2**40), 2**40), st.integers(1, 2**32 - 1)), min_size=1, max_size=20
    ),
)
def test_integers_are_those_of_the_generator(seed, ranges):
    """Also one after the other, where half of a drawn number may be kept for the next."""
    ours, numpys = np.random.default_rng(seed), np.random.default_rng(seed)
    for low, width in ranges:
        assert draw_integer(ours, low, low + width) == numpys.integers(low, low + width)
    assert ours.bit_generator.state == numpys.bit_generator.state


@given(st.integers(0, 2**32), st.integers(1, 10**6))
def test_below_takes_one_random_number(seed, count):
    ours, numpys = np.random.default_rng(seed), np.random.default_rng(seed)
    assert draw_below(ours, count) == int(numpys.random() * count) < count
    assert ours.bit_generator.state == numpys.bit_generator.state
