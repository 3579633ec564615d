"""The documents' own commands and code, run."""
