"""Addresses of places on the page, the part of a link after #."""

import re
from typing import Any


def build_address(*parts: Any) -> str:
    """Return a path of names, with _ for each sign that an address cannot hold, such as a space."""
    return "/".join(
        # A column with gaps is read as 20.0, and has the address of 20.
        re.sub(r"[^\w.+~-]", "_", f"{part:g}" if isinstance(part, float) else str(part))
        for part in parts
    )
