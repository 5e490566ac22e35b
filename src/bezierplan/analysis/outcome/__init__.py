"""The outcome of all studies, in sentences, tables and checks."""
