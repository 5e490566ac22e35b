"""The fish swarm: what its releases give."""

import itertools

import numpy as np
from studies import study
from test_lattice_planners import environment

from bezierplan.planners.fish_swarm_genetic import (
    Settings,
    _release,
)
from bezierplan.planners.parts import cell_paths
from bezierplan.planners.parts.settings import filled
from bezierplan.workspaces.lattice import lattice

SWARM = filled(Settings, study("ma2020").resolved("asfa_ga") | {"fish": 5})


def released(wanted=100, seed=0, **changes):
    problem = environment(1)
    places = lattice(problem.workspace, problem.start, problem.target, "one")
    swarm = SWARM._replace(fish=20, population=wanted, **changes)
    return places, *_release(np.random.default_rng(seed), places, swarm)


def test_fish_that_arrive_give_as_many_paths_as_wanted():
    places, paths, sizes, _ = released()
    assert len(paths) == len(sizes) == 100
    for path, size in zip(paths, sizes, strict=True):
        assert (path[0], path[size - 1]) == (places.start, places.target)
        assert len(set(path[:size].tolist())) == size
        assert all(
            cell_paths.step_between(places, *pair) >= 0 for pair in itertools.pairwise(path[:size])
        )


def test_releases_end_when_there_are_enough_paths():
    *_, sizes, count = released(wanted=10)
    assert (len(sizes), count) == (10, 1)


def test_tries_make_first_paths_shorter():
    without, with_tries = (released(tries=tries)[2].mean() for tries in (0, 8))
    assert with_tries < 0.6 * without
