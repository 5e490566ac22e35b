"""The archive: what it holds, and that the validator refuses a crate that is not complete."""

import importlib.util
import subprocess
from pathlib import Path

import pytest

pytestmark = pytest.mark.rare

ROOT = Path(__file__).parents[1]
SCRIPT, PYTHON = ROOT / "workflow/archive/archive.py", ROOT / ".cache/archive/bin/python"


@pytest.fixture(scope="module")
def archive():
    spec = importlib.util.spec_from_file_location("archive", SCRIPT)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def tree(folder):
    results = folder / "results/full"
    for name in (
        "one/runs/e/m/0.parquet",
        "one/logs/page.log",
        "one/claims.csv",
        "page.log",
    ):
        (results / name).parent.mkdir(parents=True, exist_ok=True)
        (results / name).touch()
    (results / "index.html").write_text("<!doctype html>")
    return results


def test_results_go_in_without_logs(archive, tmp_path):
    results = tree(tmp_path)
    names = [str(file.relative_to(results)) for file in archive.result_files(results)]
    assert names == ["index.html", "one/claims.csv", "one/runs/e/m/0.parquet"]


def test_scale_without_a_page_is_one_line(tmp_path):
    done = subprocess.run(
        ["python3", SCRIPT, "extended"], cwd=tmp_path, capture_output=True, text=True
    )
    assert done.returncode == 1
    assert (
        done.stderr == "results/extended/index.html: not found; make it with snakemake extended\n"
    )


# The script as a program, and its check of what it made without an instrument: in one process, for
# to import the validator takes half of the time.
BOTH = """
import json, runpy, sys
from pathlib import Path
sys.argv = sys.argv[1:]
archive = runpy.run_path(sys.argv[0], run_name="__main__")
(metadata,) = Path().glob("archive/*/ro-crate-metadata.json")
crate = json.loads(metadata.read_text())
for entity in crate["@graph"]:
    if entity["@id"] == "#run":
        del entity["instrument"]
metadata.write_text(json.dumps(crate))
print("spoilt")
print(archive["check"](metadata.parent))
"""


def test_validator_accepts_the_archive_and_refuses_one_whose_run_names_no_workflow(tmp_path):
    # Set up as `make archive` does; nothing to do if it is there.
    subprocess.run(
        ["make", PYTHON.parents[1].relative_to(ROOT) / "ready"],
        cwd=ROOT,
        check=True,
        capture_output=True,
    )
    tree(tmp_path)
    done = subprocess.run(
        [PYTHON, "-c", BOTH, SCRIPT], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    accepted, refused = done.stdout.split("spoilt\n")
    assert accepted.endswith(".zip: accepted as a Workflow Run Crate\n")
    assert "instrument" in refused
