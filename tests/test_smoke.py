"""Scale smoke, which `make test` makes before the tests, has the digests that the project keeps."""

import digests
import pandas as pd


def test_scenarios_first_runs_tables_and_figures_are_those_of_the_project():
    found, kept = digests.find("smoke"), digests.read_kept("smoke")
    others = sorted(place for place in kept | found if kept.get(place) != found.get(place))
    assert not others, (
        "these are others now; are they meant to be? Then `make digests`, and say why in the commit"
    )


def test_a_number_in_its_fifth_digit_is_another_and_in_its_ninth_is_not():
    part = pd.DataFrame({"method": ["a", "b"], "value_ours": [1.23456, 7.0]})
    by = {share: part.assign(value_ours=part["value_ours"] * (1 + share)) for share in (1e-5, 1e-9)}
    assert digests.digest(by[1e-9]) == digests.digest(part) != digests.digest(by[1e-5])
