"""The chaotic maps of tharwat2018: worked sequences, long-run distributions, clipping, collapse,
and starts.
"""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bezierplan.papers.tharwat2018 import functions as tharwat2018
from bezierplan.planners.parts.chaotic_maps import MAPS, compute_sequence, draw_start

MU = 1.07
CHAOTIC = MAPS[:8]


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("gauss", [0.7, 0.4285714286, 0.3333333333]),
        ("singer", [0.7, 0.8003814, 0.6862518618, 0.811159277, 0.6685115472, 0.8240660084]),
        ("tent", [0.6, 0.8571428571, 0.4761904762, 0.6802721088, 0.9718172983, 0.09394233884]),
        ("circle", [0.7, 0.9756826729, 0.1877940846, 0.3142179422, 0.4410309357, 0.6122163956]),
        ("logistic", [0.7, 0.84, 0.5376, 0.99434496, 0.02249224209, 0.08794536454]),
        ("sine", [0.7, 0.8069944519, 0.5684430032, 0.9745296891, 0.07973215016, 0.2472550737]),
        ("piecewise", [0.7, 0.75, 0.625, 0.9375, 0.15625, 0.390625]),
        ("sinusoidal", [0.7, 0.9117621527, 0.5232620861, 0.6280664915, 0.8348294256, 0.7949476415]),
        ("gauss_printed", [0.7, 1.4285714286, 2.3333333333, 3.0]),
        ("constant", [0.7, 0.7, 0.7]),
    ],
)
def test_first_values(name, expected):
    assert compute_sequence(name, expected[0], len(expected), MU).values == pytest.approx(
        expected, abs=5e-11, rel=1e-9
    )


@pytest.mark.parametrize(
    ("name", "exponent"),
    [
        ("gauss", math.pi**2 / (6 * math.log(2))),
        ("logistic", math.log(2)),
        ("tent", -0.7 * math.log(0.7) - 0.3 * math.log(0.3)),  # slopes 1 / 0.7 and 1 / 0.3
        ("circle", 0.0),
    ],
)
def test_lyapunov_exponents_are_the_known_ones(name, exponent):
    """How fast two sequences part that begin close to each other, as claim C46 measures it."""
    rng = np.random.default_rng(1)
    found = [tharwat2018._estimate_exponent(rng, name, 1e-9, MU) for _ in range(20)]
    assert np.mean(found) == pytest.approx(exponent, abs=0.05)


@given(st.sampled_from(CHAOTIC), st.floats(0, 1), st.floats(0.9, 1.08))
def test_every_value_lies_from_0_to_1_whatever_the_start(name, start, mu):
    values = compute_sequence(name, start, 100, mu).values
    assert ((values >= 0) & (values <= 1)).all()


def test_clipped_values_are_counted_and_the_sequence_goes_on_from_them():
    steep = 1.08
    starts = np.linspace(0, 1, 2001)
    second = [compute_sequence("singer", start, 2, steep) for start in starts]
    # With mu = 1.08 the highest value of the Singer map is 1.0054; at 1 it is 0.
    over = [
        start
        for start, found in zip(starts, second, strict=True)
        if found.clips and found.values[1] == 1
    ]
    assert over
    assert compute_sequence("singer", over[0], 3, steep).values[1:] == pytest.approx(
        [1, 0], abs=1e-12
    )
    assert compute_sequence("singer", over[0], 2, steep).clips == 1
    assert compute_sequence("singer", 0.7, 10_000, MU).clips == 0


@pytest.mark.parametrize(
    ("name", "start", "collapsed_at"),
    [
        ("gauss", 0.5, 2),
        ("gauss", 0.0, 1),
        ("gauss", 0.3141592653589793, 0),
        ("tent", 0.7, 3),
        ("logistic", 0.25, 2),
        ("logistic", 0.75, 1),
        ("piecewise", 0.4, 3),
        ("sinusoidal", 0.9284, 0),
        ("constant", 0.2, 1),
        ("singer", 0.7, 0),
    ],
)
def test_where_a_sequence_collapses(name, start, collapsed_at):
    assert compute_sequence(name, start, 60, MU).collapsed_at == collapsed_at


@pytest.mark.parametrize("name", CHAOTIC)
def test_random_starts_keep_their_sequences_alive(name):
    rng = np.random.default_rng(0)
    starts = [draw_start(rng, name, MU) for _ in range(200)]
    assert all(compute_sequence(name, start, 60, MU).collapsed_at == 0 for start in starts)
    if name == "sinusoidal":
        assert 0.4421 < min(starts) < max(starts) < 0.9285


def test_a_start_that_lives_is_the_first_number_drawn():
    assert draw_start(np.random.default_rng(3), "tent", MU) == np.random.default_rng(3).random()


def test_no_living_start_is_an_error():
    with pytest.raises(ValueError, match="none of 1000 random starts"):
        draw_start(np.random.default_rng(0), "constant", MU)


@pytest.mark.parametrize("start", [-0.1, 1.1, np.nan])
def test_starts_outside_0_to_1_are_refused(start):
    with pytest.raises(ValueError, match="from 0 to 1"):
        compute_sequence("tent", start, 10, MU)
