"""Sentences of a paper as checks: `judge` gives verdicts, `kinds` has one file a kind of test."""
