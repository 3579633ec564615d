"""Limits of what is stored, for whoever checks it without the database."""

IDENTIFIER_MAX = 2**63 - 1
"""SQLite's largest number."""
NOTES_MAX = 1_000_000
"""Characters of all notes at the bookmarks of a session: an answer has all of them."""
