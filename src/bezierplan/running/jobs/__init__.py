"""Processes of jobs: how they start, end and report."""
