"""Recording: arriving samples become chunks of a session in the database."""
