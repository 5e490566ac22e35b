"""Experiments on smooth robot path planning with Bezier curves, as one Snakemake workflow."""

from bezierplan.running.digest import point_numba_cache

point_numba_cache()
