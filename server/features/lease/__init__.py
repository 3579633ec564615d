"""Control of the robot: its holder, and the driving commands of that holder."""
