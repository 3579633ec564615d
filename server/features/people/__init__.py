"""People and devices: pairing, roles, tokens."""
