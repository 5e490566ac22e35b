"""What jobs do, called as functions: they know the files of an experiment by name, wherever these
lie.
"""

import contextlib
import shutil
from pathlib import Path
from types import SimpleNamespace

import pandas as pd
import pytest

from bezierplan.analysis import audit, baseline_comparison
from bezierplan.analysis.claims import job as claims_job
from bezierplan.analysis.jobs import AuditJob, ClaimsJob, MeasuredJob
from bezierplan.figures import job as figures_job
from bezierplan.figures.figure_job import FigureJob
from bezierplan.running import inputs
from bezierplan.running.inputs import Files
from bezierplan.schema import model
from bezierplan.study import reading, targets


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A working folder with a study, `many`, of four runs of each method, and their results."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(Path(__file__).parent / "benchmark"))
        import gathering

        patch.setattr(gathering, "MADE", 4)
        folder = tmp_path_factory.mktemp("jobs")
        with contextlib.chdir(folder):
            gathering.write_runs(reading.read_study(gathering.write_study(folder / "many", 4, 2)))
    return folder


@pytest.fixture
def study(folder, monkeypatch):
    monkeypatch.chdir(folder)
    return reading.read_study(folder / "many")


@pytest.fixture
def moved(study, tmp_path):
    """Files of the study's experiment under names that say nothing."""
    (files,) = targets.shown_by(study, "full", "lengths").values()
    copies = {}
    for file in (*files.chunks, files.problems, files.bounds):
        copies[file] = str(tmp_path / f"{len(copies)}.parquet")
        shutil.copy(file, copies[file])
        if (times := Path(file).with_suffix(".times.parquet")).is_file():
            shutil.copy(times, Path(copies[file]).with_suffix(".times.parquet"))
    runs = {method: [copies[chunk] for chunk in chunks] for method, chunks in files.runs.items()}
    return Files(runs, copies[files.problems], copies[files.bounds])


def test_methods_are_measured_against_the_baseline(study, moved):
    params = targets.baseline_comparison_params({"many": study}, "full")["job"]
    rows = baseline_comparison.of_studies(
        {"many": MeasuredJob(**params["many"])}, {"many/all": moved}
    )
    assert list(rows.columns) == list(baseline_comparison.COLUMNS)
    assert set(rows["method"]) == {"pso", "cpso1_singer", "cpso2_singer", "ferguson"}
    assert set(rows["study"]) == {"many"}
    assert (rows["length"].dropna() >= 1 - 1e-9).all(), "none is shorter than the shortest path"


def test_claims_are_judged(study, moved, tmp_path):
    job = model.job(ClaimsJob, targets.claims_params({"many": study}, "full", "many")["job"])
    published = inputs.part(targets.claims_inputs({"many": study}, "full", "many"), "published")
    claims_job.run(
        job, {"all": moved}, published, str(tmp_path / "claims.csv"), str(tmp_path / "checks.csv")
    )
    assert pd.read_csv(tmp_path / "claims.csv")["id"].tolist() == ["C1"]
    assert set(pd.read_csv(tmp_path / "checks.csv")["test"]) == {"lower"}


def test_the_papers_numbers_are_audited(study, moved):
    job = model.job(AuditJob, targets.audit_params({"many": study}, "full", "many")["job"])
    published = inputs.part(targets.audit_inputs({"many": study}, "full", "many"), "published")
    table = audit.audited(job, {}, {"all": moved.bounds}, published)
    assert list(table.columns) == audit.COLUMNS


@pytest.mark.parametrize("name", ["spread", "paths"])
def test_a_figure_is_drawn_wide_and_narrow(study, moved, tmp_path, name):
    job = model.job(FigureJob, targets.figure_params({"many": study}, "full", "many", name)["job"])
    output = SimpleNamespace(
        **{
            part: str(tmp_path / f"{part}.{name}")
            for part in ("svg", "png", "pdf", "data", "caption")
        }
    )
    figures_job.draw(job, {"all": moved}, {}, study.folder, output)
    assert "runs" in Path(output.caption).read_text()
    assert pd.read_csv(output.data)["panel"].nunique() == len(job.panels)
    narrow = SimpleNamespace(svg=str(tmp_path / "narrow.svg"), pdf=str(tmp_path / "narrow.pdf"))
    figures_job.draw_narrow(job, {"all": moved.problems}, output.data, study.folder, narrow)
    assert Path(narrow.svg).stat().st_size > 1000
    assert Path(narrow.pdf).stat().st_size > 1000
