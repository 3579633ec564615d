"""Checks of the repository as a whole, for `make check`."""
