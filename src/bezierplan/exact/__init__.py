"""Exact geometry, apart from every planner: the certified collision check and exact shortest paths."""
