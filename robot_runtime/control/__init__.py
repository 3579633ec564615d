"""Control: loops, steering, faults and the supervisor of the robot's state."""
