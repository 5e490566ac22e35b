"""Kinds of panel of tharwat2018 alone (`figures.panels`)."""
