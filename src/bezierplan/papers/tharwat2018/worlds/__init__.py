"""Kinds of workspace of tharwat2018 alone (`workspaces.kinds`)."""
