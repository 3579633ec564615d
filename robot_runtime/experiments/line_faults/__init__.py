"""Serial lines that damage passing bytes at chosen rates."""
