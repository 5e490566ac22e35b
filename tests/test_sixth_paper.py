"""A study of a paper that is not one of the five: nothing of it needs an edit in the package, and
the package knows none of the five by name.
"""

import contextlib
import re
from pathlib import Path

import pandas as pd
import pytest
import starts
from studies import KEYS
from trees import edit

from bezierplan.__main__ import main
from bezierplan.analysis.claims import kinds

ROOT = Path(__file__).parents[1]
# Of two layouts, as many as scale smoke has.
VERDICTS = dict.fromkeys(("C1", "C4", "C5"), "undecided") | {"C6": "untestable"}
VERDICTS |= dict.fromkeys(("C2", "C3"), "supported")


@pytest.fixture(scope="module")
def mine(tmp_path_factory):
    """The example, in the working folder."""
    with contextlib.chdir(tmp_path_factory.mktemp("sixth")):
        main(["new", "mine", "--example"])
        yield Path.cwd() / "mine"


def test_the_engine_names_no_paper():
    """In what runs, which comments and docstrings are not."""
    named = re.compile("|".join(KEYS))
    package = ROOT / "src" / "bezierplan"
    for file in package.rglob("*.py"):
        place = file.relative_to(package).as_posix()
        if place.split("/")[0] in ("papers", "planners"):
            continue
        text = re.sub(r'"""(.|\n)*?"""|#.*|"[^"\n]*such as [^"\n]*"', "", file.read_text())
        assert not named.search(text), place


def test_faults_are_found_at_once(mine, capsys):
    changed = {
        "artefacts.yaml": ("title: every field", "title: 50"),
        "experiments.yaml": ("function: scattered", "function: scatered"),
        "claims.yaml": (
            "name: never_above, experiment: worst, metric: ratio",
            "nam: never_above, experiment: worst, metric: rato, replicat: layout",
        ),
    }
    for name, (old, new) in changed.items():
        edit(mine / name, old, new)
    with pytest.raises(SystemExit):
        main(["check-study", "mine"])
    lines = capsys.readouterr().err.splitlines()
    for name, word in zip(changed, ("quotes", "worlds.py", "nam: unknown key"), strict=True):
        assert sum(f"mine/{name}" in line and word in line for line in lines) == 1, lines
    # Beside an unknown key the others are checked too.
    assert all(any(word in line for line in lines) for word in ("nam:", "rato", "replicat:")), lines
    for name, (old, new) in changed.items():
        edit(mine / name, new, old)
    main(["check-study", "mine"])
    assert "no fault" in capsys.readouterr().out


def test_the_example_runs(mine):
    done = starts.snakemake(
        mine.parent,
        *("-s", ROOT / "Snakefile", "--workflow-profile", "none", "--cores", "2", "smoke"),
        *("--config", "studies=[./mine]"),
    )
    assert done.returncode == 0, done.stderr
    made = mine.parent / "results" / "smoke" / "mine"
    verdicts = pd.read_csv(made / "claims.csv").set_index("id")["verdict"]
    assert verdicts.to_dict() == VERDICTS
    tests = re.findall(r"test: (\w+)", (mine / "claims.yaml").read_text())
    assert sorted(tests) == sorted(kinds.list_kinds())
    # The worst directions, by hand: (24 + 10) / 26 and (14 + 10 sqrt 2) / 26.
    table = (made / "paper" / "table1.csv").read_text()
    assert "1.41,1.00" in table
    assert "1.31,1.08" in table
    assert (made / "paper" / "table1.published.csv").is_file()
    assert (made / "paper" / "figure1.svg").is_file()


def test_names_are_explained(mine, capsys):
    main(["list", "metrics", "mine"])
    said = capsys.readouterr().out
    assert "length of the truly shortest path" in said
    assert "\n  expanded " in said
    main(["list", "worlds"])
    assert "\n  drawn " in capsys.readouterr().out
