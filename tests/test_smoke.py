"""Scale smoke, which `make test` makes before the tests, has the numbers that the project keeps."""

import smoke


def test_tables_and_claims_of_scale_smoke_are_those_of_the_project():
    found, kept = smoke.parts(), smoke.kept()
    others = [
        place
        for place in kept.keys() | found.keys()
        if place not in found or kept.get(place) != smoke.digest(found[place])
    ]
    told = "\n".join(
        f"{' '.join(place)}:\n{found[place].to_string(index=False) if place in found else 'none'}"
        for place in sorted(others)
    )
    assert not others, (
        "numbers of scale smoke are others now. Are they meant to be? Then `make smoke-digests`, "
        f"and say why in the commit:\n{told}"
    )


def test_a_number_in_its_fifth_digit_is_another_and_in_its_ninth_is_not():
    part, *_ = smoke.parts().values()
    by = {share: part.assign(value_ours=part["value_ours"] * (1 + share)) for share in (1e-5, 1e-9)}
    assert smoke.digest(by[1e-9]) == smoke.digest(part) != smoke.digest(by[1e-5])
