"""Planners as guests: the check that a file is one, its execution, and a separate process for each
that is not of this package.
"""
