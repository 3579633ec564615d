"""Tools of experimenters: scenarios, the communication test, faults of the serial line."""
