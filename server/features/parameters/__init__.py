"""Parameters: their changes, undo, and saved profiles."""
