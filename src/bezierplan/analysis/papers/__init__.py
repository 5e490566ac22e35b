"""Code specific to one paper: one file per paper, with its audit and the claims that fit no kind of
test.
"""
