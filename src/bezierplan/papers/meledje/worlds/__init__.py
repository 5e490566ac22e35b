"""Kinds of workspace of meledje alone (`workspaces.kinds`)."""
