"""Amounts with their units."""

# Units with a plural; others are abbreviations, such as m.
_WORDS = ("unit", "cell", "step")


def amount(number: str, unit: str) -> str:
    """A number, as printed, with its unit.

    >>> amount("1", "cell"), amount("21.83", "cell"), amount("0.5", "m")
    ('1 cell', '21.83 cells', '0.5 m')
    """
    one = abs(float(number.replace(",", ""))) == 1
    return f"{number} {unit}{'s' if unit in _WORDS and not one else ''}"
