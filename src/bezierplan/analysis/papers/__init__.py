"""What only one paper needs: one file a paper, with its audit and the claims that no kind of test fits."""
