"""The search for the interpretation under which a paper's printed numbers are most likely.

The score of an interpretation is a sum over parts: methods whose numbers are judged together, which
depend on few of the choices. So a change is paid only by the parts that it concerns, and what is
known of the others stays: a competing method's own settings are searched as if it stood alone,
while choices that all share, such as the workspace, are judged on all of them. From the default
interpretation each choice in turn takes its best value until none improves the score; then some
choices take values of a space-filling design, alternately those of one part alone and shared ones,
and the climb begins again from there (iterated local search; Lourenço, Martin and Stützle 2003,
"Iterated local search"). `tests/planted.py` measures how often this finds a planted interpretation,
beside other searches.

All values of a choice are asked for at once, as one batch, whatever the number of processes that
share it, and all draws are seeded from names: so the result is the same on any number of cores.
"""

import itertools
import math
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple, TypeVar

import numpy as np

from bezierplan.analysis.explained import Evaluated, Interpretation, name_of, together
from bezierplan.analysis.search_job import Choice, Part
from bezierplan.workspaces.seeds import generator

# Rows of the space-filling design before a further one is drawn.
DESIGN = 64
# How many choices a kick changes: enough to leave a hill, few enough to keep what is good.
KICKED = 2
# After so many kicks in a row that asked for nothing new, everything near has been tried.
STALE = 60
# So many standard errors of the difference below the best score, an interpretation may still be the
# best.
REACH = 2.0
# What a printed number that no run could have costs an interpretation in the climb: more than any
# likelihood gives.
RULED_OUT = 1e6


class Task(NamedTuple):
    """An interpretation, restricted to the choices of a part, that is to be evaluated for it."""

    part: int
    interpretation: Interpretation


class Found(NamedTuple):
    """interpretations: those tried as a whole, the default first, then the best first; of those
    with one score, which are one experiment under several names, the one with the fewest choices.
    of_parts: for each part, all that was evaluated. tried: how many interpretations were.
    """

    interpretations: list[Evaluated]
    of_parts: list[list[Evaluated]]
    tried: int


Evaluate = Callable[[list[Task]], list[Evaluated | None]]
"""Evaluates tasks, in their order; None for one whose settings exclude each other."""


class _SpentError(Exception):
    """A part may not be evaluated any more."""


class _Book:
    """What is known of each part, and how often each may still be evaluated. most: that, for each
    part: one whose choices are many does not spend what others need.
    """

    def __init__(
        self, choices: list[Choice], parts: list[Part], evaluate: Evaluate, most: float
    ) -> None:
        self.choices, self.parts, self.evaluate = choices, parts, evaluate
        self.left = [most] * len(parts)
        self.known: list[dict[str, Evaluated | None]] = [{} for _ in parts]
        self.values: list[dict[str, float]] = [{} for _ in parts]
        self.seen: dict[str, Interpretation] = {}

    def changed(self, interpretation: Interpretation, choice: str, value: Any) -> Interpretation:
        """An interpretation with one choice made; None stands for the default."""
        rest = {other: kept for other, kept in interpretation.items() if other != choice}
        return rest if value is None else settled(rest | {choice: value}, self.choices)

    def part_of(self, interpretation: Interpretation, part: int) -> Interpretation:
        return {
            choice: value
            for choice, value in interpretation.items()
            if choice in self.parts[part].choices
        }

    def ask(self, interpretations: list[Interpretation]) -> list[float]:
        """The values of interpretations, for which their unknown parts are evaluated in one batch.
        Raises _SpentError if one of these may not be evaluated.
        """
        wanted: dict[tuple[int, str], Task] = {}
        for interpretation, part in itertools.product(interpretations, range(len(self.parts))):
            own = self.part_of(interpretation, part)
            if name_of(own) not in self.known[part]:
                wanted[part, name_of(own)] = Task(part, own)
        if any(self.left[part] <= 0 for part, _ in wanted):
            raise _SpentError
        for part, _ in wanted:
            self.left[part] -= 1
        for (part, name), found in zip(
            wanted, self.evaluate([*wanted.values()]) if wanted else [], strict=True
        ):
            self.known[part][name] = found
            self.values[part][name] = (
                found.score - RULED_OUT * found.impossible if found else -math.inf
            )
        self.seen |= {name_of(interpretation): interpretation for interpretation in interpretations}
        return [self.value(interpretation) for interpretation in interpretations]

    def value(self, interpretation: Interpretation) -> float:
        return sum(
            values[name_of(self.part_of(interpretation, part))]
            for part, values in enumerate(self.values)
        )

    def evaluated(self, interpretation: Interpretation) -> list[Evaluated] | None:
        """What is known of the parts of an interpretation; None if it is excluded."""
        found = [
            known[name_of(self.part_of(interpretation, part))]
            for part, known in enumerate(self.known)
        ]
        return None if None in found else found

    def wholes(self, interpretations: list[Interpretation]) -> list[Evaluated]:
        """Interpretations from what is known of their parts, without those excluded."""
        return [
            together(interpretation, own)
            for interpretation in interpretations
            if (own := self.evaluated(interpretation))
        ]

    def found(self, listed: int) -> Found:
        """The best interpretations, up to a number, after the default."""
        possible = [each for each in self.seen.values() if self.evaluated(each)]
        different = [each for each in _different(possible, self.value, len) if each]
        return Found(
            self.wholes([{}, *different[:listed]]),
            [[each for each in known.values() if each] for known in self.known],
            len(possible),
        )


