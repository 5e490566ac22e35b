"""What a study says, as frozen classes, and the jobs that follow from it.

`experiments`, `artefacts` and `claims` hold the models, one a kind of mapping in the files; `definition` the study that they make;
`reading` and `checks` find every fault before the first job; `jobs` and `alternatives` say what is run.
"""

from bezierplan.study.alternatives import (
    alternatives,
    alternatives_described,
    experiments_of_claims,
    headline_claims,
    methods_changed,
    methods_of_claims,
    tried,
    with_alternative,
)
from bezierplan.study.definition import Study, relative
from bezierplan.study.experiments import SCALES
from bezierplan.study.jobs import (
    caption,
    chunks,
    claims_job,
    experiments_of,
    figure_job,
    job,
    kind_of,
    listing_job,
    methods_of,
    problems_job,
    published_drawn,
    smoke,
    table_job,
)

__all__ = [
    "SCALES",
    "Study",
    "alternatives",
    "alternatives_described",
    "caption",
    "chunks",
    "claims_job",
    "experiments_of",
    "experiments_of_claims",
    "figure_job",
    "headline_claims",
    "job",
    "kind_of",
    "listing_job",
    "methods_changed",
    "methods_of",
    "methods_of_claims",
    "problems_job",
    "published_drawn",
    "relative",
    "smoke",
    "table_job",
    "tried",
    "with_alternative",
]
