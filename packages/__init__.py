"""Builds what users install: the wheels and the container image."""
