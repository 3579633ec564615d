"""What the robot sees: cameras, and the search for a colour in their pictures."""
