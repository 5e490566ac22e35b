"""Code of elhoseny2017 alone."""
