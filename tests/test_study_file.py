"""Bad input: every fault of a study's folder ends in one line that names file, key, value, and what
would be right.
"""

import re
import shutil
from pathlib import Path

import pytest
from faults import told

from bezierplan.running import execution
from bezierplan.running.chunk import Condition
from bezierplan.schema import model
from bezierplan.schema.checked import Fault
from bezierplan.study import artefacts, jobs, keys, reading

SONG = Path(__file__).parents[1] / "config" / "studies" / "song2016"


@pytest.fixture
def folder(tmp_path):
    """A copy of song2016 to be spoilt."""
    return Path(shutil.copytree(SONG, tmp_path / "song2016"))


EXPERIMENTS, ARTEFACTS, MAP, TABLE = (
    "experiments.yaml",
    "artefacts.yaml",
    "workspaces/figure2.txt",
    "published/table1.csv",
)
CLAIMS, ASSUMPTIONS = "claims.yaml", "assumptions.yaml"

FAULTS = {
    "unknown key at the top": (
        EXPERIMENTS,
        "methods:",
        "methodz:",
        "methodz: unknown key; did you mean methods?",
    ),
    "unknown key of a method": (
        EXPERIMENTS,
        "planner: binary_genetic",
        "planer: binary_genetic",
        "methods: nonsmooth: planer: unknown key",
    ),
    "unknown key of a problem": (
        EXPERIMENTS,
        "start_cell: 0,",
        "start_cel: 0,",
        "problems: 0_15: start_cel: unknown key; did you mean start_cell?",
    ),
    "key given twice": (
        EXPERIMENTS,
        "  generations: 100 ",
        "  population: 100 ",
        "population: this key is given twice",
    ),
    "wrong type of a setting": (
        EXPERIMENTS,
        "population: 200",
        "population: many",
        "population: 'many'; expected a whole number",
    ),
    "wrong type of a cell": (
        EXPERIMENTS,
        "cell: 10,",
        "cell: ten,",
        "cell: 'ten': expected the side of a cell",
    ),
    "wrong type of repeats": (
        EXPERIMENTS,
        "full: 100,",
        "full: 1.5,",
        "full: 1.5: expected a whole number",
    ),
    "unknown planner": (
        EXPERIMENTS,
        "planner: binary_genetic",
        "planner: binary_genetc",
        "planner: binary_genetc: unknown; did you mean binary_genetic?",
    ),
    "planner file that is not there": (
        EXPERIMENTS,
        "planner: binary_genetic",
        "planner: mine.py",
        "mine.py: no such file",
    ),
    "unknown curve": (
        EXPERIMENTS,
        "curve: polyline",
        "curve: polylines",
        "curve: 'polylines'; expected one of polyline",
    ),
    "unknown setting": (
        EXPERIMENTS,
        "  genes: 6",
        "  gene: 6",
        "settings: gene: no planner of this study has this setting; did you mean genes?",
    ),
    "unknown setting of a method": (
        EXPERIMENTS,
        "{curve: polyline,",
        "{curv: polyline,",
        "settings: curv: unknown; did you mean curve?",
    ),
    "unknown setting of a problem": (
        EXPERIMENTS,
        "\n  0_255: {workspace: figure2,",
        "\n  0_255: {workspace: figure2, settings: {gene: 6},",
        "problems: 0_255: settings: gene: unknown",
    ),
    "wrong setting of a problem": (
        EXPERIMENTS,
        "\n  0_255: {workspace: figure2,",
        "\n  0_255: {workspace: figure2, settings: {population: 201},",
        "experiments: routes: methods: nonsmooth: settings: "
        "population: 201; parents are crossed in pairs",
    ),
    "missing setting": (
        EXPERIMENTS,
        "  elitism: 1\n",
        "",
        "settings: elitism: missing; binary_genetic needs it",
    ),
    "probability above 1": (
        EXPERIMENTS,
        "mutation_probability: 0.1",
        "mutation_probability: 1.1",
        "1.1; expected a number from 0 to 1",
    ),
    "negative penalty": (
        EXPERIMENTS,
        "penalty: 10.0",
        "penalty: -1.0",
        "penalty: -1.0; expected a number at least 0",
    ),
    "odd population": (
        EXPERIMENTS,
        "population: 200",
        "population: 201",
        "population: 201; parents are crossed in pairs, so an even number",
    ),
    "start in an occupied cell": (
        EXPERIMENTS,
        "start_cell: 0,",
        "start_cell: 7,",
        "problems: 0_15: start_cell: 7: in an obstacle",
    ),
    "target outside the grid": (
        EXPERIMENTS,
        "target_cell: 15}",
        "target_cell: 256}",
        "target_cell: cell 256 is not on the grid; its cells are numbered 0 to 255",
    ),
    "target outside the border": (
        EXPERIMENTS,
        "start_cell: 0, target_cell: 15}",
        "start: [5, 5], target: [161, 5]}",
        "target: [161, 5]: outside the workspace; expected x from 0 to 160",
    ),
    "half a pair of ends": (
        EXPERIMENTS,
        "start_cell: 0, target_cell: 15}",
        "start_cell: 0}",
        "0_15: start_cell: expected either start and target, or start_cell and target_cell",
    ),
    "unknown workspace": (
        EXPERIMENTS,
        "{workspace: figure2,",
        "{workspace: figur2,",
        "workspace: figur2: unknown; did you mean figure2?",
    ),
    "unknown kind of workspace": (
        EXPERIMENTS,
        "kind: grid",
        "kind: gird",
        "kind: gird: unknown; did you mean grid?",
    ),
    "map file that is not there": (
        EXPERIMENTS,
        "workspaces/figure2.txt",
        "workspaces/figure3.txt",
        "file: workspaces/figure3.txt: no such file in workspaces",
    ),
    "ragged map": (
        MAP,
        "....##..........\n",
        "....##.........\n",
        "workspaces/figure2.txt: line 2 has 16 cells, the first line has 15",
    ),
    "unknown character in a map": (
        MAP,
        "....##..........\n",
        "....##x.........\n",
        "line 1: unknown character 'x'; a cell is . (free) or # (occupied)",
    ),
    "unknown problem in an experiment": (
        EXPERIMENTS,
        "problems: [0_15,",
        "problems: [0_16,",
        "problems: 0_16: unknown; did you mean 0_15?",
    ),
    "unknown method in an experiment": (
        EXPERIMENTS,
        "methods: [nonsmooth,",
        "methods: [non_smooth,",
        "methods: non_smooth: unknown; did you mean nonsmooth?",
    ),
    "no chunk": (
        EXPERIMENTS,
        "    chunk: {smoke: 2, full: 50, extended: 125}\n",
        "",
        "routes: chunk: missing key",
    ),
    "unknown metric": (
        ARTEFACTS,
        "metric: objective",
        "metric: objectiv",
        "metric: objectiv: unknown; did you mean objective?",
    ),
    "unknown statistic": (
        ARTEFACTS,
        "statistic: median",
        "statistic: medain",
        "statistic: medain: unknown; did you mean median?",
    ),
    "unknown kind of figure": (
        ARTEFACTS,
        "kind: paths",
        "kind: path",
        "kind: path: unknown; did you mean paths?",
    ),
    "unknown option of a figure": (
        ARTEFACTS,
        "quantity: curvature, limit",
        "quantity: curvature, limits",
        "limits: unknown key; did you mean limit?",
    ),
    "unknown value of an option": (
        ARTEFACTS,
        "numbers: all",
        "numbers: most",
        "numbers: most: unknown; known: all, free, none",
    ),
    "unknown column in where": (
        ARTEFACTS,
        "where: {problem: 0_255,",
        "where: {problm: 0_255,",
        "where: problm: unknown; did you mean problem?",
    ),
    "unknown problem in where": (
        ARTEFACTS,
        "where: {problem: 0_255,",
        "where: {problem: 0_256,",
        "problem: 0_256: unknown; did you mean 0_255?",
    ),
    "unknown way to pick": (
        ARTEFACTS,
        "pick: {lowest: objective}",
        "pick: {lowst: objective}",
        "pick: lowst: unknown key; did you mean lowest?",
    ),
    "published file that is not there": (
        ARTEFACTS,
        "published: table1.csv",
        "published: table2.csv",
        "table2.csv: no such file",
    ),
    "published file without a column": (
        TABLE,
        ",unit,value\n",
        ",unit,valu\n",
        "table1.csv: line 1: column value is missing",
    ),
    "published file with an unknown key": (
        TABLE,
        "problem,method,",
        "problem,methd,",
        "table1.csv: line 1: column: methd: unknown; did you mean method?",
    ),
    "published text where a number belongs": (
        TABLE,
        ",225.4982",
        ",225.4982 m",
        "table1.csv: line 3: value: '225.4982 m'; expected a number",
    ),
    "published number that is none": (
        TABLE,
        ",225.4982",
        ",nan",
        "table1.csv: line 3: value: 'nan'; expected a number",
    ),
    "published number with an exponent of three digits": (
        TABLE,
        ",225.4982",
        ",1e-999",
        "table1.csv: line 3: value: '1e-999'; expected a number",
    ),
    "order along a column that the published file lacks": (
        ARTEFACTS,
        "    published: table1.csv\n",
        "    published: table1.csv\n    monotone: [{metric: objective, statistic: unstated, "
        "along: genes, direction: up, because: x}]\n",
        "table1.csv: line 1: column genes is missing; the table's key monotone has numbers in "
        "order along it",
    ),
    "order of a table without published numbers": (
        ARTEFACTS,
        "    published: table1.csv\n",
        "    monotone: [{metric: objective, statistic: unstated, along: problem, direction: up, "
        "because: x}]\n",
        "tables: table1: monotone: the table has no published numbers",
    ),
    "order in no direction": (
        ARTEFACTS,
        "    published: table1.csv\n",
        "    published: table1.csv\n    monotone: [{metric: objective, statistic: unstated, "
        "along: problem, direction: upp, because: x}]\n",
        "monotone: 0: direction: upp: unknown; did you mean up?",
    ),
    "published row that is too short": (
        TABLE,
        "unstated,,generation,26",
        "unstated,generation,26",
        "table1.csv: line 2: 6 values; expected 7 values",
    ),
    "published unknown problem": (
        TABLE,
        "0_15,",
        "0_14,",
        "table1.csv: line 2: problem: 0_14: unknown; did you mean 0_15?",
    ),
    "published unknown metric": (
        TABLE,
        "generation_1pct",
        "generation_one",
        "table1.csv: line 2: metric: generation_one: unknown; did you mean",
    ),
    "unknown metric in a claim": (
        CLAIMS,
        "metric: distinct_points",
        "metric: distinct_point",
        "metric: distinct_point: unknown; did you mean",
    ),
    "unknown group in a claim": (
        CLAIMS,
        "groups: [smooth], than",
        "groups: [smoth], than",
        "group: smoth: unknown; did you mean smooth?",
    ),
    "unknown statistic in a claim": (
        CLAIMS,
        "statistic: median",
        "statistic: medain",
        "statistic: medain: unknown; did you mean median?",
    ),
    "unknown experiment in a claim": (
        CLAIMS,
        "experiment: routes",
        "experiment: route",
        "experiment: route: unknown; did you mean routes?",
    ),
    "unknown column in a claim": (
        CLAIMS,
        "every: [problem]",
        "every: [problm]",
        "every: problm: unknown; did you mean problem?",
    ),
    "unknown test in a claim": (
        CLAIMS,
        "test: share",
        "test: shar",
        "test: shar: unknown; did you mean share?",
    ),
    "unknown function in a claim": (
        CLAIMS,
        "name: genes_in_range",
        "name: genes_in_rang",
        "name: genes_in_rang: unknown; did you mean genes_in_range?",
    ),
    "unknown artefact of a claim": (
        CLAIMS,
        "artefact: table1",
        "artefact: table2",
        "artefact: table2: unknown; did you mean table1?",
    ),
    "unknown setting of an assumption": (
        ASSUMPTIONS,
        "setting: genes",
        "setting: gene",
        "setting: gene: no method has this setting",
    ),
    "alternative that is no value": (
        ASSUMPTIONS,
        "alternatives: [path, per_cell]",
        "alternatives: [paths]",
        "penalty_for: 'paths'; expected one of",
    ),
    "unknown claim of an assumption": (
        ASSUMPTIONS,
        "claims: [C1, C5]",
        "claims: [C1, C50]",
        "claims: C50: unknown",
    ),
    "not YAML": (EXPERIMENTS, "methods:", "methods: {", "experiments.yaml: line "),
}


