"""What follows: the outcome of all studies, in sentences, tables and checks."""
