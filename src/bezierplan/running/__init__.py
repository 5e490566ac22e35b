"""Runs: problems, chunks of runs, the contract of planners, digests and logs of jobs."""