def search(
    choices: list[Choice],
    parts: list[Part],
    evaluate: Evaluate,
    name: str,
    most: int,
    listed: int = 500,
) -> Found:
    """The interpretations tried, up to a number, and all that is known of the parts.

    name: seeds the design.
    most: how often each part may be evaluated. All interpretations are, if there are no more than
    that.
    """
    everything = math.prod(len(choice.values) for choice in choices) <= most
    book = _Book(choices, parts, evaluate, math.inf if everything else most)
    book.ask([{}])
    if everything:
        book.ask([*_all(choices)])
    else:
        _climb_on(choices, book, name)
    return book.found(listed)


def settled(interpretation: Interpretation, choices: list[Choice]) -> Interpretation:
    """An interpretation without the choices that its world makes itself: with another value they
    would name runs that are not made.
    """
    worlds = [
        choice.overrules.get(str(interpretation.get(choice.id)), [])
        for choice in choices
        if choice.column
    ]
    return {
        choice: value
        for choice, value in interpretation.items()
        if choice not in set().union(*worlds)
    }


def within_reach(
    interpretations: list[Interpretation], parts: list[Part], evaluate: Evaluate, most: int
) -> list[Interpretation]:
    """Those that may be the best, the best first, up to a number: not ruled out, and with a score
    no more than `REACH` standard errors of the difference below the best one.

    interpretations: about in the order of their scores, the best first: after a batch of which none
    may be the best the rest is not asked for. evaluate: with the scores of resampled runs.
    """
    book = _Book([], parts, evaluate, math.inf)
    asked, near = [], []
    for start in range(0, len(interpretations), most):
        batch = interpretations[start : start + most]
        book.ask(batch)
        asked += book.wholes(batch)
        near = _near_the_best(asked)
        if len(near) >= most or not any(each in batch for each in near):
            break
    return near[:most]


def _near_the_best(evaluated: list[Evaluated]) -> list[Interpretation]:
    different = _different(
        [each for each in evaluated if not each.impossible],
        lambda each: each.score,
        lambda each: len(each.interpretation),
    )
    return [
        each.interpretation
        for each in different
        if different[0].score - each.score
        <= REACH * np.std(different[0].resampled - each.resampled, ddof=1)
    ]


T = TypeVar("T")


def _different(tried: list[T], score: Callable[[T], float], choices: Callable[[T], int]) -> list[T]:
    """The best first; of those with one score, which are one experiment under several names, the
    one with the fewest choices.
    """
    ordered = sorted(tried, key=lambda each: (-score(each), choices(each)))
    return [next(same) for _, same in itertools.groupby(ordered, key=score)]


