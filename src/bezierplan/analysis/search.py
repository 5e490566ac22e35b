"""The search for the reading under which a paper's printed numbers are most likely.

The score of a reading is a sum over parts: methods whose numbers are judged together, which depend on few of the choices. So a change is
paid only by the parts that it concerns, and what is known of the others stays: a competing method's own settings are searched as if it
stood alone, while choices that all share, such as the workspace, are judged on all of them. From the reading in force each choice in turn
takes its best value until none improves the score; then some choices take values of a space-filling design, alternately those of one part
alone and shared ones, and the climb begins again from there (iterated local search; Lourenço, Martin and Stützle 2003, "Iterated local
search"). `tests/planted.py` measures how often this finds a planted reading, beside other searches.

All values of a choice are asked for at once, as one batch, whatever the number of processes that share it, and all draws are seeded from
names: so the result is the same on any number of cores.
"""

import itertools
import math
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np

from bezierplan.analysis.explained import Evaluated, Reading, name_of, together
from bezierplan.workspaces.seeds import generator

# Rows of the space-filling design before a further one is drawn.
DESIGN = 64
# How many choices a kick changes: enough to leave a hill, few enough to keep what is good.
KICKED = 2
# After so many kicks in a row that asked for nothing new, everything near has been tried.
STALE = 200
# What a printed number that no run could have costs a reading in the climb: more than any likelihood gives.
RULED_OUT = 1e6


class Part(NamedTuple):
    """methods: those whose numbers are judged together. choices: the ids of those that they depend on."""

    methods: list[str]
    choices: list[str]


class Task(NamedTuple):
    """A reading, restricted to the choices of a part, that is to be evaluated for it."""

    part: int
    reading: Reading


class Found(NamedTuple):
    """readings: those tried as a whole, that in force first, then the best first. of_parts: for each part, all that was evaluated."""

    readings: list[Evaluated]
    of_parts: list[list[Evaluated]]


Evaluate = Callable[[list[Task]], list[Evaluated | None]]
"""Evaluates tasks, in their order; None for one whose settings exclude each other."""


class _SpentError(Exception):
    """No more parts may be evaluated."""


class _Book:
    """What is known of each part, and what may still be spent."""

    def __init__(self, choices: list[dict], parts: list[Part], evaluate: Evaluate, most: int) -> None:
        self.choices, self.parts, self.evaluate, self.left = choices, parts, evaluate, most
        self.known: list[dict[str, Evaluated | None]] = [{} for _ in parts]
        self.seen: dict[str, Reading] = {}

    def changed(self, reading: Reading, choice: str, value: Any) -> Reading:
        """A reading with one choice made; None stands for the value in force."""
        rest = {other: kept for other, kept in reading.items() if other != choice}
        return rest if value is None else settled(rest | {choice: value}, self.choices)

    def part_of(self, reading: Reading, part: int) -> Reading:
        return {choice: value for choice, value in reading.items() if choice in self.parts[part].choices}

    def ask(self, readings: list[Reading]) -> list[float]:
        """The values of readings, for which their unknown parts are evaluated in one batch. Raises _SpentError if nothing may be spent."""
        wanted: dict[tuple[int, str], Task] = {}
        for reading, part in itertools.product(readings, range(len(self.parts))):
            own = self.part_of(reading, part)
            if name_of(own) not in self.known[part]:
                wanted[part, name_of(own)] = Task(part, own)
        if wanted and self.left <= 0:
            raise _SpentError
        self.left -= len(wanted)
        for (part, name), found in zip(wanted, self.evaluate([*wanted.values()]) if wanted else [], strict=True):
            self.known[part][name] = found
        self.seen |= {name_of(reading): reading for reading in readings}
        return [self.value(reading) for reading in readings]

    def value(self, reading: Reading) -> float:
        parts = self.evaluated(reading)
        return sum(each.score - RULED_OUT * each.impossible for each in parts) if parts else -math.inf

    def evaluated(self, reading: Reading) -> list[Evaluated] | None:
        """What is known of the parts of a reading; None if it is excluded."""
        found = [known[name_of(self.part_of(reading, part))] for part, known in enumerate(self.known)]
        return None if None in found else found

    def found(self, listed: int) -> Found:
        """The best readings, up to a number, after that in force."""
        best = sorted((each for each in self.seen.values() if each and self.evaluated(each)), key=self.value, reverse=True)
        readings = [together(reading, self.evaluated(reading)) for reading in [{}, *best[:listed]]]
        return Found(readings, [[each for each in known.values() if each] for known in self.known])


