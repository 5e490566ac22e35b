"""Kinds of workspace of elhoseny2017 alone (`workspaces.kinds`)."""
