"""Parts of search algorithms: genetic operators, swarm steps, chaotic maps. Nothing here knows of paths."""
