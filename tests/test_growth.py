"""The slopes that `make benchmark` measures, on costs whose growth is known."""

from pathlib import Path

import numpy as np
import pytest

SIZES = np.array([10.0, 20.0, 40.0, 80.0, 160.0, 320.0])


@pytest.fixture
def growth(monkeypatch):
    monkeypatch.syspath_prepend(str(Path(__file__).parent / "benchmark"))
    import growth

    return growth


@pytest.mark.parametrize("power", [0.0, 0.5, 1.0, 2.0, 3.0])
def test_slope_of_a_power_is_its_exponent(growth, power):
    found = growth.slope(SIZES, 0.003 * SIZES**power)
    assert found.value == pytest.approx(power, abs=1e-12)
    assert found.at_one == pytest.approx(0.003)
    assert power == 1 or found.steeper == (power > 1)  # rounding decides at the limit


def test_constant_cost_of_small_sizes_does_not_hide_growth(growth):
    seconds = np.where(SIZES < 40, 1.0, SIZES**2 / 1600)
    assert growth.slope(SIZES, seconds).steeper


def test_linear_cost_with_errors_of_measurement_is_rarely_called_steeper(growth):
    noise = np.exp(np.random.default_rng(0).normal(0, 0.1, (1000, len(SIZES))))
    steeper = [growth.slope(SIZES, SIZES * each).steeper for each in noise]
    quadratic = [growth.slope(SIZES, SIZES**2 * each).steeper for each in noise]
    assert np.mean(steeper) < 0.12
    assert np.mean(quadratic) > 0.99


def test_sizes_are_a_geometric_series_of_whole_numbers(growth):
    assert growth.geometric(4, 128) == [4, 8, 16, 32, 64, 128]
