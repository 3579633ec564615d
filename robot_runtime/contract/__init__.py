"""Packets, topics, documents, commands and limits: what processes and boards agree on, each defined once."""
