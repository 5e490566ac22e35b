"""Processes of jobs: how they start, end and tell of it."""
