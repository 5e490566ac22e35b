"""Does the search find an interpretation that was planted? Synthetic surfaces with the choices of
the five studies, on which no planner runs.

    python tests/planted.py [interpretations]    how often several searches find it, two surfaces a
                                                 study, with so many interpretations, or as many as
                                                 the study tries

A surface gives each part of a study some printed numbers, whose means depend on the choices of the
part, one by one and in pairs, as in runs of few repeats. The numbers are drawn under an
interpretation that is then forgotten. It is found if the score of the best interpretation tried is
at most `NEAR` below its own.
"""

import contextlib
import itertools
import math
import sys
from typing import Any

import numpy as np
import pandas as pd

from bezierplan.analysis.explained import Evaluated, Interpretation, name_of
from bezierplan.analysis.search import Task, search
from bezierplan.analysis.search_job import Choice, Part
from bezierplan.study import choices, reading
from bezierplan.workspaces.seeds import generator

NEAR = 2.0
# Numbers of a part, the degrees of freedom of their likelihood, and the error of means over few
# runs, in standard deviations of a number.
NUMBERS, FREEDOM, ERROR = 14, 19, 0.2


class Surface:
    """A planted interpretation, and what a search is given to find it. noise: whether no
    interpretation is planted: the numbers are noise. most: how many interpretations the study
    tries.
    """

    def __init__(
        self, name: str, given: list[Choice], parts: list[Part], noise: bool = False, most: int = 60
    ) -> None:
        rng, self.most = generator(f"surface/{name}"), most
        self.choices, self.parts, self.asked, self.name = given, parts, 0, name
        self.effects: list[dict[str, list[np.ndarray]]] = []
        self.pairs: list[dict[tuple[str, str], np.ndarray]] = []
        levels = {choice.id: len(choice.values) for choice in given}
        for part in parts:
            self.effects.append(
                {choice: self._effect(rng, levels[choice]) for choice in part.choices}
            )
            pairs = (
                [tuple(rng.choice(part.choices, 2, replace=False)) for _ in part.choices]
                if len(part.choices) > 1
                else []
            )
            shapes = {
                pair: rng.lognormal(-1.2, 1.0)
                * rng.normal(size=(levels[pair[0]], levels[pair[1]], 1))
                for pair in pairs
            }
            self.pairs.append(
                {pair: shape * rng.normal(size=NUMBERS) for pair, shape in shapes.items()}
            )
        self.truth: Interpretation = {}
        for choice in given:
            if (
                rng.random() < 0.6
                and (value := choice.values[rng.integers(levels[choice.id])]) is not None
            ):
                self.truth[choice.id] = value
        self.printed = [
            self._means(part, self.truth) + rng.normal(size=NUMBERS) for part in range(len(parts))
        ]
        if noise:
            self.printed = [each + rng.normal(0.0, 30.0, size=NUMBERS) for each in self.printed]

    @staticmethod
    def _effect(rng: np.random.Generator, levels: int) -> np.ndarray:
        """What each value of a choice adds to each number: most choices matter little, a few
        much.
        """
        together = rng.normal(size=NUMBERS) / 2 + rng.choice([-1, 1])
        along = np.concatenate([[0.0], rng.normal(size=levels - 1)])
        return rng.lognormal(-0.7, 1.3) * (
            along[:, None] * together + 0.3 * rng.normal(size=(levels, NUMBERS))
        )

    def _place(self, choice: str, made: Interpretation) -> int:
        values = next(each.values for each in self.choices if each.id == choice)
        return values.index(made.get(choice))

    def _means(self, part: int, made: Interpretation) -> np.ndarray:
        found = np.zeros(NUMBERS)
        for choice, effect in self.effects[part].items():
            found = found + effect[self._place(choice, made)]
        for (one, other), effect in self.pairs[part].items():
            found = found + effect[self._place(one, made), self._place(other, made)]
        return found

    def evaluated(self, task: Task) -> Evaluated:
        """A part of an interpretation."""
        self.asked += 1
        error = generator(f"{self.name}/{task.part}/{name_of(task.interpretation)}").normal(
            0.0, ERROR, NUMBERS
        )
        away = self.printed[task.part] - self._means(task.part, task.interpretation) - error
        score = -0.5 * (FREEDOM + NUMBERS) * math.log1p(float(away @ away) / FREEDOM)
        frame = {
            "method": self.parts[task.part].methods[0],
            "metric": "length",
            "statistic": "mean",
            "value_published": self.printed[task.part],
        }
        bounds = {
            "low": self.printed[task.part] - away - 2,
            "high": self.printed[task.part] - away + 2,
        }
        numbers = pd.DataFrame(
            frame | bounds | {"in_range": np.abs(away) < 2, "possible": True, "table": "table1"}
        )
        return Evaluated(task.interpretation, numbers, {"table1": score})

    def evaluate(self, tasks: list[Task]) -> list[Evaluated | None]:
        return [self.evaluated(task) for task in tasks]

    def score(self, made: Interpretation) -> float:
        """The score of an interpretation, whose parts count as asked for, once each, if they were
        not before.
        """
        own = [
            {choice: value for choice, value in made.items() if choice in part.choices}
            for part in self.parts
        ]
        return sum(self.evaluated(Task(number, each)).score for number, each in enumerate(own))


