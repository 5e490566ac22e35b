"""What is judged: answers of planners, and stored results once more."""
