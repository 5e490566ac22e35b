"""The examples of docs/python.md give what they print, and its workflow includes this one as a
module.
"""

import doctest
import re
import shutil
from pathlib import Path
from subprocess import CompletedProcess

import pyarrow.parquet as parquet
import pytest
import starts
from trees import edit

from bezierplan.schema.checked import Fault
from bezierplan.study import loading

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "python.md"
BLOCKS = re.findall(r"^```python\n(.*?)^```$", PAGE.read_text(encoding="utf-8"), flags=re.M | re.S)
EXAMPLES = "".join(block for block in BLOCKS if block.startswith(">>> "))
(SNAKEFILE,) = [block for block in BLOCKS if block.startswith("# Snakefile\n")]


def test_examples_give_what_they_print():
    test = doctest.DocTestParser().get_doctest(EXAMPLES, {}, PAGE.name, str(PAGE), 0)
    failed, attempted = doctest.DocTestRunner().run(test)
    assert failed == 0
    assert attempted == EXAMPLES.count(">>> ") > 10


def snakemake(folder: Path, *words: str) -> CompletedProcess:
    """Run the workflow in a folder."""
    return starts.snakemake(folder, "--cores", "1", *words)


@pytest.fixture(scope="module")
def own(tmp_path_factory):
    """The page's workflow in a folder with a configuration of its own, which has nothing to do with
    this project's.
    """
    folder = tmp_path_factory.mktemp("own")
    (folder / "Snakefile").write_text(SNAKEFILE.replace("/path/to/bezierplan", str(ROOT)))
    (folder / "config").mkdir()
    (folder / "config" / "config.yaml").write_text("samples: [a, b]\n")
    return folder


def test_module_makes_the_figure_with_the_settings_given(own):
    done = snakemake(own)
    assert done.returncode == 0, done.stderr
    figure = own / "results/smoke/song2016/paper/figure4.svg"
    assert (own / "mine.txt").read_text().split() == [
        str(figure.stat().st_size),
        str(figure.relative_to(own)),
    ]
    runs = parquet.read_table(
        own / "results/smoke/song2016/runs/routes/smooth/0.parquet"
    ).to_pandas()
    assert set(runs["population"]) == {20}
    assert set(runs["generations"]) == {10}
    assert set(runs["genes"]) == {6}  # as in the study
    assert sorted(file.name for file in own.iterdir()) == [
        ".snakemake",
        "Snakefile",
        "config",
        "mine.txt",
        "results",
    ]


def test_fault_in_the_configuration_of_a_module_is_told_in_one_line(own):
    faulty = (own / "Snakefile").read_text().replace('"population": 20', '"population": 21', 1)
    (own / "faulty").write_text(faulty)
    done = snakemake(own, "--snakefile", "faulty", "--dry-run")
    (line,) = [line for line in (done.stdout + done.stderr).splitlines() if line.strip()]
    assert done.returncode == 2
    assert (
        "population: 21; parents are crossed in pairs, so an even number is needed (with the "
        "configuration's settings: {" in line
    )


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        (
            {"studies": ["song2061"]},
            "studies: song2061: no experiments.yaml in .*; did you mean song2016?",
        ),
        (
            {"settings": {"song": {"population": 20}}},
            "settings: song: unknown; did you mean song2016?",
        ),
        ({"settings": {"song2016": 20}}, "settings: song2016: 20: expected a mapping"),
        (
            {"settings": {"song2016": {"population": [20]}}},
            r"settings: song2016: population: \[20\]: expected a word, a number",
        ),
        ({"setting": {}}, "setting: unknown key; did you mean settings?"),
    ],
)
def test_configuration_of_a_module_is_checked(given, expected):
    with pytest.raises(Fault, match=f"^config/config.yaml or --config: {expected}"):
        loading.read_config({"studies": ["song2016"]} | given)


def test_settings_of_a_planner_are_replaced_one_by_one(tmp_path):
    copy = shutil.copytree(ROOT / "config/studies/song2016", tmp_path / "song2016")
    own = "  binary_genetic: {generations: 8, population: 8}\n  genes: 6"
    edit(copy / "experiments.yaml", "  genes: 6", own)
    given = {
        "studies": [f"{tmp_path}/song2016"],
        "settings": {"song2016": {"penalty": 5.0, "binary_genetic": {"generations": 9}}},
    }
    resolved = loading.load(loading.read_config(given))["song2016"].resolve_settings("smooth")
    assert (
        resolved["penalty"],
        resolved["generations"],
        resolved["population"],
        resolved["samples"],
    ) == (5.0, 9, 8, 501)


def test_a_study_with_other_settings_is_checked_anew():
    good, bad = ({ROOT / "config/studies/song2016": {"population": number}} for number in (20, 21))
    loading.load(list(good))
    loading.load(good)
    with pytest.raises(Fault, match="population: 21"):
        loading.load(bad)
