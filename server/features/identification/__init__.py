"""Identification: fits the craft to recorded sessions, shows the result, adopts it."""
