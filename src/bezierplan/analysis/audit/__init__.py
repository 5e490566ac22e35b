"""A paper's own numbers, checked without a run."""
