"""Marks of drawings: rows of the table that a panel of kind `drawing` shows."""

from collections.abc import Iterable
from typing import Any


def mark(kind: str, role: str, x: float, y: float, **more: Any) -> dict[str, Any]:
    """One mark, or one point of a line or arrow. more: further columns."""
    return {"mark": kind, "role": role, "x": x, "y": y} | more


def text(x: float, y: float, words: object, **more: Any) -> dict[str, Any]:
    """Words about a place."""
    return mark("text", "note", x, y, text=str(words), **more)


def along(kind: str, role: str, places: Iterable[Any], **more: Any) -> list[dict[str, Any]]:
    """A line or arrow through places, or dots at them; each place is x and y."""
    return [mark(kind, role, x, y, **more) for x, y in places]