def search(choices: list[dict], parts: list[Part], evaluate: Evaluate, name: str, most: int, listed: int = 500) -> Found:
    """The readings tried, up to a number, and all that is known of the parts.

    choices: with `id` and `values`, the value in force first, as None. name: seeds the design. most: how many readings may be evaluated;
    one that shares parts with others costs only the share that is new. All are, if there are no more than that.
    """
    book = _Book(choices, parts, evaluate, most * len(parts))
    try:
        book.ask([{}])
        if math.prod(len(choice["values"]) for choice in choices) <= most:
            book.ask([*_all(choices)])
        else:
            _climb_on(choices, book, name)
    except _SpentError:
        pass
    return book.found(listed)


def settled(reading: Reading, choices: list[dict]) -> Reading:
    """A reading without the choices that its world makes itself: with another value they would name runs that are not made."""
    worlds = [choice["overrules"].get(str(reading.get(choice["id"])), []) for choice in choices if "column" in choice]
    return {choice: value for choice, value in reading.items() if choice not in set().union(*worlds)}


def confirm(found: Found, parts: list[Part], evaluate: Evaluate, finalists: int) -> list[Evaluated]:
    """That in force and the best of the readings found, evaluated anew, such as with more runs; the best first, after that in force."""
    book = _Book([], parts, evaluate, (finalists + 1) * len(parts))
    book.ask([each.reading for each in found.readings[: finalists + 1]])
    return book.found(finalists).readings


def whole(reading: Reading, parts: list[Part], evaluate: Evaluate) -> Evaluated:
    """A reading, all of whose parts are evaluated."""
    book = _Book([], parts, evaluate, len(parts))
    book.ask([reading])
    return together(reading, book.evaluated(reading))


def _climb_on(choices: list[dict], book: _Book, name: str) -> None:
    """Climb from the reading in force, then from kicks of the best one, until nothing may be spent or nothing is new."""
    reading = _climb({}, choices, book, generator(f"{name}/climb/0"))
    shared, own = _shared_and_own(choices, book.parts)
    groups = [*([shared, *own] if shared else own)]
    groups = [group for group in groups if group]
    stale = 0
    for number, drawn in enumerate(_design(choices, name), start=1):
        rng = generator(f"{name}/climb/{number}")
        group = groups[number % len(groups)]
        # Every other time all choices of a competing method are drawn, so that its settings are tried everywhere.
        anew = group is not shared and number // len(groups) % 2 == 0
        count = len(group) if anew else min(KICKED, len(group))
        kicked = {choice["id"] for choice in np.array(group, dtype=object)[rng.permutation(len(group))[:count]]}
        other = reading
        for choice in kicked:
            other = book.changed(other, choice, drawn[choice])
        before = book.left
        other = _climb(other, choices if group is shared else group, book, rng)
        if book.value(other) >= book.value(reading):
            reading = other
        stale = stale + 1 if book.left == before else 0
        if stale == STALE:
            return


def _climb(reading: Reading, choices: list[dict], book: _Book, rng: np.random.Generator) -> Reading:
    """Give one choice after the other its best value, in random order, until none improves the score."""
    (best,) = book.ask([reading])
    order = [choices[place] for place in rng.permutation(len(choices))]
    unchanged = 0
    for choice in itertools.cycle(order):
        others = [book.changed(reading, choice["id"], value) for value in choice["values"]]
        values = book.ask(others)
        place = int(np.argmax(values))
        unchanged += 1
        if values[place] > best:
            reading, best, unchanged = others[place], values[place], 1
        if unchanged >= len(order):
            return reading
    return reading


def _shared_and_own(choices: list[dict], parts: list[Part]) -> tuple[list[dict], list[list[dict]]]:
    """Choices on which several parts depend, and for each part those on which it alone does."""
    users = {choice["id"]: [part for part, each in enumerate(parts) if choice["id"] in each.choices] for choice in choices}
    shared = [choice for choice in choices if len(users[choice["id"]]) > 1]
    return shared, [[choice for choice in choices if users[choice["id"]] == [part]] for part in range(len(parts))]


def _design(choices: list[dict], name: str) -> Iterator[dict[str, Any]]:
    """Rows of Latin hypercubes over the values of all choices, without end: each value of a choice comes up equally often."""
    from scipy.stats import qmc

    for number in itertools.count():
        cube = qmc.LatinHypercube(len(choices), seed=generator(f"{name}/design/{number}")).random(DESIGN)
        for row in cube:
            yield {choice["id"]: choice["values"][int(place * len(choice["values"]))] for choice, place in zip(choices, row, strict=True)}


def _all(choices: list[dict]) -> Iterator[Reading]:
    for values in itertools.product(*(choice["values"] for choice in choices)):
        yield settled({choice["id"]: value for choice, value in zip(choices, values, strict=True) if value is not None}, choices)
