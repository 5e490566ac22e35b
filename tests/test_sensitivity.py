"""Which verdicts depend on an alternative, and printed lengths below the exact bound: small tables
by hand.
"""

import pandas as pd
import pytest

from bezierplan.analysis import audit, sensitivity
from bezierplan.analysis.sensitivity import Tried


def claims(**verdicts):
    rows = [
        {
            "id": name,
            "primary": True,
            "statement": f"says {name}",
            "verdict": verdict,
            "holds": "1 of 1",
            "effect": 1.5,
        }
        for name, verdict in verdicts.items()
    ]
    return pd.DataFrame([*rows, rows[0] | {"primary": False, "verdict": "undecided"}])


def test_a_verdict_changes_where_the_alternative_has_another_one():
    in_force = claims(C1="supported", C2="contradicted", C3="no effect")
    described = {
        "O2_8": Tried("paper", "O2", "neighbours", "k", {"mine": 4}, 8),
        "O3_0": Tried("paper", "O3", "memory", "m", 1, 0),
    }
    tried = {
        "O2_8": pd.DataFrame(
            {
                "id": ["C1", "C2"],
                "verdict": ["supported", "partly"],
                "holds": ["1 of 1", "2 of 3"],
                "effect": [1.25, -2.0],
            }
        ),
        "O3_0": pd.DataFrame(
            {"id": ["C3"], "verdict": ["supported"], "holds": ["1 of 1"], "effect": [0.5]}
        ),
    }
    table = sensitivity.sensitivity(in_force, tried, described)
    assert table[["assumption", "alternative", "claim"]].to_numpy().tolist() == [
        ["O2", 8, "C1"],
        ["O2", 8, "C2"],
        ["O3", 0, "C3"],
    ]
    assert table["changed"].to_list() == [False, True, True]
    assert table["verdict"].to_list() == ["supported", "contradicted", "no effect"]
    assert table["verdict_alternative"].to_list() == ["supported", "partly", "supported"]
    assert table["effect"].to_list() == [1.5] * 3
    assert table["effect_alternative"].to_list() == [1.25, -2.0, 0.5]
    assert table["default"].to_list() == ['{"mine": 4}', '{"mine": 4}', "1"]


@pytest.mark.parametrize(
    ("printed", "bound", "consistent"),
    [
        ("29.94", 29.9449, True),
        ("29.94", 29.9451, False),
        ("30", 30.49, True),
        ("30", 30.51, False),
        ("30.0", 30.049, True),
        ("30.0", 30.051, False),
        ("30.00", 30.0049, True),
        ("30.00", 30.0051, False),
        ("31", 30.0, True),
    ],
)
def test_a_printed_length_may_lie_below_the_bound_by_half_a_unit_of_its_last_digit(
    printed, bound, consistent, tmp_path
):
    file = tmp_path / "table1.csv"
    file.write_text(
        f"problem,method,metric,statistic,n,unit,value\nacross,plain,length,min,10,m,{printed}\nacross,plain,cpu_s,min,10,s,1\n"
    )
    bounds = {"table1": pd.DataFrame({"bound": [bound]}, index=["across"])}
    (row,) = audit.below_bound({"table1": audit.read_published(str(file))}, bounds, {})
    assert bool(row["consistent"]) == consistent
    assert (row["printed"], row["limit"]) == (float(printed), bound)
    assert row["place"].startswith("problem=across, method=plain")
