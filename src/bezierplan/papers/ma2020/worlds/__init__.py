"""Kinds of workspace of ma2020 alone (`workspaces.kinds`)."""
