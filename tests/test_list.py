"""`python -m bezierplan list`."""

from bezierplan.__main__ import main


def listed(capsys, *words):
    main(["list", *words])
    return capsys.readouterr().out.splitlines()


def test_list_shows_the_kinds_and_studies_that_are_named(capsys):
    first, *lines = listed(capsys, "methods", "song2016")
    assert first.startswith("song2016, methods: ")
    # The sentence about a planner stands once.
    assert sum("Genetic algorithm over the cells of a grid" in line for line in lines) == 1
    for key in ("song2016", "elhoseny2017"):
        _, *lines = listed(capsys, "methods", key)
        # No two say the same, beside the printed names.
        assert len({line.partition(": ")[2] for line in lines}) == len(lines)
    assert any("6 problems" in line for line in listed(capsys, "experiments", "song2016"))
    lines = listed(capsys, "claims", "tables")
    headings = {line.split(":")[0].split(", ")[1] for line in lines if not line.startswith("  ")}
    assert headings == {"claims", "tables"}
    assert any("population" in line for line in listed(capsys, "settings", "song2016"))
