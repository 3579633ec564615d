"""The server: serves the page, records, exports, and keeps the other processes running."""

VERSION = "0.2.0"
"""Of everything here: pyproject.toml takes it, and a check compares firmware and changelog with it."""
