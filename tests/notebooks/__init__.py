"""The notebooks of the help: they are run, and their pages are made."""
