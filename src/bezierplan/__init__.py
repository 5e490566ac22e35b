"""Experiments on smooth robot path planning with Bezier curves, as one Snakemake workflow."""
