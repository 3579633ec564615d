"""The robot's board, reserved for what its own firmware does not do."""
