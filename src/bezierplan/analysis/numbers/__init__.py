"""Printed numbers beside ours: tables as the papers lay them out, and what follows from them."""
