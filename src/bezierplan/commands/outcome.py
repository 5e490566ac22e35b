"""Copy the outcome of results/extended and results/full to docs/outcome and into the README.

Verdicts and numbers are those of scale extended: they are about the methods, not about the papers'
samples. Next to each verdict stands the verdict at the paper's own number of runs, from scale full.
"""

import re
import shutil
from pathlib import Path

import pandas as pd

from bezierplan.analysis import headline, summary
from bezierplan.commands import replay, studies_of
from bezierplan.schema.checked import Fault
from bezierplan.study.page import settings_of

RESULTS, FULL = Path("results/extended"), Path("results/full")
KEPT, README = Path("docs/outcome"), Path("README.md")
PICTURES = ("song2016/paper/figure3.png", "song2016/beyond/identified.png")
# The run of the README's animation, and its file.
DRIVE, ANIMATION = "elhoseny2017/moving/moving_fast_0_15/mga_evades/0", "elhoseny2017_moving.gif"
BLOCK = "outcome"
# Between two sentences: the README has the first of a paper.
_SENTENCE = re.compile(r"(?<=[.])\s+(?=[A-Z0-9])")
# The table of alternatives of each study at scale full.
SENSITIVITY = "sensitivity.csv"
AUDIT = "audit.csv"
BASELINE_COMPARISON = "baseline_comparison.csv"
NUMBERS_FULL = "numbers_papers_size.csv"
SCALES = {
    "full": "the papers' own numbers of runs.",
    "extended": "a verdict is about a method, not about the few runs that a paper could afford.",
}


def main() -> None:
    """Write docs/outcome and the README's table from results/extended and results/full. Raises
    Fault if one of them is incomplete.
    """
    try:
        write()
    except FileNotFoundError as error:
        raise Fault(f"{error.filename}: not there yet; `make outcome` makes it") from None


def write() -> None:
    """Copy the outcome, and insert its table into the README. Raises FileNotFoundError if results
    are missing.
    """
    studies = studies_of()
    titles = {key: study.title for key, study in studies.items()}
    claims = summary.with_papers_size(
        pd.read_csv(RESULTS / "claims.csv"), pd.read_csv(FULL / "claims.csv")
    )
    numbers = pd.read_csv(RESULTS / "numbers.csv")
    measured = pd.read_csv(RESULTS / BASELINE_COMPARISON)
    KEPT.mkdir(parents=True, exist_ok=True)
    numbers.to_csv(KEPT / "numbers.csv", index=False)
    claims.to_csv(KEPT / "claims.csv", index=False)
    shutil.copyfile(FULL / "numbers.csv", KEPT / NUMBERS_FULL)
    for key in titles:
        shutil.copyfile(RESULTS / key / "audit.csv", KEPT / f"{key}_{AUDIT}")
    follow = following(KEPT, numbers, claims, measured)
    settings = [(key, *row) for key, each in studies.items() for row in settings_of(each)]
    pd.DataFrame(settings, columns=["study", "method", "setting", "value"]).to_csv(
        KEPT / "settings.csv", index=False
    )
    (KEPT / "summary.md").write_text(
        summary.report(numbers, claims, measured, titles, follow, RESULTS.name), encoding="utf-8"
    )
    for key in titles:
        kept, file = KEPT / f"{key}_{SENSITIVITY}", FULL / key / SENSITIVITY
        kept.unlink(missing_ok=True)  # what was not made again is of another state
        if file.is_file():
            shutil.copyfile(file, kept)
    shutil.copyfile(RESULTS / BASELINE_COMPARISON, KEPT / BASELINE_COMPARISON)
    for picture in PICTURES:
        shutil.copyfile(
            FULL / picture, KEPT / picture.replace("/paper/", "_").replace("/beyond/", "_")
        )
    replay.animate(replay.replay(DRIVE, studies), KEPT / ANIMATION)
    README.write_text(
        summary.with_block(README.read_text(encoding="utf-8"), BLOCK, table(KEPT)), encoding="utf-8"
    )


def following(kept: Path, *tables: pd.DataFrame) -> dict[str, str]:
    """By study, what follows, from tables of numbers, claims and measures and a folder's audits."""
    files = {key: study.verdict_file() for key, study in studies_of().items()}
    files = {key: file for key, file in files.items() if file}
    return summary.verdicts(*tables, files, [str(kept / f"{key}_{AUDIT}") for key in files])


def table(kept: Path) -> str:
    """The README's sentences and headline, from a folder's tables, and the scale, from its
    summary.
    """
    titles = {key: study.title for key, study in studies_of().items()}
    tables = [
        pd.read_csv(kept / name) for name in ("numbers.csv", "claims.csv", BASELINE_COMPARISON)
    ]
    overview = headline.headline(*tables, titles)
    follow = "\n".join(
        f"- {titles[key].partition(':')[0]}: {_SENTENCE.split(text)[0]}"
        for key, text in following(kept, *tables).items()
    )
    heading = (kept / "summary.md").read_text(encoding="utf-8").splitlines()[0]
    scale = heading.removeprefix(summary.HEADING)
    return f"{headline.markdown(overview)}\n\n{follow}\n\nScale `{scale}`: {SCALES[scale]}"
