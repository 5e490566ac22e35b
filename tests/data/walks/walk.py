extra = ("roads",)


def plan(problem, rng, *, tries: int):
    pass
