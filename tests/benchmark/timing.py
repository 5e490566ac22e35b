"""CPU time of one core. Ratios carry over to other machines; the fastest of several rounds is least disturbed by what else runs."""

import time
from collections.abc import Callable

ROUNDS = 5


def cpu_seconds(work: Callable[[], object], rounds: int = ROUNDS) -> float:
    """CPU seconds of the fastest of several rounds, after one that compiles."""
    work()
    seconds = []
    for _ in range(rounds):
        before = time.process_time()
        work()
        seconds.append(time.process_time() - before)
    return min(seconds)