def test_the_study_itself_has_no_fault(folder):
    assert reading.load([folder])["song2016"].title


@pytest.mark.parametrize("fault", FAULTS, ids=str)
def test_fault_is_told_in_one_line(fault, folder):
    name, old, new, expected = FAULTS[fault]
    message = told(folder / name, old, new, folder)
    assert expected in message
    assert re.search(r"(experiments|artefacts|claims|assumptions)\.yaml|table1\.csv", message)


def test_unknown_study_is_told_with_the_closest_name():
    with pytest.raises(Fault, match=r"song2061.*did you mean song2016\?"):
        reading.read_config({"studies": ["song2061"]})


def test_unknown_key_of_the_configuration_is_told():
    with pytest.raises(Fault, match=r"studys: unknown key; did you mean studies\?"):
        reading.read_config({"studys": ["song2016"]})


def test_the_same_study_twice_is_told():
    with pytest.raises(Fault, match="name song2016 is there already"):
        reading.load([SONG, SONG])


def test_settings_of_a_problem_stand_between_those_of_the_study_and_of_a_method(folder):
    file = folder / EXPERIMENTS
    place = "\n  0_255: {workspace: figure2,"
    assert place in file.read_text()
    file.write_text(
        file.read_text().replace(
            place, place + " settings: {genes: 5, samples: 7, generations: 9},", 1
        )
    )
    study = reading.load([folder])["song2016"]
    job = jobs.job(study, "routes", "smooth", "smoke", 0)
    first, second = (
        execution.settings_in(job, Condition(problem, {})) for problem in ("0_15", "0_255")
    )
    assert (first["genes"], first["generations"], first["samples"]) == (6, 100, 601)
    assert second == first | {"genes": 5, "generations": 9}  # the method has samples of its own
    assert execution.settings_in(job, Condition("0_255", {"genes": 4}))["genes"] == 4
    assert (
        "settings" not in jobs.job(study, "routes", "shortest_path", "smoke", 0).problems["0_255"]
    )
    assert "On 0 to 255: genes 5, samples 7, generations 9" in jobs.caption(
        study, "table1", "smoke"
    )
    assert all(
        "settings" not in problem
        for problem in jobs.problems_job(study, "routes", "smoke").problems.values()
    )


