"""What a robot moves in: circles in a rectangle, a grid of cells, or polygons; and reading their
descriptions and files.
"""
