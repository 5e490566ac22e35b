"""One file an algorithm. The file's name is the planner's name; its function is `plan`; its keyword-only arguments are its settings."""
