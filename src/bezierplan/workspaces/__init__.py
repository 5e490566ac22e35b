"""What a robot moves in: circles in a rectangle, a grid of cells, or polygons; and the reading of their descriptions and files."""
