"""Exact geometry: curves, the blocked region, the certified check of paths, exact shortest paths,
cell-counting lengths.
"""
