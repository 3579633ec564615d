"""The database's history, one revision for each change of `server.platform.models`."""

HEAD = "0018"
"""The newest revision: what a database of this version must be at."""
