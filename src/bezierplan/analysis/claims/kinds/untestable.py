"""A sentence of the paper that nothing here can test, with the reason."""

from __future__ import annotations

from typing import TYPE_CHECKING, NoReturn

from pydantic import Field

from bezierplan.analysis.claims.check import ClaimCheck
from bezierplan.analysis.claims.material import Material, Untestable
from bezierplan.schema.model import Line

if TYPE_CHECKING:
    from bezierplan.analysis.claims.claim import Claim


class Options(ClaimCheck):
    reason: Line = Field(description="why nothing here can test it, one line")

    def judge(self, claim: Claim, material: Material) -> NoReturn:
        """Refuse the test: raise Untestable with the reason."""
        raise Untestable(self.reason)
