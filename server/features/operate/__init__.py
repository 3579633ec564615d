"""Operating the robot: commands, the scene's view, the frames of the serial line."""
