"""Figures: sheets of panels, one file per kind of panel, and their style."""
