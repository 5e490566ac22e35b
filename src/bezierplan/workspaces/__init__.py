"""What a robot moves in: circles, a grid of cells, or polygons; and how these are read."""