def of_study(key: str, number: int, noise: bool = False) -> Surface:
    """A surface with the choices of a study."""
    job = choices.search_job(reading.load(reading.read_config({"studies": [key]}, alone=True))[key])
    return Surface(
        f"{key}/{number}",
        job.choices,
        job.parts,
        noise,
        job.most,
    )


# Other searches, which get the same surface: as many parts are paid for as the search pays for.


class Spent(Exception):
    """All parts that may be evaluated have been."""


class Paid:
    """Scores of interpretations as rows of levels, each part paid for once."""

    def __init__(self, surface: Surface, most: int) -> None:
        self.surface, self.left, self.best = surface, most * len(surface.parts), -math.inf
        self.known: dict[tuple[int, str], float] = {}

    def __call__(self, levels: Any) -> float:
        values = zip(self.surface.choices, np.rint(levels).astype(int), strict=True)
        made = {
            choice.id: choice.values[level]
            for choice, level in values
            if choice.values[level] is not None
        }
        total = 0.0
        for number, part in enumerate(self.surface.parts):
            own = {choice: value for choice, value in made.items() if choice in part.choices}
            key = number, name_of(own)
            if key not in self.known:
                if self.left <= 0:
                    raise Spent
                self.left -= 1
                self.known[key] = self.surface.evaluated(Task(number, own)).score
            total += self.known[key]
        self.best = max(self.best, total)
        return -total

    @property
    def levels(self) -> list[int]:
        return [len(choice.values) for choice in self.surface.choices]


def random_interpretations(paid: Paid, name: str) -> None:
    rng = generator(name)
    while True:
        paid([rng.integers(levels) for levels in paid.levels])


def ascent(paid: Paid, name: str) -> None:
    """Coordinate ascent in the order of the choices, each whole interpretation paid in full: from
    the default, then from two random ones.
    """
    paid.left = paid.left // len(paid.surface.parts)
    rng, once, tried = generator(name), Paid.__call__, set()

    def score(levels: list[int]) -> float:
        if tuple(levels) not in tried:
            if len(tried) >= paid.left:
                raise Spent
            tried.add(tuple(levels))
        spare, paid.left = paid.left, 10**9
        found = -once(paid, levels)
        paid.left = spare
        return found

    starts = [
        [0] * len(paid.levels),
        *([int(rng.integers(levels)) for levels in paid.levels] for _ in range(2)),
    ]
    for levels in starts:
        best, improved = score(levels), True
        while improved:
            improved = False
            for place, value in [
                (place, value) for place, most in enumerate(paid.levels) for value in range(most)
            ]:
                other = [*levels[:place], value, *levels[place + 1 :]]
                if (found := score(other)) > best:
                    levels, best, improved = other, found, True


def evolution(paid: Paid, name: str) -> None:
    """Differential evolution over whole numbers (scipy)."""
    from scipy.optimize import differential_evolution

    ends = [(0, levels - 1) for levels in paid.levels]
    differential_evolution(
        paid,
        ends,
        integrality=[True] * len(ends),
        rng=generator(name),
        popsize=2,
        maxiter=10**6,
        tol=0,
        polish=False,
    )


def found_by(surface: Surface, most: int, how: Any = None) -> float:
    """The score of the best interpretation that a search finds, less that of the planted one."""
    if how is None:
        found = search(surface.choices, surface.parts, surface.evaluate, surface.name, most)
        best = max(each.score for each in found.interpretations)
    else:
        paid = Paid(surface, most)
        with contextlib.suppress(Spent):
            how(paid, surface.name)
        best = paid.best
    return best - surface.score(surface.truth)


def main(most: int | None) -> None:
    keys = ["song2016", "elhoseny2017", "ma2020", "tharwat2018", "meledje"]
    for how in (None, ascent, evolution, random_interpretations):
        surfaces = {
            f"{key}/{number}": of_study(key, number)
            for key, number in itertools.product(keys, range(2))
        }
        away = {
            name: found_by(surface, most or surface.most, how) for name, surface in surfaces.items()
        }
        hits = sum(each >= -NEAR for each in away.values())
        told = ", ".join(
            f"{name} ({most or surfaces[name].most}) {each:+.1f}" for name, each in away.items()
        )
        print(
            f"{how.__name__ if how else 'search'}: {hits} of {len(away)} found: {told}", flush=True
        )


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else None)
