"""Your own panels: small scripts in the data folder, which the page runs in a separate frame."""
