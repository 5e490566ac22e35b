"""What starts, compiling, planners, bounds, drives, judgement, tables, figures, claims and the page
cost.

`make benchmark` measures it and compares it with docs/benchmark.csv, which `make benchmark
ARGS=store` writes anew, at each release; `ARGS="grown store"` with how cost grows. Costs are CPU
times, each as a multiple of that of a fixed piece of work beside it (`frame.fixed`), so that
machines compare; that of memory is in MB. A cost above `NAMED` times the stored one in three
measurements is named; above `FAILS` times, the status is 1, unless the stored ones are of another
processor, on which some code is faster beside the fixed piece.
"""

import re
import sys
from collections.abc import Iterable, Iterator, Mapping
from itertools import chain
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "src"))

from bezierplan.places import TREE, choose_machine_code

choose_machine_code()

import frame  # noqa: E402
import pandas as pd  # noqa: E402
import parts  # noqa: E402

STORED, MADE = TREE / "docs" / "benchmark.csv", TREE / "results" / "benchmark.csv"
NAMED, FAILS = 1.25, 2.0


def find_processor() -> str:
    """The kind of this machine's processor; empty where it is not known."""
    file = Path("/proc/cpuinfo")
    first = file.read_text(encoding="utf-8").split("\n\n")[0] if file.is_file() else ""
    known = dict(re.findall(r"^([\w ]+?)\s*: (.*)$", first, re.MULTILINE))
    return ", ".join(known.get(key, "") for key in ("model name", "cpu family", "model"))


def measured(
    costs: Iterable[tuple[str, frame.Measure]], stored: Mapping[str, float]
) -> Iterator[tuple[str, float]]:
    """Names and costs; what seems slower than the stored cost is measured twice more."""
    for name, measure in costs:
        cost = measure()
        for _ in range(2):
            if cost > NAMED * stored.get(name, cost):
                cost = min(cost, measure())
        print(f"  {name:55}{cost:12.4g}", flush=True)
        yield name, cost


def judged(costs: Mapping[str, float], stored: Mapping[str, float]) -> tuple[list[str], bool]:
    """What is slower than before, a line each, and whether that is too much."""
    times = {name: cost / stored[name] for name, cost in costs.items() if name in stored}
    slower = {name: each for name, each in times.items() if each > NAMED}
    lines = [f"{name}: {each:.2f} times as long as stored" for name, each in slower.items()]
    return lines, any(each > FAILS for each in slower.values())


def main(words: list[str]) -> int:
    """Measure, compare and write; the status."""
    if unknown := {*words} - {"store", "grown"}:
        sys.exit(f"make benchmark: ARGS: {' '.join(unknown)}: unknown; expected store or grown")
    known = (
        pd.read_csv(STORED, index_col="cost", comment="#")["ratio"]
        if STORED.exists()
        else pd.Series(dtype=float)
    )
    compared = {} if "store" in words else known.to_dict()
    parts_of = chain(parts.short(), parts.grown() if "grown" in words else ())
    costs = dict(measured(parts_of, compared))
    lines, failed = judged(costs, compared)
    file = STORED if "store" in words else MADE
    # What was not measured this time stays.
    kept = {name: cost for name, cost in known.items() if name.startswith(parts.GROWN)}
    table = pd.Series(kept | costs, name="ratio").rename_axis("cost")
    file.parent.mkdir(parents=True, exist_ok=True)
    processor = f"# {find_processor()}"
    same = not compared or STORED.read_text(encoding="utf-8").startswith(f"{processor}\n")
    file.write_text(f"{processor}\n{table.to_csv(float_format='%.4g')}", encoding="utf-8")
    if lines and not same:
        lines.append("stored on another processor, so this is no failure")
    print(*lines or ["nothing is slower than stored"], file.relative_to(TREE), sep="\n")
    return int(failed and same)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
