"""Which verdicts depend on which choice: each alternative of an assumption, one at a time, next to
the default.

Columns: study, assumption, detail, setting, default, alternative; claim, statement; verdict,
verdict_alternative, changed (empty if either is undecided); holds, holds_alternative; effect,
effect_alternative (of the decisive comparison).
"""

import json
from typing import NamedTuple

import pandas as pd


class Tried(NamedTuple):
    """An alternative that is tried on claims, as its table describes it."""

    study: str
    assumption: str
    detail: str
    setting: str | None
    default: object
    alternative: object


def sensitivity(
    claims: pd.DataFrame, alternatives: dict[str, pd.DataFrame], described: dict[str, Tried]
) -> pd.DataFrame:
    """One row per alternative and headline claim.

    claims: claims of the study with all defaults. alternatives: by name, claims with that
    alternative. described: the alternatives, by name.
    """
    deciding = claims[claims["primary"]].set_index("id")
    rows = []
    for name, judged in alternatives.items():
        for tried in judged.itertuples():
            in_force = deciding.loc[tried.id]
            rows.append(
                {
                    **described[name]._asdict(),
                    "default": _text(described[name].default),
                    "claim": tried.id,
                    "statement": in_force["statement"],
                    "verdict": in_force["verdict"],
                    "verdict_alternative": tried.verdict,
                    "changed": changed(in_force["verdict"], tried.verdict),
                    "holds": in_force["holds"],
                    "holds_alternative": tried.holds,
                    "effect": in_force["effect"],
                    "effect_alternative": tried.effect,
                }
            )
    return pd.DataFrame(rows)


def changed(in_force: str, alternative: str) -> bool | None:
    """Whether an alternative changes a verdict; None if either is undecided, which neither agrees
    nor disagrees.
    """
    return None if "undecided" in (in_force, alternative) else in_force != alternative


def _text(value: object) -> str:
    """A value, or one per method, as printed."""
    return json.dumps(value) if isinstance(value, dict) else str(value)
