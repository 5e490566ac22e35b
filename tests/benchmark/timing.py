"""CPU time of one core. Ratios carry over to other machines; the fastest of several rounds is least
disturbed by what else runs.
"""

import time
from collections.abc import Callable, Sequence

ROUNDS = 5


def cpu_seconds(work: Callable[[], object], rounds: int = ROUNDS) -> float:
    """CPU seconds of the fastest of several rounds, after one that compiles."""
    return cpu_seconds_of_each([work], rounds)[0]


def cpu_seconds_of_each(works: Sequence[Callable[[], object]], rounds: int = ROUNDS) -> list[float]:
    """As `cpu_seconds`, of several works, each in turn in every round: what slows a round down
    slows all of them.
    """
    for work in works:
        work()
    return [
        min(seconds) for seconds in zip(*([_once(work) for work in works] for _ in range(rounds)))
    ]


def _once(work: Callable[[], object]) -> float:
    before = time.process_time()
    work()
    return time.process_time() - before
