"""Export of sessions to files of several formats, and import of archives."""
