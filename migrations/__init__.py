"""The database's history, one revision for each change of `server.platform.models`."""

HEAD = "0016"
"""The newest revision: what a database of this version must be at."""
