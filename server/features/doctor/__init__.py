"""The doctor: checks of the computer that the robot runs on, each with the command that mends it."""
