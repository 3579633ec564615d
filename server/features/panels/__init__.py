"""Panels of one's own: small scripts in the data folder, which the page runs apart from itself."""
