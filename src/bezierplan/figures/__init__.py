"""One file a kind of picture: `data` makes the table that is drawn, `draw` draws it."""
