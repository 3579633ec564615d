"""The manual's pictures and its film, taken from the running product."""
