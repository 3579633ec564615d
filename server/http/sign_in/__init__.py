"""Sign-in: devices, tokens, pairing codes, roles, and the access policy."""
