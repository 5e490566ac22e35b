"""Digests of the tables and claims of scale smoke: whatever a change makes of a study's numbers
shows. A command (`make smoke-digests`) writes them anew, in a commit that says why they change.

Times differ from machine to machine and are left out. Six digits stay: the last bits of a library
differ too.
"""

import hashlib
from pathlib import Path

import pandas as pd

from bezierplan.places import TREE

KEPT = Path(__file__).parent / "data" / "smoke.csv"
RESULTS = TREE / "results" / "smoke"
STUDIES = sorted(file.parent.name for file in TREE.glob("config/studies/*/experiments.yaml"))


def parts(folder: Path = RESULTS) -> dict[tuple[str, str, str], pd.DataFrame]:
    """What is kept, by study, table and metric, and the claims of each study."""
    found = {}
    for study in STUDIES:
        for file in sorted(folder.glob(f"{study}/paper/*.comparison.csv")):
            table = pd.read_csv(file)
            keys = table.columns[: table.columns.get_loc("unit")]
            numbers = table.loc[~table["unit"].isin(["s", "ms"]), [*keys, "n_ours", "value_ours"]]
            for metric, rows in numbers.groupby("metric"):
                found[study, file.name.partition(".")[0], metric] = rows
        for file in sorted(folder.glob(f"{study}/paper/table?.csv")):
            if not file.with_suffix(".comparison.csv").exists():
                found[study, file.stem, ""] = pd.read_csv(file)
        claims = pd.read_csv(folder / study / "claims.csv")
        told = claims.loc[~claims["timed"], ["id", "variant", "verdict", "effect", "n"]]
        found[study, "claims", ""] = told
    return found


def digest(part: pd.DataFrame) -> str:
    """Of the text of a part."""
    text = part.to_csv(index=False, float_format="%.6g", lineterminator="\n")
    return hashlib.sha256(text.encode()).hexdigest()[:12]


def kept() -> dict[tuple[str, str, str], str]:
    """The digests of the project."""
    table = pd.read_csv(KEPT, keep_default_na=False)
    return table.set_index(["study", "table", "metric"])["digest"].to_dict()


def main() -> None:
    """Write the digests of results/smoke."""
    rows = [(*place, digest(part)) for place, part in parts().items()]
    table = pd.DataFrame(rows, columns=["study", "table", "metric", "digest"])
    table.to_csv(KEPT, index=False, lineterminator="\n")


if __name__ == "__main__":
    main()
