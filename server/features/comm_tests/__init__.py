"""Runs of the communication test: storage, lists, comparison and export."""
