"""Code of song2016 alone."""
