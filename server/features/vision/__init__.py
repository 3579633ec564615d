"""The vision node's settings, in the interface and in robot.toml."""
