"""What a paper leaves open: its readings, how well each fits, and what it makes of the claims."""
