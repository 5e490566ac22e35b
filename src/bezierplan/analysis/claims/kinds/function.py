"""The finding of a function in the study's module, for sentences that fit no other kind.

It takes the check, the results by experiment, the published numbers by file, and the arguments that
the check gives. It returns a mark, the effect, its 95 % interval or None, and the number of units.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from pydantic import Field

from bezierplan.analysis.claims import check
from bezierplan.analysis.claims.effects import Finding, Terms
from bezierplan.analysis.claims.material import Material, Untestable
from bezierplan.schema.checked import Fault, describe_known
from bezierplan.schema.model import ARGUMENTS, Arguments, Function, Line, Metric, Where

if TYPE_CHECKING:
    import pandas as pd

    from bezierplan.analysis.claims.claim import Claim
    from bezierplan.analysis.results import Results

    Experiments = dict[str, Results]
    Published = dict[str, pd.DataFrame]
    FunctionResult = tuple[str, float, tuple[float, float] | None, int]


class Options(check.ClaimCheck):
    name: Function = Field(description="the name of a function of the study's `functions.py`")
    arguments: Arguments = Field({}, description=ARGUMENTS)
    statistic: Line = Field(description="what it computes, in words")
    effect_unit: Line = Field(description="the unit of its effect, - for a number without unit")
    experiment: check.Experiments = None
    metric: Metric = Field(None, description="the name of a metric")
    where: Where = Field(
        {}, description="column of the runs table → value or list of values", min_length=1
    )

    def judge(self, claim: Claim, material: Material) -> list[tuple[Terms, Finding]]:
        """Call the study's function that a check names, and return its finding.

        Raises Untestable if the experiment was not run, Fault if there is no function of that name.
        """
        for experiment in self.experiments:
            if experiment not in material.results:
                raise Untestable(f"the experiment {experiment} was not run")
        if self.name not in material.functions:
            raise Fault(
                f"claim {claim.id}: function {self.name}: "
                f"unknown{describe_known(self.name, material.functions)}"
            )
        function = material.functions[self.name]
        mark, effect, interval, n = function(
            self, material.results, material.published, **self.arguments
        )
        low, high = interval or (math.nan, math.nan)
        finding = Finding(effect, low, high, n, mark=mark)
        return [(Terms(self.name), finding)]
