"""Who has the control of the robot, and what whoever has it may send to it."""
