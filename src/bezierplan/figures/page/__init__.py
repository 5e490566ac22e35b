"""One file that shows all results of a scale: its content (`content`, `gather`, `runs`, `answer`), and its look (`build`)."""
