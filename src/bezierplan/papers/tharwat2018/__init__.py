"""Code of tharwat2018 alone."""
