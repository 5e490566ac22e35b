"""Sentences of a paper as checks: `judge` gives verdicts, `kinds` has one file per kind of test."""
