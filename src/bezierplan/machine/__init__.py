"""Digests of the code that kernels and jobs depend on, and the place of compiled kernels."""
