"""Runs: problems, chunks of runs, the contract of planners, and the processes and logs of jobs."""
