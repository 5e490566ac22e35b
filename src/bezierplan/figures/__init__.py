"""Figures: sheets of panels, one file a kind of panel, and their style."""
