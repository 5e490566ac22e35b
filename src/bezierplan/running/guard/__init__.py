"""Planners: whether a file is one, what executes it, and the process of its own for one that is
not of this package.
"""
