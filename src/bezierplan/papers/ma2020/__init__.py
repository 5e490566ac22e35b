"""Code of ma2020 alone."""
