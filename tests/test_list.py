"""`python -m bezierplan list`."""

import pytest

from bezierplan.__main__ import main


def listed(capsys, *words):
    main(["list", *words])
    return capsys.readouterr().out.splitlines()


def test_list_shows_the_kinds_and_studies_that_are_named(capsys):
    first, *lines = listed(capsys, "methods", "song2016")
    assert first.startswith("song2016, methods: ")
    # One line says what the method is.
    smooth = next(line for line in lines if line.split()[0] == "smooth")
    assert "Genetic algorithm over the cells of a grid" in smooth
    assert any("6 problems" in line for line in listed(capsys, "experiments", "song2016"))
    lines = listed(capsys, "claims", "tables")
    headings = {line.split(":")[0].split(", ")[1] for line in lines if not line.startswith("  ")}
    assert headings == {"claims", "tables"}
    assert any("population" in line for line in listed(capsys, "settings", "song2016"))


def test_list_says_what_an_unknown_word_may_mean(capsys):
    with pytest.raises(SystemExit) as ended:
        main(["list", "metods"])
    assert ended.value.code == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("list: metods: unknown; did you mean methods?")
