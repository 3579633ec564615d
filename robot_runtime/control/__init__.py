"""Control: what the robot should do next, from what it senses."""