def confirm(
    interpretations: list[Interpretation], parts: list[Part], evaluate: Evaluate
) -> list[Evaluated]:
    """The default and some interpretations, evaluated anew, such as by more runs; the best first,
    after the default.
    """
    book = _Book([], parts, evaluate, math.inf)
    book.ask([{}, *interpretations])
    return book.wholes([{}, *sorted(interpretations, key=book.value, reverse=True)])


def _climb_on(choices: list[Choice], book: _Book, name: str) -> None:
    """Climb from the default interpretation, then from kicks of the best one, until nothing is new,
    or too little may be evaluated.
    """
    interpretation = _climb({}, choices, book, generator(f"{name}/climb/0"))
    shared, own = _shared_and_own(choices, book.parts)
    groups = [*([shared, *own] if shared else own)]
    groups = [group for group in groups if group]
    stale = 0
    for number, drawn in enumerate(_design(choices, name), start=1):
        rng = generator(f"{name}/climb/{number}")
        group = groups[number % len(groups)]
        # Every other time all choices of a competing method are drawn, so that its settings are
        # tried everywhere.
        anew = group is not shared and number // len(groups) % 2 == 0
        count = len(group) if anew else min(KICKED, len(group))
        kicked = interpretation
        for place in rng.permutation(len(group))[:count]:
            choice = group[place].id
            kicked = book.changed(kicked, choice, drawn[choice])
        before = sum(book.left)
        climbed = _climb(kicked, choices if group is shared else group, book, rng)
        if climbed is not None and book.value(climbed) >= book.value(interpretation):
            interpretation = climbed
        stale = stale + 1 if sum(book.left) == before else 0
        if stale == STALE or max(book.left) <= 0:
            return


def _climb(
    interpretation: Interpretation, choices: list[Choice], book: _Book, rng: np.random.Generator
) -> Interpretation | None:
    """Give one choice after the other its best value, in random order, until none improves the
    score. A choice stays as it is where its values may not be evaluated any more; None if the
    interpretation to begin with may not.
    """
    try:
        (best,) = book.ask([interpretation])
    except _SpentError:
        return None
    order = [choices[place] for place in rng.permutation(len(choices))]
    unchanged = 0
    for choice in itertools.cycle(order):
        unchanged += 1
        others = [book.changed(interpretation, choice.id, value) for value in choice.values]
        try:
            values = book.ask(others)
        except _SpentError:
            if unchanged >= len(order):
                return interpretation
            continue
        place = int(np.argmax(values))
        if values[place] > best:
            interpretation, best, unchanged = others[place], values[place], 1
        if unchanged >= len(order):
            return interpretation
    return interpretation


def _shared_and_own(
    choices: list[Choice], parts: list[Part]
) -> tuple[list[Choice], list[list[Choice]]]:
    """Choices on which several parts depend, and for each part those on which it alone does."""
    users = {
        choice.id: [part for part, each in enumerate(parts) if choice.id in each.choices]
        for choice in choices
    }
    shared = [choice for choice in choices if len(users[choice.id]) > 1]
    return shared, [
        [choice for choice in choices if users[choice.id] == [part]] for part in range(len(parts))
    ]


def _design(choices: list[Choice], name: str) -> Iterator[dict[str, Any]]:
    """Rows of Latin hypercubes over the values of all choices, without end: each value of a choice
    comes up equally often.
    """
    from scipy.stats import qmc

    for number in itertools.count():
        cube = qmc.LatinHypercube(len(choices), seed=generator(f"{name}/design/{number}")).random(
            DESIGN
        )
        for row in cube:
            yield {
                choice.id: choice.values[int(place * len(choice.values))]
                for choice, place in zip(choices, row, strict=True)
            }


def _all(choices: list[Choice]) -> Iterator[Interpretation]:
    for values in itertools.product(*(choice.values for choice in choices)):
        yield settled(
            {
                choice.id: value
                for choice, value in zip(choices, values, strict=True)
                if value is not None
            },
            choices,
        )
