"""Features of the server: each has its routes, schemas, services and shell command in one folder."""