def test_panels_that_are_written_once_are_those_written_out():
    def panels(*given):
        figure = {"title": "A figure", "columns": 1, "panels": list(given)}
        return (
            model.parsed(artefacts.ArtefactsFile, {"figures": {"figure1": figure}}, "here")
            .figures["figure1"]
            .panels
        )

    shared = {"kind": "boxes", "experiment": "routes", "metric": "length"}
    first = {"title": "one", "where": {"method": "smooth", "problem": ["0_15"]}, "limits": True}
    second = {"where": {"problem": ["15_255"], "method": "smooth"}}
    each = [
        {"title": "one", "where": {"problem": ["0_15"]}, "limits": True},
        {"where": {"problem": ["15_255"]}},
    ]
    last = {"kind": "workspace", "workspace": "figure2"}
    once = panels(shared | {"where": {"method": "smooth"}, "each": each}, last)
    assert [panel.plain() for panel in once] == [
        panel.plain() for panel in panels(shared | first, shared | second, last)
    ]
    assert [panel.plain() for panel in once] == [shared | first, shared | second, last]
    assert [panel.place for panel in once] == ["0: each: 0", "0: each: 1", "1"]


def test_tables_of_keys_are_those_of_the_models():
    """`python -m bezierplan.study.keys` renews them."""
    text = keys.README.read_text(encoding="utf-8")
    assert keys.renewed(text) == text
    assert all(f"<!-- keys of {name}.yaml -->" in text for name in keys.GROUPS)


def test_settings_of_a_planner_stand_between_those_of_the_study_and_of_a_method(folder):
    file = folder / EXPERIMENTS
    text = file.read_text().replace(
        "  genes: 6", "  binary_genetic: {generations: 7, samples: 7}\n  genes: 6", 1
    )
    file.write_text(text)
    study = reading.load([folder])["song2016"]
    resolved = study.resolved("smooth")
    assert (resolved["generations"], resolved["samples"], resolved["genes"]) == (7, 601, 6)
    assert study.resolved("shortest_path") == {}
