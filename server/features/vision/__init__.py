"""The vision node's settings: as the interface has them, and as a part of robot.toml."""
