"""The server: serves the page, records, exports, and keeps the other processes running."""

VERSION = "0.3.0"
"""The project's version: pyproject.toml reads it, and a check compares firmware and changelog with it."""
