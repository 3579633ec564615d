"""Blocks between processes: the bus inside one, Zenoh between them, the outbox and the replay cache."""
