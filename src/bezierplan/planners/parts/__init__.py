"""Parts of algorithms: genetic operators, chaotic maps, diversity, paths as lists of cells."""
