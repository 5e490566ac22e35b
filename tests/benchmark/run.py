"""Speed of the inner loops: `make benchmark`, or of some of its parts: `make benchmark
ARGS="tharwat2018 runs"`.

CPU time of one core. Checks and bounds are timed by kind and size of workspace, start-up in
processes of its own; `compare.py` sets the chaotic swarm beside other libraries.
"""

import os
import resource
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "src"))

from elhoseny2017 import benchmark_fields
from geometry import benchmark_geometry
from growth import benchmark_growth
from least import benchmark_least
from limits import benchmark_limits
from meledje import benchmark_node_genetic
from runs import benchmark_runs
from simulation import benchmark_simulation
from song2016 import benchmark_binary_genetic
from tharwat2018 import benchmark_chaotic_pso
from timing import ROUNDS

SOURCE = sys.path[0]


def benchmark_start() -> None:
    """CPU seconds of what every run job imports, of the check of the configuration, and of
    `bezierplan list`.
    """
    print(f"\n{'start-up':26}{'CPU s':>18}")
    for name, command in {
        "imports of a run job": [
            "-c",
            "import pyarrow.parquet; from bezierplan.running import execution, problems",
        ],
        "bezierplan list": ["-m", "bezierplan", "list"],
    }.items():
        seconds = []
        for _ in range(ROUNDS):
            before = resource.getrusage(resource.RUSAGE_CHILDREN)
            subprocess.run(
                [sys.executable, *command],
                env=os.environ | {"PYTHONPATH": SOURCE},
                stdout=subprocess.DEVNULL,
                check=True,
            )
            after = resource.getrusage(resource.RUSAGE_CHILDREN)
            seconds.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
        print(f"  {name:24}{min(seconds):18.2f}")


PARTS = {
    "song2016": benchmark_binary_genetic,
    "tharwat2018": benchmark_chaotic_pso,
    "meledje": benchmark_node_genetic,
    "elhoseny2017": benchmark_fields,
    "runs": benchmark_runs,
    "least": benchmark_least,
    "simulation": benchmark_simulation,
    "geometry": benchmark_geometry,
    "limits": benchmark_limits,
    "growth": benchmark_growth,
    "start": benchmark_start,
}

if __name__ == "__main__":
    for part in sys.argv[1:]:
        if part not in PARTS:
            sys.exit(f"make benchmark: ARGS: {part}: unknown; expected some of {', '.join(PARTS)}")
    for part in sys.argv[1:] or PARTS:
        PARTS[part]()
