"""Runs of the communication test: kept, listed, compared and exported."""
