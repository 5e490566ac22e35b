"""Code of meledje alone."""
