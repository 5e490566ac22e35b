"""Text for reports: literal reStructuredText."""


def escape_rst(text: str) -> str:
    """Escape text as one line of literal reStructuredText: no markup, no directive, no HTML."""
    return "".join(
        f"\\{sign}" if sign.isascii() and not sign.isalnum() and sign != " " else sign
        for sign in " ".join(text.split())
    )
